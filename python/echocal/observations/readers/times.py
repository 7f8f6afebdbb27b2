"""One column of times: date and clock in two, a clock alone, seconds since 1970."""

from __future__ import annotations

import re
from collections.abc import Iterable
from dataclasses import replace
from typing import Any

import pandas as pd

from echocal.observations.dates import CLOCK, DAY, MONTH, unwrapped_clock
from echocal.observations.fields import floats, is_empty
from echocal.observations.found import Found
from echocal.observations.hints import is_time_name
from echocal.observations.in_time import counts_per_second
from echocal.observations.numbers import NO_NUMBER
from echocal.observations.units import NAMES

_NAMELESS = re.compile(r"column \d+")
_UNITS = {1.0: "time_s", 1e3: "time_ms", 1e6: "time_us"}
_LOOK = 500


def step(table: pd.DataFrame, found: Found) -> tuple[pd.DataFrame, Found]:
    """Make one column `time` or `time_s` where the log has times in another way."""
    named = [str(name) for name in table.columns if is_time_name(str(name)) or _NAMELESS.fullmatch(str(name))]
    days = [n for n in named if _share(table[n], DAY, clock=False)]
    clocks = [n for n in named if _share(table[n], CLOCK)]
    whole = [n for n in named if _share(table[n], DAY, clock=True)]
    if len(days) == 1 and len(clocks) == 1 and not whole:
        return together(table, found, days[0], clocks[0], table[clocks[0]])
    if len(clocks) == 1 and not whole and not days and not any(n in NAMES and n != "time" for n in named):
        return _clock(table, found, clocks[0])
    if "time" in table.columns and not pd.api.types.is_numeric_dtype(table["time"]):
        return table, found
    if len(whole) + len(days) == 1 and "time" not in table.columns:
        return table, _said(found, (whole + days)[0], "time")
    for name in named:
        if name in NAMES and name != "time":
            return table, found
        if scale := counts_per_second(floats(table[name])):
            if unit := _UNITS.get(scale):
                return table, _said(found, name, unit)
            table = table.assign(time_s=table[name] / scale)
            return table, _said(found, name, "ignore", f"'{name}' is read as nanoseconds since 1970")
    return table, found


def together(
    table: pd.DataFrame, found: Found, day: str, clock: str, times: Iterable[Any]
) -> tuple[pd.DataFrame, Found]:
    """One column `time` of those of a date and of a time of day, whose texts are `times`."""
    both = [
        f"{str(a).strip().split(' ')[0].split('T')[0]} {str(b).strip()}"
        if _filled(a) and _filled(b)
        else None
        for a, b in zip(table[day], times, strict=True)
    ]
    own = "time of day" if clock == "time" else clock
    table = table.rename(columns={clock: own}).assign(time=pd.Series(both, index=table.index, dtype=object))
    found = _said(found, day, "ignore", f"'{day}' and '{clock}' are read together as time")
    return table, replace(found, requests={**found.requests, own: "ignore"})


def _clock(table: pd.DataFrame, found: Found, name: str) -> tuple[pd.DataFrame, Found]:
    table = table.assign(time_s=unwrapped_clock(table[name].fillna("")))
    note = (
        f"'{name}' has times of day without a date: they are read as seconds, "
        "and a clock that falls back passed midnight"
    )
    return table, _said(found, name, "ignore", note)


def _said(found: Found, name: str, request: str, note: str = "") -> Found:
    notes = (*found.notes, note or f"'{name}' is read as {request}, by its values")
    return replace(found, notes=notes, requests={**found.requests, name: request})


def _share(values: pd.Series[Any], pattern: Any, *, clock: bool | None = None) -> bool:
    """Whether nearly all fields are written so."""
    if pd.api.types.is_numeric_dtype(values):
        return False
    texts = [str(v).strip() for v in values.iloc[:_LOOK] if _filled(v)]
    if pd.api.types.is_datetime64_any_dtype(values):
        return bool(clock) and pattern is DAY
    good = 0
    for text in texts:
        match = pattern.fullmatch(text)
        if match is None and pattern is DAY and clock:
            good += bool(MONTH.search(text) and ":" in text)
            continue
        has = match is not None and (
            clock is None or bool(match["clock"] and match["clock"][:8] != "00:00:00") == clock
        )
        good += has
    return bool(texts) and 10 * good >= 9 * len(texts)


def _filled(value: Any) -> bool:
    return not is_empty(value) and str(value).strip() not in NO_NUMBER
