"""Uncertainty of a distance that a device gives: law of propagation of uncertainty (JCGM 100:2008, 5.1.2)."""

import math
import warnings
from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from echocal.budget import complete
from echocal.budget.stated import Uncertainties
from echocal.correct.uncertainty import included, standard_uncertainty
from echocal.errors import DomainWarning
from echocal.model import Model
from echocal.observations import Observations
from echocal.quantities import DEFAULTS, QUANTITIES
from echocal.registry import find_effect

__all__ = ["COVERAGE", "expanded_uncertainty", "rounded_up"]

COVERAGE = 1.96
"""Standard uncertainties in an expanded one: 95 % of a normal distribution."""

_AT = (0.5, 1.0, 2.0, 4.0)  # m
_TEMPERATURE = 20.0  # degC; ISO 1:2022
_STEPS = 65  # of the distances to which the line is fitted; set by hand
_RECTANGULAR = 1.0 / math.sqrt(
    12.0
)  # standard uncertainty of a value that is anywhere in a range of 1 (4.3.7)


def expanded_uncertainty(
    model: Model, report: Mapping[str, Any], air: Mapping[str, float], stated: Uncertainties
) -> dict[str, Any]:
    """Expanded uncertainties of a device's outputs, and a line that is nowhere below them.

    Parameters
    ----------
    model : Model
        The model that the device follows.
    report : mapping
        What was proven.
    air : mapping of str to float
        Values of what the device does not measure.
    stated : Uncertainties
        What the user states. Where the model has no repeatability, the published uncertainty of its law
        counts, too.

    Returns
    -------
    dict
        ``includes``: lines in words; ``expanded``: pairs of distance and uncertainty [m]; ``offset`` [m] and
        ``slope`` [1] of the line.
    """
    kept, left_out = _folded(model, report)
    near, far = report["reach_m"]["sometimes"]
    near, far = max(near, 1e-3), min(far, report["maximum_distance_m"])
    marks = [distance for distance in _AT if near <= distance <= far]
    distance = np.array([*marks, *np.linspace(near, far, _STEPS)])
    conditions = _conditions(kept, report["device"]["conditions"], air)
    stated = complete(kept, stated, {})
    own, words = _inputs(kept, report["device"], conditions, stated)
    columns = {name: np.full(distance.size, value) for name, value in conditions.items()}
    with warnings.catch_warnings(action="ignore", category=DomainWarning):  # told of the code ranges
        echo_time = np.asarray(kept.time_of_flight(distance, **columns))
        echoes = Observations(echo_time, columns, None, np.full(distance.size, ""))
        size = standard_uncertainty(echoes, kept, distance, own)
    # Half widths of what is bounded and not distributed: of the arithmetic, and of effects that are left out.
    bounds = [report["error_proven_m"], *left_out]
    total = COVERAGE * np.sqrt(np.nan_to_num(size) ** 2 + sum(bound**2 for bound in bounds) / 3.0)
    offset, slope = _line(distance, total)
    parts = [*words, f"the arithmetic, anywhere within {rounded_up(bounds[0] * 1e3):g} mm"]
    parts += [f"effects that are left out, anywhere within {rounded_up(one * 1e3):g} mm" for one in left_out]
    return {
        "includes": [included(kept, stated).partition(" includes ")[2], *parts],
        "expanded": [(d, float(u)) for d, u in zip(marks, total[: len(marks)].tolist(), strict=True)],
        "offset": offset,
        "slope": slope,
    }


def _folded(model: Model, report: Mapping[str, Any]) -> tuple[Model, list[float]]:
    """Return the model without the effects that are left out, and the errors [m] which that leaves.

    Effects of the firmware are left out without an error: the function takes the place of that arithmetic.
    """
    gone = {one["effect"]: one["left_m"] for one in report["omissions"] if one["assumed"] is None}
    old = {id_ for id_ in model.effects if find_effect(id_).stage == "firmware"}
    if not gone and not old:
        return model, []
    effects = {id_: own for id_, own in model.effects.items() if id_ not in gone.keys() | old}
    places = [i for i, name in enumerate(model.parameter_names) if name.partition(".")[0] in effects]
    known = None if model.covariance is None else model.covariance[np.ix_(places, places)]
    residual = model.residual_uncertainty
    kept = Model(
        model.law,
        effects,
        air=model.air,
        covariance=known,
        residual_uncertainty=residual,
        columns=model.given_columns,
    )
    return kept, [left for left in gone.values() if math.isfinite(left)]


def _conditions(model: Model, axes: list[Mapping[str, Any]], air: Mapping[str, float]) -> dict[str, float]:
    """Return 20 degC or what is accepted next to it, the middle of the other ranges, and the air."""
    found = {name: air.get(name, DEFAULTS.get(name)) for name in model.reads}
    values = {name: value for name, value in found.items() if value is not None}
    for axis in axes:
        ends = sorted(axis["zero"] + axis["lsb"] * code for code in axis["codes"].values())
        wanted = _TEMPERATURE if axis["quantity"] == "temperature" else sum(ends) / 2.0
        values[axis["quantity"]] = min(max(wanted, ends[0]), ends[1])
    return values


def _inputs(
    model: Model,
    device: Mapping[str, Any],
    conditions: Mapping[str, float],
    stated: Uncertainties,
) -> tuple[Uncertainties, list[str]]:
    """Return the standard uncertainties of what the model reads, and words for them.

    Codes are rounded to a step. What is not measured is anywhere in its range in the field, unless the user
    states its uncertainty.
    """
    tick = device["echo"]["lsb"]
    sizes, words = {"echo_time": tick * _RECTANGULAR}, [f"echo times in steps of {tick * 1e6:g} us"]
    for axis in device["conditions"]:
        step, unit = abs(axis["lsb"]), "" if axis["unit"] == "1" else f" {axis['unit']}"
        sizes[axis["quantity"]] = step * _RECTANGULAR
        words.append(f"{axis['quantity']} in steps of {step:g}{unit}")
    known = {source.quantity for source in stated.sources}
    for name in sorted(model.reads & conditions.keys() - sizes.keys() - known):
        facts = QUANTITIES[name]
        low, high = (end + conditions.get(str(facts.field_from), 0.0) for end in facts.field_range)
        unit = "" if facts.unit == "1" else f" {facts.unit}"
        sizes[name] = (high - low) * _RECTANGULAR
        words.append(f"{name}, assumed {conditions[name]:g}{unit}, anywhere in {low:g} .. {high:g}{unit}")
    for name, size in stated.stated.items():
        sizes[name] = math.hypot(sizes.get(name, 0.0), size)
    if "temperature" not in known:
        words.append("nothing of the error of the thermometer itself: state it to include it")
    return Uncertainties(sizes, stated.instruments), words


def _line(distance: NDArray[np.float64], total: NDArray[np.float64]) -> tuple[float, float]:
    """Return offset and slope of the line through the ends, moved up until no point lies above it."""
    first, last = int(distance.argmin()), int(distance.argmax())
    span = float(distance[last] - distance[first])
    slope = max(0.0, float(total[last] - total[first]) / span) if span > 0.0 else 0.0
    return float((total - slope * distance).max()), slope


def rounded_up(value: float, places: int = 4) -> float:
    """Return a value rounded up: what is stated must hold.

    Examples
    --------
    >>> rounded_up(0.066705)
    0.0668
    """
    scale = 10.0**places
    return math.ceil(value * scale - 1e-9) / scale
