"""Steps that concern units: in each cell, as the name of a column, of ROS messages, the same in two.

``12.3 cm`` in each cell; columns called ``inches`` and ``ms``, where a length says what a time beside it is;
topics that ``rostopic echo -p`` prints, whose units the message definitions fix; ``Distance (cm)`` beside
``Distance (in)``, the same quantity in two units or with fewer digits.
"""

from __future__ import annotations

import re
from dataclasses import replace
from itertools import combinations, pairwise
from typing import Any

import numpy as np
import pandas as pd

from echocal.arrays import Column
from echocal.errors import DataError
from echocal.observations.alike import echo_speed, is_set, resolution
from echocal.observations.found import Found
from echocal.observations.hints import hint, role_of
from echocal.observations.names import EXTRA, by_name
from echocal.observations.numbers import NO_NUMBER
from echocal.observations.readers.log import numeric
from echocal.observations.units import NAMES, split_unit, symbol_of

_TIMES = ("us", "ms", "s")
_LENGTHS = ("m", "cm", "mm", "inch", "ft")
_ECHOES = (1e-4, 0.06)  # s: 1.7 cm to 10 m
_NAMELESS = re.compile(r"(?i)column \d+|unnamed \d+|units?|einheit(?:en)?")
_CELL = r"^([-+]?\d*[.,]?\d+(?:[eE][-+]?\d+)?)\s*([^\d\s.,:/-][^\d]{0,7})$"
_UNITS_OF_MESSAGES = {"range": "m", "temperature": "degC", "fluid_pressure": "Pa", "illuminance": "lux"}
"""sensor_msgs/Range, Temperature, FluidPressure, Illuminance (ROS 1 and 2, common_interfaces)."""


def columns_named_by_unit(table: pd.DataFrame, found: Found) -> tuple[pd.DataFrame, Found]:
    """Take a time for an echo where a length beside it agrees, or where it can be nothing else."""
    requests, notes = dict(found.requests), list(found.notes)
    lengths = {
        n: unit
        for n in map(str, table.columns)
        if (unit := _unit(n, found)) in _LENGTHS and _is_numeric(table[n])
    }
    for name in map(str, table.columns):
        unit = symbol_of(name)
        if (
            unit not in _TIMES
            or name in requests
            or not _is_numeric(table[name])
            or _runs_on(_si(table, name, f"echo_{unit}"))
        ):
            continue
        seconds = _si(table, name, f"echo_{unit}")
        for length, own in lengths.items():
            speed = echo_speed(_si(table, length, f"distance_{own}"), seconds)
            if speed:
                requests[name] = f"echo_{unit}"
                notes.append(f"'{name}' is read as echo_{unit}: it agrees with '{length}' ({speed:.0f} m/s)")
                break
        else:
            if unit == "us" and _ECHOES[0] <= np.nanmedian(seconds) <= _ECHOES[1]:
                requests[name] = "echo_us"
                notes.append(f"'{name}' is read as echo_us: its values go up and down, so it is no clock")
    return table, replace(found, requests=requests, notes=tuple(notes))


def _unit(name: str, found: Found) -> str:
    return symbol_of(found.units.get(name, "")) or symbol_of(name) or split_unit(name)[1]


def _si(table: pd.DataFrame, name: str, as_: str) -> Column:
    form, unit = NAMES[as_]
    return np.asarray(form.units[unit].to_si(table[name].to_numpy(dtype=np.float64, na_value=np.nan)))


def _is_numeric(values: pd.Series[float]) -> bool:
    return bool(
        pd.api.types.is_numeric_dtype(values)
        and not pd.api.types.is_bool_dtype(values)
        and values.notna().any()
    )


def _runs_on(seconds: Column) -> bool:
    """Whether a time only grows, as that of a clock does."""
    steps = np.diff(seconds[np.isfinite(seconds)])
    return bool(len(steps) > 1 and (steps >= 0.0).all() and (steps > 0.0).any())


def units_in_cells(table: pd.DataFrame, found: Found) -> tuple[pd.DataFrame, Found]:
    """Take the unit out of the cells of columns where nearly all have the same."""
    units = dict(found.units)
    for name in table.columns:
        if pd.api.types.is_numeric_dtype(table[name]) or table[name].isna().all():
            continue
        texts: pd.Series[Any] = (
            table[name].astype(object).map(lambda v: v.strip() if isinstance(v, str) else v)
        )
        filled = texts[texts.map(lambda v: isinstance(v, str) and v not in NO_NUMBER)]
        parts = filled.astype(str).str.extract(_CELL)
        known = parts[1].dropna().map(symbol_of)
        usual = known[known != ""].mode()
        grouped = parts[0].dropna().str.fullmatch(r"[-+]?[1-9]\d{0,2},\d{3}")
        if grouped.any() and not parts[0].dropna().str.fullmatch(r"[-+]?0?,\d+|[-+]?\d+,\d{1,2}").any():
            continue  # 2,495 may be 2495
        if usual.empty or 10 * int((known == usual[0]).sum()) < 9 * len(filled):
            continue
        same = known.index[known == usual[0]]
        values = texts.copy()
        values[same] = parts.loc[same, 0].str.replace(",", ".", regex=False)
        table = table.assign(**{name: numeric(values)})
        units.setdefault(str(name), str(parts[1].dropna().mode()[0]).strip())
    return table, replace(found, units={**_beside(table), **units})


