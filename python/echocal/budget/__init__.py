"""Uncertainty budgets of corrected distances: JCGM 100, JCGM 101."""

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from echocal._verb import callable_as
from echocal.budget.coverage import COVERAGE, checked_coverage
from echocal.budget.entries import Itemized, itemized, some_rows
from echocal.budget.monte_carlo import MonteCarlo, simulated
from echocal.budget.result import Budget
from echocal.budget.stated import PUBLISHED, Uncertainties
from echocal.errors import DataError, UsageError, among
from echocal.keywords import keyword
from echocal.model import Model
from echocal.observations import Observations
from echocal.observations.at import sentences, uncertain
from echocal.observations.correction import corrected_distance
from echocal.observations.given import READ_OPTIONS, observed
from echocal.observations.quantization_grid import FINEST_STEP, find_grid
from echocal.quantities import QUANTITIES
from echocal.sweep.grid import axis

__all__ = ["Budget", "budget"]

callable_as(__name__)

TRIALS = 10_000
"""A standard deviation of so many draws is known to 0.7 %."""

_DRAWN_ROWS = 50
"""Rows that are drawn; a simulation of one takes as long as a diagnosis of ten thousand."""
_LARGEST = 100_000
_COARSER = 1.5
"""Times the step of the model's rows, which is that of a distance: more than any law changes it by."""


def budget(
    model: Model | str,
    observations: Any = None,
    *,
    uncertainties: Any = (),
    coverage: float = COVERAGE,
    trials: int = TRIALS,
    seed: int = 0,
    **given: Any,
) -> Budget:
    """Itemize the uncertainty of corrected distances, for each reading or for a grid of conditions.

    Parameters
    ----------
    model : Model or str
        The model that corrects; the name or expression of a law is a law alone.
    observations : Observations, path, DataFrame, or mapping of str to array_like, optional
        Readings. Without them, `distance` and conditions are a grid.
    uncertainties : sequence of str, or mapping of str to float or str
        What is known of the inputs: standard uncertainties by the names of columns
        (``{"temperature_C": 0.5, "echo_us": 2}``), and instruments: ``thermometer``, ``hygrometer``,
        ``barometer`` by name, ``tape`` by its class, ``timer_us`` and ``resolution_mm`` by their step,
        ``law_ppm`` by the limits of error of the law. Where neither this nor the model states anything of the
        law, its published uncertainty counts: ``law=published``.
    coverage : float
        Coverage probability of the expanded uncertainty; the default gives k = 2 for many degrees of freedom.
    trials : int
        Draws of the Monte Carlo method; 0 for none.
    seed : int
        Of the draws.
    **given
        With a table, arguments of `echocal.read_observations`. Else ``distance`` [m], ``temperature``
        [degC] and other influence quantities as in `echocal.sweep`.

    Returns
    -------
    Budget

    Raises
    ------
    UsageError
        If a name or a number cannot be understood.
    DataError
        If no row has a distance, or nothing is known of any uncertainty.

    Examples
    --------
    >>> import echocal
    >>> table = {"echo_us": [5846, 11670], "temperature_C": [20, 21], "humidity_percent": [50, 50]}
    >>> stated = {"thermometer": "DHT22", "timer_us": 4}
    >>> found = echocal.budget("cramer", table, uncertainties=stated)
    >>> [entry.words for entry in found.entries][0]
    'thermometer DHT22, limits of error'
    >>> (1e3 * found.expanded_uncertainty).round(1).tolist()
    [1.2, 2.3]
    """
    if isinstance(model, str | Path):
        if str(model).endswith(".json"):
            message = f"budget needs a Model or a law, got {str(model)!r}; Model.load(path) reads a file"
            raise UsageError(message)
        model = Model(str(model))
    probability = checked_coverage(coverage)
    if isinstance(trials, bool) or not isinstance(trials, int | np.integer) or trials < 0 or trials == 1:
        raise UsageError(f"{keyword('trials', trials)} is no number of draws; give 0 for none, or 2 or more")
    if observations is None:
        rows = observations_of(model, given)
    else:
        if ranges := sorted({"distance", *QUANTITIES} & set(given) - set(READ_OPTIONS)):
            message = f"{keyword(ranges[0])} belongs to a grid, and a table is given; leave one of them out"
            raise UsageError(message)
        rows = observed(observations, budget, given, model.law, model)
    distance = corrected_distance(rows, model)
    if not np.isfinite(distance).any():
        raise DataError("no row has a distance, so there is nothing to state the uncertainty of")
    stated = complete(model, uncertainties, uncertain(rows))
    found = itemized(rows, model, distance, stated)
    if not found.entries:
        raise DataError(f"nothing is known of any uncertainty; state some with {keyword('uncertainties')}")
    found.refuse_unknown(distance)
    places = _places(distance, found.standard_uncertainty) if trials else np.zeros(0, dtype=np.int64)
    drawn = None
    if trials:
        own, random = some_rows(rows, places), np.random.default_rng(seed)
        drawn_from = itemized(own, model, corrected_distance(own, model), stated)
        drawn = simulated(own, model, drawn_from, int(trials), probability, random)
    return Budget(
        distance=distance,
        conditions=dict(rows.conditions),
        row=np.arange(1, len(distance) + 1),
        itemized=found,
        coverage=probability,
        monte_carlo=drawn,
        monte_carlo_rows=places,
        model_hash=model.hash,
        notes=tuple(_notes(model, rows, found, stated, places, distance, drawn)),
    )


