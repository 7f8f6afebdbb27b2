"""Uncertainty of a distance that a device gives: law of propagation of uncertainty (JCGM 100:2008, 5.1.2)."""

import itertools
import math
import warnings
from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from echocal.budget import complete
from echocal.budget.stated import Uncertainties
from echocal.codes import value_at
from echocal.correct.uncertainty import included, standard_uncertainty
from echocal.errors import DomainWarning, UsageError
from echocal.keywords import keyword
from echocal.model import Model
from echocal.observations import Observations
from echocal.quantities import DEFAULTS, QUANTITIES
from echocal.registry import find_effect

__all__ = ["COVERAGE", "expanded_uncertainty", "rounded_up"]

COVERAGE = 1.96
"""Standard uncertainties in an expanded one: 95 % of a normal distribution."""

_AT = (0.5, 1.0, 2.0, 4.0)  # m
_PLACES = 9  # temperatures that are tried; set by hand
_LARGEST = 16.0  # m; the function for the device has 32 bits: 2^32 / 2^8 um
_STEPS = 65  # of the distances to which the line is fitted; set by hand
_RECTANGULAR = 1.0 / math.sqrt(
    12.0
)  # standard uncertainty of a value that is anywhere in a range of 1 (4.3.7)


def expanded_uncertainty(
    model: Model, report: Mapping[str, Any], air: Mapping[str, float], stated: Uncertainties
) -> dict[str, Any]:
    """Expanded uncertainties of a device's outputs, and a line that is nowhere below them.

    The report has what was proven, and the air what the device does not measure. Where the model has no
    repeatability, the published uncertainty of its law counts beside what the user states.

    Returns
    -------
    dict
        ``includes``: lines in words; ``expanded``: pairs of distance and uncertainty [m]; ``offset`` [m] and
        ``slope`` [1] of the line.
    """
    kept, left_out = _folded(model, report)
    device, known = report["device"], stated
    _refuse_unread(kept, device, known)
    near, far = report["reach_m"]["sometimes"]
    near, limit = max(near, 1e-3), report["maximum_distance_m"]
    bounded = min(far, limit)
    marks = [one for one in _AT if near <= one <= bounded] or [round(bounded, 3)]
    distance = np.array([*marks, *np.linspace(near, far, _STEPS)])
    stated = complete(kept, known, {})
    sizes = np.zeros(distance.size)
    words: list[str] = []
    for conditions in _conditions(kept, device["conditions"], air):
        own, parts = _inputs(kept, device, conditions, stated)
        columns = {name: np.full(distance.size, value) for name, value in conditions.items()}
        with warnings.catch_warnings(action="ignore", category=DomainWarning):  # told of the code ranges
            echo_time = np.asarray(kept.time_of_flight(distance, **columns))
            echoes = Observations(echo_time, columns, None, np.full(distance.size, ""))
            size = np.nan_to_num(standard_uncertainty(echoes, kept, distance, own))
        if not words or size[len(marks) - 1] > sizes[len(marks) - 1]:
            words = parts
        sizes = np.maximum(sizes, size)
    # Half widths of what is bounded and not distributed: of the arithmetic, and of effects that are left out.
    arithmetic = np.where(distance <= limit, report["error_proven_m"], report["error_overall_m"])
    beyond = np.maximum(1.0, distance / limit)
    bounds = [arithmetic, *(left * beyond for left in left_out)]
    total = COVERAGE * np.sqrt(sizes**2 + sum(bound**2 for bound in bounds) / 3.0)
    offset, slope = _line(distance, total)
    if offset + slope * far > _LARGEST:
        raise UsageError(
            f"the expanded uncertainty reaches {offset + slope * far:.3g} m, more than {_LARGEST:g} m, and "
            f"the device's function cannot state it; give smaller {keyword('uncertainties')}"
        )
    inner, outer = (rounded_up(report[name] * 1e3) for name in ("error_proven_m", "error_overall_m"))
    parts = [*words, f"the arithmetic, anywhere within {inner:g} mm; {outer:g} mm beyond {limit:g} m"]
    parts += [f"effects that are left out, anywhere within {rounded_up(one * 1e3):g} mm" for one in left_out]
    return {
        "includes": [included(kept, stated).partition(" includes ")[2], *parts],
        "expanded": [(d, float(u)) for d, u in zip(marks, total[: len(marks)].tolist(), strict=True)],
        "offset": offset,
        "slope": slope,
    }


def _refuse_unread(model: Model, device: Mapping[str, Any], stated: Uncertainties) -> None:
    """Refuse uncertainties of what changes no output: the header would say that it includes them."""
    read = {axis["quantity"] for axis in device["conditions"]} | (model.reads - _replaced(model))
    for name in stated.stated:
        _refuse(name, {name}, read)
    for name, value in stated.instruments.items():
        _refuse(name, {one.quantity for one in Uncertainties({}, {name: value}).sources}, read)


def _refuse(name: str, quantities: set[str], read: set[str]) -> None:
    if quantities - read - {"echo_time", "speed_of_sound"}:
        known = ", ".join(["echo_time", *sorted(read)])
        raise UsageError(
            f"{keyword('uncertainties')} states {name.replace('_', ' ')}, which changes no distance of this "
            f"device; leave it out. The distance depends on: {known}"
        )


def _replaced(model: Model) -> set[str]:
    """Return the quantities that effects of the model replace."""
    return {name for id_ in model.effects for name in find_effect(id_).excludes}


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


def _conditions(
    model: Model, axes: list[Mapping[str, Any]], air: Mapping[str, float]
) -> list[dict[str, float]]:
    """Return accepted conditions: temperatures, ends and middle of the other ranges, and the air."""
    found = {name: air.get(name, DEFAULTS.get(name)) for name in model.reads - _replaced(model)}
    values = {name: value for name, value in found.items() if value is not None}
    tried = []
    for axis in axes:
        ends = sorted(value_at(axis, code) for code in axis["codes"].values())
        tried.append(
            np.linspace(ends[0], ends[1], _PLACES if axis["quantity"] == "temperature" else 3).tolist()
        )
    names = [axis["quantity"] for axis in axes]
    return [values | dict(zip(names, own, strict=True)) for own in itertools.product(*tried)]


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
        unit = "" if axis["unit"] == "1" else f" {axis['unit']}"
        step = abs(axis["lsb"]) * (1 << axis.get("shift", 0))
        sizes[axis["quantity"]] = step * _RECTANGULAR
        at = f"{conditions[axis['quantity']]:g}{unit}"
        words.append(f"{axis['quantity']} in steps of {step:g}{unit}; the uncertainty is largest at {at}")
    known = {source.quantity for source in stated.sources}
    for name in sorted((model.reads & conditions.keys()) - sizes.keys() - known):
        facts = QUANTITIES[name]
        low, high = (end + conditions.get(str(facts.field_from), 0.0) for end in facts.field_range)
        unit = "" if facts.unit == "1" else f" {facts.unit}"
        # About the assumed value: what is not corrected counts (JCGM 100:2008, F.2.4.5).
        sizes[name] = math.hypot((high - low) * _RECTANGULAR, (low + high) / 2.0 - conditions[name])
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