def _beside(table: pd.DataFrame) -> dict[str, str]:
    """Units in columns of their own behind the numbers, in a table without names: ``1.234,M,20.1,C``."""
    units = {}
    for name, behind in pairwise(table.columns):
        if not _NAMELESS.fullmatch(str(behind)):
            continue
        if not pd.api.types.is_numeric_dtype(table[name]) or pd.api.types.is_numeric_dtype(table[behind]):
            continue
        texts = table[behind].dropna().astype(str).str.strip().unique()
        if len(texts) == 1 and symbol_of(texts[0]):
            units[str(name)] = str(texts[0])
    return units


def units_of_messages(table: pd.DataFrame, found: Found) -> tuple[pd.DataFrame, Found]:
    """Units of the fields of sensor messages."""
    names = [str(name) for name in table.columns]
    if "%time" not in names and not any(name.startswith(("field.header", "header.stamp")) for name in names):
        return table, found
    units = {
        name: _UNITS_OF_MESSAGES[last]
        for name in names
        if (last := name.rpartition(".")[2]) in _UNITS_OF_MESSAGES
    }
    return table, replace(found, units={**units, **found.units})


def repeated(table: pd.DataFrame, found: Found) -> tuple[pd.DataFrame, Found]:
    """Leave the one with the coarser steps aside, where two are the same within their rounding."""
    held: dict[str, list[tuple[str, str]]] = {}
    for name in map(str, table.columns):
        said = _quantity(name, found)
        if said and pd.api.types.is_numeric_dtype(table[name]):
            held.setdefault(NAMES[said][0].quantity, []).append((name, said))
    requests, notes = dict(found.requests), list(found.notes)
    for pairs in held.values():
        for first, second in combinations(pairs, 2):
            coarser = _coarser(table, first, second) if {first[0], second[0]}.isdisjoint(requests) else None
            if coarser is not None:
                other = second if coarser == first else first
                requests[coarser[0]] = EXTRA
                notes.append(f"'{coarser[0]}' is '{other[0]}' within its rounding, and is left aside")
    return table, replace(found, requests=requests, notes=tuple(notes))


def _quantity(name: str, found: Found) -> str:
    """Which quantity a column holds by its name, in echocal's way; empty for none."""
    try:
        ours = by_name(name)
    except DataError:
        ours = None
    if ours is None:
        said = hint(name, found.units.get(name, ""))
        return "" if said is None or said.name not in NAMES else said.name
    form, unit = ours
    return (
        ""
        if form.label or form.several or form.quantity == "elapsed_time"
        else f"{form.role}_{unit}"
        if unit
        else form.role
    )


def _coarser(table: pd.DataFrame, first: tuple[str, str], second: tuple[str, str]) -> tuple[str, str] | None:
    """Which of two columns has fewer digits, if both are the same in each row; None where they are not."""
    if role_of(first[0]) != role_of(second[0]):
        return None  # a ruler and a ranger
    values, digits, fixed = [], [], []
    for name, said in (first, second):
        form, unit = NAMES[said]
        numbers = table[name].to_numpy(dtype=np.float64, na_value=np.nan)
        values.append(np.asarray(form.units[unit].to_si(numbers)))
        digits.append(resolution(numbers) * float(form.units[unit].to_si(1.0) - form.units[unit].to_si(0.0)))
        fixed.append(is_set(numbers))
    missing = np.isnan(values[0]) != np.isnan(values[1])
    apart = np.abs(values[0] - values[1])
    both = np.isfinite(apart)
    fine, coarse = min(digits), max(digits)
    # one may be made of the other as it is written; else a column of whole numbers may be cut, not rounded
    open_ = fine if fixed[int(digits[1] > digits[0])] else 2.0 * coarse + fine
    if not both.any() or missing.any() or apart[both].max() > 0.5001 * open_ + 1e-9:
        return None
    if np.ptp(values[0][both]) < 4 * coarse:
        return None  # two sensors of one quiet quantity look the same
    return first if digits[0] > digits[1] else second
