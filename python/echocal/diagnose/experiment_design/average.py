"""Predict with everything that the data leave possible, and say where it disagrees."""

import warnings
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from echocal.errors import DataError, DataWarning, DisagreementWarning, UsageError
from echocal.model import Model

__all__ = ["Estimate", "Member", "averaged"]

Column = NDArray[np.float64]

_APART = 2.0  # standard deviations of one reading from which on members disagree
_HEARD = 0.05  # probability below which nobody is warned of a member's own opinion


@dataclass(frozen=True)
class Member:
    """A set of causes that may be at work.

    Attributes
    ----------
    ids : tuple of str
        Empty: nothing is wrong.
    probability : float
        Relative to the other members; together they hold one.
    model : Model
        The base extended by these causes, with the covariance of their parameters.
    posterior : float
        Of these causes and nothing unexplained, among all sets that compete; the members together
        hold less than one.
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
        From the parameters and from not knowing which set it is; without the noise of one
        reading [m].
    agreed : ndarray of bool
        False where two sets that each hold 5 % or more differ by more than twice the noise of
        one reading.
    by_cause : mapping of tuple of str to ndarray
        What each set says [m].
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
) -> Estimate:
    """Average `method` of the members' models; warn where they disagree."""
    if not members:
        message = "this diagnosis was made without its members; diagnose the table again"
        raise UsageError(message)
    given: Mapping[str, Any] = conditions
    members, values = _heard(members, method, first, given)
    share = np.array([m.probability for m in members]).reshape(-1, *[1] * (values.ndim - 1))
    mean = (share * values).sum(axis=0)
    variance = np.zeros_like(mean)
    for member, value in zip(members, values, strict=True):
        own = _variance(member.model, first if method == "indicate" else value, given)
        variance += member.probability * (own + (value - mean) ** 2)
    heard = values[[m.probability >= _HEARD or m is members[0] for m in members]]
    agreed = ~(np.ptp(heard, axis=0) > _APART * noise)
    _warn(agreed, heard)
    by_cause = {m.ids: v for m, v in zip(members, values, strict=True)}
    return Estimate(mean, np.sqrt(variance), agreed, by_cause)


def _heard(
    members: Sequence[Member], method: str, first: ArrayLike, given: Mapping[str, Any]
) -> tuple[list[Member], Column]:
    """What those members say that need no more than is given."""
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
            f"{len(unable)} of {len(members)} possible sets of causes, with {1 - total:.2f} of their "
            f"probability, are left out: {unable[0]}"
        )
        warnings.warn(message, DataWarning, stacklevel=4)
    return [replace(m, probability=m.probability / total) for m in able], np.array(values, dtype=float)


def _variance(model: Model, distance: ArrayLike, conditions: Mapping[str, Any]) -> Column | float:
    """Variance of a distance (or, nearly the same, of a reading) from the parameters [m^2]."""
    if model.covariance is None:
        return 0.0
    jacobian = model.jacobian(distance, **conditions)
    tangents = jacobian[..., 1:] / jacobian[..., :1]
    variance: Column = np.einsum("...i,ij,...j->...", tangents, model.covariance, tangents)
    return variance


def _warn(agreed: NDArray[np.bool_], heard: Column) -> None:
    if agreed.all():
        return
    worst = 1e3 * float(np.nanmax(np.ptp(heard, axis=0)))
    where = f"at {int((~agreed).sum())} of {agreed.size} points" if agreed.size > 1 else "here"
    message = (
        f"the causes that the data leave possible disagree {where}, by up to {worst:.1f} mm: see by_cause, "
        "and next_measurements for what would settle it"
    )
    warnings.warn(message, DisagreementWarning, stacklevel=4)
