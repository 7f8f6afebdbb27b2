"""The values that a sweep runs over."""

from collections.abc import Sequence
from typing import TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

from echocal.conditions import numbers
from echocal.errors import UsageError
from echocal.observations.units import NAMES
from echocal.quantities import QUANTITIES

Range: TypeAlias = "float | tuple[float, float, float] | Sequence[float] | NDArray[np.float64]"
"""One value; (start, stop, step), stop included; or values one by one."""

_LARGEST = 10_000_000
_LEAST = {name: facts.possible[0] for name, facts in QUANTITIES.items()} | {"distance": 0.0}  # SI


def axis(name: str, given: Range) -> NDArray[np.float64]:
    """Values of one quantity: a scalar array for one value, else one-dimensional.

    Raises `UsageError` if the range is empty or holds anything but finite, possible numbers.
    """
    values = _stepped(name, given) if isinstance(given, tuple) else _finite(name, given)
    if values.ndim > 1 or values.size == 0:
        message = f"{name}: expected one value, (start, stop, step) or a list, got shape {values.shape}"
        raise UsageError(message)
    low = _LEAST.get(name, -np.inf)
    if values.min() < low:
        raise UsageError(f"{name}: {values.min():g} is below {low:g}, the least that can be")
    if len(np.unique(values)) != values.size:
        raise UsageError(f"{name}: a value occurs more than once")
    return values


def parse(name: str, text: str) -> Range:
    """Range of a text: ``2``, ``0:50:2`` (stop included) or ``0.5,1,2``.

    Raises `UsageError` if the text is none of these.
    """
    separator = ":" if ":" in text else ","
    try:
        parts = [float(part) for part in text.split(separator)]
    except ValueError:
        parts = []
    match separator, parts:
        case _, [value]:
            return value
        case ":", [start, stop, step]:
            return start, stop, step
        case ",", [_, *_]:
            return parts
    raise UsageError(f"{name}: '{text}' is no range; write 20, or 0:50:2 (start:stop:step), or 0.5,1,2")


def parse_named(text: str) -> tuple[str, NDArray[np.float64]]:
    """Quantity and its values [SI] of a text with the unit in the name: ``humidity_percent=0:100:20``.

    Raises `UsageError` if the name is none of a table's columns, or the range is none.
    """
    name, _, range_ = text.partition("=")
    form, unit = NAMES.get(name, (None, ""))
    quantity = {"reference_distance": "distance"}.get(form.quantity, form.quantity) if form else ""
    if form is None or quantity not in {"distance", *QUANTITIES}:
        known = (column for column, (other, _) in NAMES.items() if other.quantity in QUANTITIES)
        raise UsageError(f"'{name}' names no influence quantity with its unit; known: {', '.join(known)}")
    return quantity, form.units[unit].to_si(axis(name, parse(name, range_)))


def _finite(name: str, given: ArrayLike) -> NDArray[np.float64]:
    values = numbers(name, given)
    if not np.isfinite(values).all():
        raise UsageError(f"{name}: expected finite numbers, got {given!r}")
    return values


def _stepped(name: str, given: tuple[float, ...]) -> NDArray[np.float64]:
    limits = _finite(name, given)
    if limits.shape != (3,):
        message = f"{name}: a tuple is (start, stop, step), got {given!r}; write values one by one as a list"
        raise UsageError(message)
    start, stop, step = limits.tolist()
    steps = (stop - start) / step if step else np.nan
    if not 0 <= steps < _LARGEST:
        reason = "has too many values" if steps >= _LARGEST else "never gets there"
        raise UsageError(f"{name}: from {start:g} to {stop:g} in steps of {step:g} {reason}")
    # decimals as a person writes them: 0.3, not 0.1 + 0.1 + 0.1
    return np.asarray(np.round(start + step * np.arange(int(steps + 1e-9) + 1), 12))
