"""Predict with all possible sets of causes, and report where they disagree."""

import warnings
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from echocal.errors import DataError, DataWarning, DisagreementWarning, UsageError
from echocal.model import Model, ResidualUncertainty

__all__ = ["Estimate", "Member", "averaged"]

Column = NDArray[np.float64]

_APART = 2.0  # standard deviations of one reading: a larger difference is a disagreement
_COUNTED = 0.05  # smallest probability of a member whose disagreement is reported


@dataclass(frozen=True)
class Member:
    """A possible set of causes.

    Attributes
    ----------
    ids : tuple of str
        Empty: no effect.
    probability : float
        Relative to the other members; the sum over all members is one.
    model : Model
        The base extended by these causes, with the covariance of their parameters.
    posterior : float
        Of these causes without an unexplained term, among all sets; the sum over all members is
        less than one.
    """

    ids: tuple[str, ...]
    probability: float
    model: Model
    posterior: float = 0.0


@dataclass(frozen=True)
class Estimate:
    """A value with its standard uncertainty, and whether all possible causes agree on it.

    Attributes
    ----------
    value : ndarray
        Mean over the possible sets of causes, by their probability [m].
    standard_uncertainty : ndarray
        From the uncertainty of the parameters and of the set, and the residual uncertainty of the model
        of the diagnosis [m].
    agreed : ndarray of bool
        False where two sets of at least 5 % each differ by more than twice the noise of one
        reading.
    by_cause : mapping of tuple of str to ndarray
        Value of each set [m].
    """

    value: Column
    standard_uncertainty: Column
    agreed: NDArray[np.bool_]
    by_cause: Mapping[tuple[str, ...], Column]


def averaged(
    members: Sequence[Member],
    method: Literal["indicate", "correct"],
    first: ArrayLike,
    conditions: Mapping[str, ArrayLike],
    noise: float,
    residual: ResidualUncertainty | None = None,
) -> Estimate:
    """Average `method` of the members' models; warn where they disagree by more than `noise` [m]."""
    if not members:
        message = "this diagnosis has no members; diagnose the table again"
        raise UsageError(message)
    given: Mapping[str, Any] = conditions
    members, values = _computable(members, method, first, given)
    share = np.array([m.probability for m in members]).reshape(-1, *[1] * (values.ndim - 1))
    mean = (share * values).sum(axis=0)
    variance = np.zeros_like(mean) if residual is None else residual.of(mean) ** 2
    for member, value in zip(members, values, strict=True):
        at = first if method == "indicate" else value  # the uncertainty of a reading is nearly the same
        own = np.nan_to_num(member.model.standard_uncertainty(at, **given)) ** 2
        variance = variance + member.probability * (own + (value - mean) ** 2)
    counted = values[[m.probability >= _COUNTED or m is members[0] for m in members]]
    agreed = ~(np.ptp(counted, axis=0) > _APART * noise)
    _warn(agreed, counted)
    by_cause = {m.ids: v for m, v in zip(members, values, strict=True)}
    return Estimate(mean, np.sqrt(variance), agreed, by_cause)


def _computable(
    members: Sequence[Member], method: str, first: ArrayLike, given: Mapping[str, Any]
) -> tuple[list[Member], Column]:
    """Members whose models need no further conditions, and their values."""
    able: list[Member] = []
    values, unable = [], []
    for member in members:
        try:
            values.append(getattr(member.model, method)(first, **given))
            able.append(member)
        except DataError as error:
            unable.append(error)
    if not able:
        raise unable[0]
    total = sum(member.probability for member in able)
    if unable:
        message = (
            f"{len(unable)} of {len(members)} possible sets of causes are left out; together they have a "
            f"probability of {1 - total:.2f}: {unable[0]}"
        )
        warnings.warn(message, DataWarning, stacklevel=4)
    return [replace(m, probability=m.probability / total) for m in able], np.array(values, dtype=float)


def _warn(agreed: NDArray[np.bool_], counted: Column) -> None:
    if agreed.all():
        return
    worst = 1e3 * float(np.nanmax(np.ptp(counted, axis=0)))
    where = f"at {int((~agreed).sum())} of {agreed.size} points" if agreed.size > 1 else "here"
    message = (
        f"the possible causes predict different values {where}, by up to {worst:.1f} mm: by_cause has all "
        "values, and next_measurements has measurements that separate the causes"
    )
    warnings.warn(message, DisagreementWarning, stacklevel=4)
