"""What columns of a log may hold, for a person to accept: by name and unit, else by their values."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from echocal.errors import EchocalError
from echocal.observations.checks import CODES
from echocal.observations.doubtful import doubtful_in
from echocal.observations.fields import is_empty, shown
from echocal.observations.found import Found
from echocal.observations.hints import completed, hint, is_time_name, role_of
from echocal.observations.names import EXTRA, IGNORE, by_name, by_request
from echocal.observations.units import NAMES
from echocal.observations.units_said import has_foreign_unit, split_unit, symbol_of

__all__ = ["Proposal", "codes_in", "propose", "unfit"]

Column = NDArray[np.float64]

_RANGES: dict[str, tuple[tuple[str, float, float], ...]] = {
    "reading": (("m", 0.02, 10.0), ("cm", 10.0, 600.0), ("mm", 600.0, 12000.0)),
    "distance": (("m", 0.02, 10.0), ("cm", 10.0, 600.0), ("mm", 600.0, 12000.0)),
    "echo": (("s", 1e-4, 0.06), ("ms", 0.1, 60.0), ("us", 100.0, 60000.0)),
    "temperature": (("C", -40.0, 48.0), ("F", 48.0, 120.0), ("K", 230.0, 330.0)),
    "humidity": (("percent", 1.5, 100.0),),
    "echo_quality": (("", 0.0, 1000.0),),
    "pressure": (("kPa", 60.0, 110.0), ("hPa", 600.0, 1100.0), ("Pa", 60000.0, 110000.0)),
}
"""Usual medians of a column by its unit."""


@dataclass(frozen=True)
class Proposal:
    """What a column may hold.

    Attributes
    ----------
    request : str
        As in ``--column``; empty for a column that is no quantity.
    reason : str
    guess : bool
        Whether it may be wrong: only the values say it.
    """

    request: str
    reason: str
    guess: bool = False


def propose(table: pd.DataFrame, found: Found, given: Mapping[str, str]) -> dict[str, Proposal]:
    """A proposal for each column; what the user says goes first."""
    columns = [str(name) for name in table.columns]
    doubtful = doubtful_in(table, {**found.requests, **given})
    sure, _ = completed(columns, given, found, doubtful)
    proposals = {name: _of_name(name, sure, given, found) for name in columns}
    held = {quantity for p in proposals.values() if (quantity := _quantity(p.request))}
    bare = {name: role for name in columns if not proposals[name].request and (role := role_of(name))}
    for name, role in sorted(bare.items(), key=lambda pair: pair[1] == "distance"):
        numbers = _numbers(table[name])
        if (
            numbers is None
            or name in doubtful
            or has_foreign_unit(name)
            or given.get(name) in {EXTRA, IGNORE}
        ):
            continue
        own = role
        unit = symbol_of(found.units.get(name, "")) or split_unit(name)[1] or _usual(own, numbers)
        request = _request(own, unit)
        if request and _quantity(request) not in held:
            usual = "of a quality number" if own == "echo_quality" else f"as usual in {unit or 'a fraction'}"
            why = f"its name, and values {usual}"
            proposals[name] = Proposal(request, why, guess=True)
            held.add(_quantity(request))
    if not {"reading", "echo_time"} & held:
        _by_values(table, found, proposals, held)
    if not {"reading", "echo_time"} & held:
        _reference_as_reading(table, proposals, given)
    return proposals


def unfit(table: pd.DataFrame, names: Sequence[str]) -> str:
    """Why columns that are called like an echo cannot be one; empty where one may be."""
    for name in table.columns:
        if has_foreign_unit(name) and role_of(name.partition("(")[0].partition("[")[0]) in {
            "reading",
            "echo",
        }:
            return f"'{name}' has a unit that echocal does not convert: convert it to m, cm, mm, inch or ft"
    for name in names:
        if _numbers(table[name]) is None:
            text = next((str(value) for value in table[name] if not is_empty(value)), "")
            return f"'{name}' has text ('{shown(text)}'): write plain numbers, 2495 or 2495.5"
    if not names and all(_numbers(table[name]) is None for name in table.columns):
        return "No column has numbers"
    return ""


def codes_in(values: pd.Series[Any]) -> list[float]:
    """Values that loggers write where they have none, and that lie far from all others."""
    numbers = _numbers(values)
    if numbers is None:
        return []
    finite = numbers[np.isfinite(numbers)]
    usual = finite[~np.isin(finite, CODES)]
    if not len(usual):
        return []
    low, high = np.quantile(usual, [0.01, 0.99])
    width = max(high - low, 0.01 * abs(high), 1e-9)
    return [code for code in CODES if code in finite and not low - 3 * width <= code <= high + 3 * width]


def _of_name(name: str, sure: Mapping[str, str], given: Mapping[str, str], found: Found) -> Proposal:
    if name in given:
        return Proposal(given[name], "as you say")
    if name in found.requests:
        why = "part of time, time_s" if found.requests[name] == IGNORE else "its values are times"
        return Proposal(found.requests[name], "the log says so" if name in found.sure else why)
    try:
        if ours := by_name(name):
            form, unit = ours
            return Proposal(f"{form.role}_{unit}" if unit else form.role, "its name")
    except EchocalError:
        if name not in sure:
            return Proposal("", "its name has no unit")
    if name in sure:
        return Proposal(sure[name], "its name and its unit")
    said = hint(name, found.units.get(name, ""))
    if said is not None:
        return Proposal("", f"may be {said.name}, as another column may be")
    return Proposal("", "")


def _by_values(table: pd.DataFrame, found: Found, proposals: dict[str, Proposal], held: set[str]) -> None:
    """The first column that varies like a reading, and the first after it like a temperature."""
    for name in map(str, table.columns):
        numbers = None if is_time_name(name) else _numbers(table[name])
        if proposals[name].request or numbers is None or _counts(numbers) or has_foreign_unit(name):
            continue
        stated = symbol_of(found.units.get(name, "")) or split_unit(name)[1]
        if not {"reading", "echo_time"} & held and (not stated or f"reading_{stated}" in NAMES):
            unit = stated or _usual("reading", numbers)
            if unit:
                proposals[name] = Proposal(
                    f"reading_{unit}", f"values as usual for a distance in {unit}", guess=True
                )
                held.add("reading")
        elif "temperature" not in held and not stated and _usual("temperature", numbers) == "C":
            proposals[name] = Proposal(
                "temperature_C", "values as usual for a temperature in degC", guess=True
            )
            held.add("temperature")


def _reference_as_reading(
    table: pd.DataFrame, proposals: dict[str, Proposal], given: Mapping[str, str]
) -> None:
    """The only distance of a log without an echo, as what the sensor reads."""
    distances = [name for name, p in proposals.items() if _quantity(p.request or "") == "reference_distance"]
    if len(distances) != 1 or distances[0] in given or _numbers(table[distances[0]]) is None:
        return
    if role_of(distances[0]) == "distance":  # a ruler is none, whatever else is missing
        return
    (name,) = distances
    request = f"reading_{proposals[name].request.rpartition('_')[2]}"
    if request in NAMES:
        proposals[name] = Proposal(request, "the only distance, and the log has no echo", guess=True)


def _counts(numbers: Column) -> bool:
    """Whether a column counts rows or the time."""
    steps = np.diff(numbers[np.isfinite(numbers)])
    return bool(len(steps) > 1 and (steps > 0).all())


def _usual(role: str, numbers: Column) -> str:
    """Unit in which the median is usual; of lengths with decimals or without."""
    finite = numbers[np.isfinite(numbers)]
    if not len(finite):
        return ""
    middle = float(np.median(finite))
    return next((unit for unit, low, high in _RANGES.get(role, ()) if low <= middle < high), "")


def _request(role: str, unit: str) -> str:
    name = f"{role}_{unit}" if unit else role
    return name if name in NAMES else ""


def _quantity(request: str) -> str:
    if not request or request in {EXTRA, IGNORE}:
        return ""
    try:
        found = by_request("", request)
    except EchocalError:
        return ""
    return "" if found is None or found[0].several else found[0].quantity


def _numbers(values: pd.Series[Any]) -> Column | None:
    if not pd.api.types.is_numeric_dtype(values) or pd.api.types.is_bool_dtype(values):
        numbers = pd.to_numeric(values, errors="coerce")
        if numbers.notna().sum() * 2 < len(values):
            return None
        values = numbers
    return values.to_numpy(dtype=np.float64, na_value=np.nan)
