"""Verification: whether every error of indication is within the maximum permissible error."""

import warnings
from collections import Counter
from collections.abc import Callable, Iterator
from dataclasses import asdict, dataclass, field, replace
from numbers import Real
from typing import Any

import numpy as np
from numpy.typing import NDArray

from echocal._verb import callable_as
from echocal.budget.conformity import assessed, budget_of_errors, without_effect
from echocal.budget.coverage import DECISIONS
from echocal.budget.entries import Itemized
from echocal.budget.stated import Uncertainties
from echocal.errors import DataError, DataWarning, UsageError
from echocal.model import Model
from echocal.observations import Observations
from echocal.observations.at import sentences, shifted, uncertain
from echocal.observations.correction import base_indication, corrected_distance, outside_smooth
from echocal.observations.given import observed
from echocal.shown import Shown
from echocal.sweep import Range, sweep

__all__ = ["Verification", "verify", "verify_model"]

callable_as(__name__)

_LARGE = 1.0  # m: no requirement on a sensor in air


@dataclass(frozen=True, repr=False)
class Verification(Shown):
    """Outcome of a verification (VIM 2.44): simple acceptance, or with a guard band.

    Attributes
    ----------
    passed : bool
        Whether the decision is ``conforms``.
    decision : str
        ``conforms``, ``undecided`` or ``does not conform``, of all errors together. Without any uncertainty
        an error conforms if it does not exceed the maximum permissible error; else with a guard band
        (JCGM 106:2012, 8.3).
    maximum_permissible_error : float
        The bound (VIM 4.26) [m].
    maximum_error : float
        Error of indication with the largest magnitude, with its sign [m].
    mean_error : float
        Mean error [m]: the instrumental bias where conditions repeat.
    rms_error : float
        Root mean square error [m].
    count : int
        Errors that were examined.
    exceeding : int
        Errors that exceed the bound.
    worst : dict of str to float
        Where the maximum error is: the row (1 is the first), or the conditions [SI].
    unusable : dict of str to int
        Rows that could not be examined, by reason code.
    outside_smooth : dict of str to int
        Rows outside of the range of the model's smooth correction, which were examined without it.
    guard_band : float
        The largest expanded uncertainty of an error, k = 2 [m]; 0 where no uncertainty is stated.
    undecided : int
        Errors so near to the bound that the measurement does not decide.
    least_probability : float or None
        The smallest probability of conformity of an error; None where no uncertainty is stated.
    notes : tuple of str
        What a person should know: conditions that were stated, not recorded, and what their uncertainty does.

    Examples
    --------
    >>> import echocal
    >>> table = {"reading_mm": [1998, 2004], "distance_mm": [2000, 2000], "temperature_C": [20, 20]}
    >>> echocal.verify(echocal.read_observations(table), maximum_permissible_error=3e-3).passed
    False
    """

    passed: bool
    maximum_permissible_error: float
    maximum_error: float
    mean_error: float
    rms_error: float
    count: int
    exceeding: int
    worst: dict[str, float]
    unusable: dict[str, int]
    outside_smooth: dict[str, int] = field(default_factory=dict)
    guard_band: float = 0.0
    undecided: int = 0
    least_probability: float | None = None
    notes: tuple[str, ...] = ()
    decision: str = DECISIONS[0]

    def to_dict(self) -> dict[str, Any]:
        """Plain data, schema ``echocal.verification/1``; lengths in meters."""
        return {"schema": "echocal.verification/1", **asdict(self)}


def verify(
    observations: Any,
    *,
    maximum_permissible_error: float,
    model: Model | None = None,
    law: str = "linear",
    uncertainties: Any = (),
    **table: Any,
) -> Verification:
    """Compare indications with reference distances, row by row.

    Parameters
    ----------
    observations : Observations, path, DataFrame, or mapping of str to array_like
        Rows with a reference distance. Everything but `Observations` is read with
        `echocal.read_observations`.
    maximum_permissible_error : float
        Bound for the magnitude of every error [m].
    model : Model, optional
        Correct indications with this model first.
    law : str
        Law that turns echo times into indications where the table has no readings, and no model
        is given.
    uncertainties : sequence of str, or mapping of str to float or str
        As in `echocal.budget`: ``{"tape": "II", "thermometer": "DHT22"}``. They make the budget of the
        errors, and its expanded uncertainty is the guard band. The device and the model are what is
        examined: their own uncertainties are not part of it.
    **table
        Arguments of `echocal.read_observations`: ``columns``, ``missing``, ... The default of
        ``reading_speed`` is the law of the model, if one is given.

    Returns
    -------
    Verification
        Passed or failed, with the maximum error and its row.

    Raises
    ------
    DataError
        If there is no reference distance or no usable row.
    UsageError
        If the bound is not a positive length.

    Examples
    --------
    >>> import echocal
    >>> table = {"echo_us": [11650, 11700], "distance_m": [2.0, 2.0], "temperature_C": [20, 20]}
    >>> data = echocal.read_observations(table)
    >>> result = echocal.verify(data, maximum_permissible_error=5e-3)
    >>> result.passed, result.worst, round(result.maximum_error * 1e3, 2)
    (False, {'row': 2}, 8.89)
    """
    observations = observed(observations, verify, table, "" if model is None else model.law, model)
    observations.require("verification", reference_distance=True)
    assert observations.reference_distance is not None  # required above
    usable = np.flatnonzero(observations.usable)
    indication = _indication(observations, model, law)
    errors = (indication - observations.reference_distance)[usable]
    found = _judge(
        errors,
        maximum_permissible_error,
        lambda position: {"row": int(usable[position]) + 1},
        observations.unusable_counts,
    )
    stated = Uncertainties.of(uncertainties)
    budget = budget_of_errors(observations, model, indication, stated, law)
    if budget.entries or stated:
        found = _guarded(found, errors, usable, budget)
    marks = [] if model is None else outside_smooth(observations, model)[usable].tolist()
    outside = dict(Counter(mark for mark in marks if mark))
    notes = [*sentences(observations.stated), *_beside(observations, found, model, law)]
    if unused := without_effect(stated, budget):
        notes.append(
            f"the stated uncertainty of the {', '.join(unused)} adds nothing to that of an error: "
            "what was examined does not read it"
        )
    return replace(found, outside_smooth=outside, notes=tuple(notes))


