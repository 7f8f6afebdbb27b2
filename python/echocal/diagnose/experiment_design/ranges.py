"""Names and ranges of the conditions that a user can vary for the next measurements."""

import math
from collections.abc import Iterable, Mapping, Sequence
from itertools import product
from numbers import Real
from typing import Any

import numpy as np
from numpy.typing import NDArray

from echocal.errors import UsageError
from echocal.observations.units import FORMS
from echocal.quantities import QUANTITIES

__all__ = ["Ranges", "checked_ranges", "corners_and_middle", "grid", "parsed_ranges"]

Ranges = Mapping[str, tuple[float, float]]
Column = NDArray[np.float64]

_POINTS = {1: 9, 2: 7, 3: 3}
"""Levels of each condition, by the number of conditions; more than three have their ends only."""

_PHYSICAL = {form.quantity: form.physical for form in FORMS}
_PHYSICAL["distance"] = _PHYSICAL["reference_distance"]
"""Values that a table of measurements may have."""

_UNITS = {"distance": " m"} | {
    name: "" if quantity.unit == "1" else f" {quantity.unit}"
    for name, quantity in QUANTITIES.items()
    if quantity.derived_from is None
}
"""Units of the conditions that a user can vary; derived conditions follow from them."""

_PRESENT = 3  # most levels of the table that are tried in addition


def parsed_ranges(texts: Iterable[str]) -> dict[str, tuple[float, float]]:
    """Read several ranges, each of another condition."""
    ranges: dict[str, tuple[float, float]] = {}
    for text in texts:
        name, ends = _parsed(text)
        if name in ranges:
            low, high = ranges[name]
            message = (
                f"--can-vary gives {name} twice: {low:g}:{high:g} and {ends[0]:g}:{ends[1]:g}; give one range"
            )
            raise UsageError(message)
        ranges[name] = ends
    return ranges


def _parsed(text: str) -> tuple[str, tuple[float, float]]:
    """Read ``distance=0.2:4``."""
    name, equals, ends = text.partition("=")
    low, colon, high = ends.partition(":")
    try:
        if equals and colon:
            return name, (float(low), float(high))
    except ValueError:
        pass
    message = f"--can-vary '{text}' is not a range such as distance=0.2:4"
    raise UsageError(message)


def checked_ranges(can_vary: Mapping[str, Sequence[float]], recorded: Sequence[str]) -> Ranges:
    """Refuse names that are not recorded and values that are not ranges."""
    if not isinstance(can_vary, Mapping):
        message = f"can_vary maps conditions to two ends, {{'distance': (0.2, 4.0)}}; got {can_vary!r}"
        raise UsageError(message)
    names = ["distance", *(name for name in recorded if name in _UNITS and not QUANTITIES[name].runs_on)]
    for name, ends in can_vary.items():
        if name not in names:
            known = ", ".join(f"{name} (in{_UNITS[name]})" if _UNITS[name] else name for name in names)
            message = (
                f"can_vary names '{name}', which the table does not record; it can name {known}. A "
                "condition that is not recorded does not separate causes"
            )
            raise UsageError(message)
        if not _is_range(ends):
            message = f"can_vary gives {name} the range {ends!r}; give two ends, the lower one first"
            raise UsageError(message)
        if name == "distance" and ends[0] <= 0:
            message = f"can_vary gives the distance a range from {ends[0]:g} m on; give a positive distance"
            raise UsageError(message)
        low, high = _PHYSICAL.get(name, (-math.inf, math.inf))
        if not low <= ends[0] < ends[1] <= high:
            possible = f"{low:g} to {high:g}{_UNITS[name]}"
            message = f"can_vary gives {name} the range {ends!r}; a table can have {possible}"
            raise UsageError(message)
    return {name: (float(low), float(high)) for name, (low, high) in can_vary.items()}


def _is_range(ends: Any) -> bool:
    pair = isinstance(ends, Sequence) and len(ends) == 2 and all(isinstance(end, Real) for end in ends)
    return pair and all(math.isfinite(end) for end in ends) and ends[0] < ends[1]


def grid(ranges: Ranges, present: Mapping[str, Column] | None = None) -> dict[str, Column]:
    """Places that are tried: all combinations of a few levels, distances in equal ratios.

    Levels of the table are tried, too, if they are few and within the range.
    """
    count = _POINTS.get(len(ranges), 2)
    levels = []
    for name, (low, high) in ranges.items():
        tried = np.geomspace(low, high, count) if name == "distance" else np.linspace(low, high, count)
        there = (present or {}).get(name, tried[:0])
        there = there[(there >= low) & (there <= high)]
        levels.append(np.union1d(tried, there) if len(there) <= _PRESENT else tried)
    points = np.array(list(product(*levels)))
    return {name: points[:, i] for i, name in enumerate(ranges)}


def corners_and_middle(places: Mapping[str, Column]) -> NDArray[np.int64]:
    """Places at which every condition is at an end of its range, and the place nearest to the middle."""
    ends, off = [], np.zeros(len(next(iter(places.values()))))
    for name, column in places.items():
        value = np.log(column) if name == "distance" else column
        low, high = value.min(), value.max()
        ends.append((value == low) | (value == high))
        off += ((value - low) / (high - low) - 0.5) ** 2
    return np.append(np.flatnonzero(np.all(ends, axis=0)), off.argmin())