def complete(model: Model, uncertainties: Any, conditions: dict[str, float]) -> Uncertainties:
    """What the user states, with the published uncertainty of the law where nothing else has it."""
    own = Uncertainties.with_conditions(uncertainties, conditions)
    instruments = dict(own.instruments)
    if model.residual_uncertainty is None and not {"law", "law_ppm"} & set(instruments):
        instruments |= PUBLISHED
    return replace(own, instruments=instruments)


def _places(distance: NDArray[np.float64], u: NDArray[np.float64]) -> NDArray[np.int64]:
    """Rows to simulate: all, or the most uncertain one and others evenly over the distances."""
    known = np.flatnonzero(np.isfinite(distance))
    if len(known) <= _DRAWN_ROWS:
        return known
    ordered = known[np.argsort(distance[known], kind="stable")]
    evenly = ordered[np.linspace(0, len(ordered) - 1, _DRAWN_ROWS).astype(int)]
    return np.union1d(evenly, [known[int(np.argmax(u[known]))]])


def _notes(
    model: Model,
    rows: Any,
    found: Itemized,
    stated: Uncertainties,
    places: NDArray[np.int64],
    distance: NDArray[np.float64],
    drawn: MonteCarlo | None,
) -> list[str]:
    notes = list(sentences(rows.stated))
    groups = {entry.group for entry in found.entries}
    residual = model.residual_uncertainty
    if residual is None:
        notes.append("the model does not state the repeatability of a reading: state it, e.g. reading_mm=1")
        notes += _of_steps(rows, stated, 0.0)
    else:
        notes.append(
            "what the rows of the model showed of its thermometer, timer and law is in its repeatability; "
            "state only what is new"
        )
        notes += _of_steps(rows, stated, residual.step)
        far = 3.0 * found.standard_uncertainty
        outside = (distance + far < residual.low) | (distance - far > residual.high)
        if residual.rows and outside.any():
            notes.append(
                f"{int(outside.sum())} distances are outside of {residual.low:.3g} to {residual.high:.3g} m, "
                "where the repeatability was measured"
            )
    if "parameters" not in groups and model.effects:
        notes.append("the model states no uncertainty of its parameters")
    if drawn is not None and len(places) < np.isfinite(distance).sum():
        notes.append(f"the Monte Carlo method was used for {len(places)} rows, evenly over the distances")
    if drawn is not None and drawn.drawn_again:
        notes.append(f"{drawn.drawn_again} draws of parameters were beyond their bounds and drawn again")
    if ignored := [s for s in stated.stated if s in QUANTITIES and s not in model.reads]:
        notes.append(
            f"the model does not read {ignored[0].replace('_', ' ')}, so its uncertainty adds nothing"
        )
    return notes


def _of_steps(rows: Observations, stated: Uncertainties, known: float) -> list[str]:
    """What to say of the steps of readings, where the repeatability has the rounding of `known` steps [m]."""
    asked = [f"{name}={value}" for name, value in stated.instruments.items() if name.startswith("resolution")]
    if known and asked:
        return [
            f"the repeatability of the model has the rounding to steps of {1e3 * known:.3g} mm: only what is "
            f"more of {asked[0]} counts"
        ]
    grid = None if asked or rows.reading is None else find_grid(rows.reading[rows.usable])
    if grid is None or grid.step < max(_COARSER * known, FINEST_STEP):
        return []
    beside = f", and the model knows of steps of {1e3 * known:.3g} mm" if known else ""
    step = f"{1e3 * grid.step:.3g}"
    return [f"the readings are in steps of {step} mm{beside}: state them, resolution_mm={step}"]


def observations_of(model: Model, given: dict[str, Any]) -> Observations:
    """Rows for every combination of distances and conditions; the last one changes fastest.

    Raises `UsageError` if a name or a range cannot be understood, or there are too many combinations.
    """
    known = ("distance", *QUANTITIES)
    for name in given:
        if name not in known:
            raise UsageError(f"{keyword(name)}: no such condition{among(name, known, 'there are')}")
    if "distance" not in given:
        raise UsageError(f"give readings, or the distances of a grid: {keyword('distance', 2)}")
    axes = {name: np.atleast_1d(axis(name, own)) for name, own in given.items()}
    count = np.prod([float(len(values)) for values in axes.values()])
    if count > _LARGEST:
        raise UsageError(f"{count:.0f} combinations are more than {_LARGEST}; take larger steps")
    grid = dict(zip(axes, map(np.ravel, np.meshgrid(*axes.values(), indexing="ij")), strict=True))
    distance = grid.pop("distance")
    indication = np.asarray(model.indicate(distance, **grid))
    echo = np.asarray(Model(model.law).time_of_flight(indication, **grid))
    columns = {column: grid[name] for name, column in model.columns.items() if name in grid}
    conditions = {name: values for name, values in grid.items() if name not in model.columns}
    return Observations(echo, conditions, None, np.full(len(distance), ""), thermometers=columns)
