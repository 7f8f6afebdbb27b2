"""Names and ranges of the conditions that a user can vary for the next measurements."""

import math
from collections.abc import Mapping, Sequence
from numbers import Real
from typing import Any

import numpy as np
from numpy.typing import NDArray

from echocal.errors import UsageError
from echocal.observations.units import FORMS
from echocal.quantities import QUANTITIES

__all__ = ["Ranges", "checked_ranges", "corners_and_middle"]

Ranges = Mapping[str, tuple[float, float]]
Column = NDArray[np.float64]

_PHYSICAL = {form.quantity: form.physical for form in FORMS}
_PHYSICAL["distance"] = _PHYSICAL["reference_distance"]
"""Values that a table of measurements may have."""

_UNITS = {"distance": " m"} | {
    name: "" if quantity.unit == "1" else f" {quantity.unit}"
    for name, quantity in QUANTITIES.items()
    if quantity.derived_from is None
}
"""Units of the conditions that a user can vary; derived conditions follow from them."""


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


def corners_and_middle(ranges: Ranges) -> dict[str, Column]:
    """Places at the ends of all ranges, and in their middle; distances have equal ratios.

    Of more than three conditions, a part of the corners: a fractional factorial design, in which each
    condition is at each end equally often.
    """
    bits = max(min(len(ranges), 3), len(ranges).bit_length())
    masks = sorted(range(1, 2**bits), key=lambda mask: (mask.bit_count() > 1, -mask.bit_count(), -mask))
    columns = {}
    for (name, (low, high)), mask in zip(ranges.items(), masks, strict=False):
        ends = [(low, high)[(corner & mask).bit_count() % 2] for corner in range(2**bits)]
        middle = math.sqrt(low * high) if name == "distance" else 0.5 * (low + high)
        columns[name] = np.array([*ends, middle])
    return columns