def _guarded(
    found: Verification, errors: NDArray[np.float64], usable: NDArray[np.int64], budget: Itemized
) -> Verification:
    """Decide with a guard band."""
    judged = assessed(errors, budget.rows(usable), found.maximum_permissible_error)
    return replace(
        found,
        passed=bool((judged.decision == 0).all()),
        decision=DECISIONS[int(judged.decision.max())],
        guard_band=float(judged.expanded_uncertainty.max()),
        undecided=int((judged.decision == 1).sum()),
        least_probability=float(judged.probability.min()),
    )


def _beside(observations: Observations, found: Verification, model: Model | None, law: str) -> Iterator[str]:
    """What the verification says with a stated condition one standard uncertainty lower and higher."""
    for quantity, uncertainty in uncertain(observations).items():
        bound = found.maximum_permissible_error
        low, high = (
            verify(
                shifted(observations, quantity, step), maximum_permissible_error=bound, model=model, law=law
            )
            for step in (-uncertainty, uncertainty)
        )
        outcome = [side.decision for side in (low, high)]
        errors = [f"{side.maximum_error * 1e3:+.3f} mm" for side in (low, high)]
        yield (
            f"with the {quantity.replace('_', ' ')} one standard uncertainty lower the maximum error is "
            f"{errors[0]} ({outcome[0]}), higher it is {errors[1]} ({outcome[1]})"
        )


def verify_model(
    model: Model,
    *,
    maximum_permissible_error: float,
    temperature: Range,
    distance: Range,
    **conditions: Range,
) -> Verification:
    """Examine the error of a simulated device over every combination of conditions.

    Parameters
    ----------
    model : Model
        The device.
    maximum_permissible_error : float
        Bound for the magnitude of every error [m].
    temperature, distance, **conditions : range
        As in `echocal.sweep`.

    Returns
    -------
    Verification
        Passed or failed, with the maximum error and its conditions.

    Raises
    ------
    UsageError
        If the bound is not a positive length or a range is none.

    Examples
    --------
    >>> import echocal
    >>> device = echocal.Model("linear", {"fixed_speed": {"weight": 1.0, "speed": 343.0}})
    >>> result = echocal.verify_model(
    ...     device, maximum_permissible_error=3e-3, temperature=(0, 50, 2), distance=2.0
    ... )
    >>> result.passed, result.worst
    (False, {'temperature': 50.0, 'distance': 2.0})
    """
    grid = sweep(model, temperature=temperature, distance=distance, **conditions)
    errors = grid.error.to_numpy()

    def where(position: int) -> dict[str, float]:
        index = np.unravel_index(position, errors.shape)
        at = dict(zip(grid.error.dims, index, strict=True))
        return {str(name): float(grid[name][at.get(name, ())]) for name in grid.coords}

    return _judge(errors.ravel(), maximum_permissible_error, where, {})


def _judge(
    errors: NDArray[np.float64],
    bound: float,
    where: Callable[[int], dict[str, float]],
    unusable: dict[str, int],
) -> Verification:
    if not isinstance(bound, Real) or not 0 < float(bound) < np.inf:
        raise UsageError(f"the maximum permissible error must be a positive length [m], got {bound!r}")
    if float(bound) > _LARGE:
        message = (
            f"the maximum permissible error is {float(bound):g} m, which nearly every reading keeps; it is a "
            f"length in meters: {float(bound):g} mm are {float(bound) * 1e-3:g}"
        )
        warnings.warn(message, DataWarning, stacklevel=3)
    if np.isnan(errors).any():
        row = int(np.flatnonzero(np.isnan(errors))[0])
        raise DataError(
            f"{np.isnan(errors).sum()} errors are not a number, first at {where(row)}: a condition is missing"
        )
    worst = int(np.argmax(np.abs(errors)))
    exceeding = int(np.sum(np.abs(errors) > bound))
    return Verification(
        passed=exceeding == 0,
        decision=DECISIONS[2 if exceeding else 0],
        maximum_permissible_error=bound,
        maximum_error=float(errors[worst]),
        mean_error=float(errors.mean()),
        rms_error=float(np.sqrt(np.mean(errors**2))),
        count=errors.size,
        exceeding=exceeding,
        worst=where(worst),
        unusable=unusable,
    )


def _indication(observations: Observations, model: Model | None, law: str) -> NDArray[np.float64]:
    if model is not None:
        return corrected_distance(observations, model)
    return base_indication(observations, law) if observations.reading is None else observations.reading
