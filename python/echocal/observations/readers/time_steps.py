"""One column of times: date and clock in two, a clock alone, seconds since 1970, a date in pieces."""

from __future__ import annotations

import re
from dataclasses import replace
from typing import Any

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from echocal.observations.dates import CLOCK, DAY, MONTH, unwrapped_clock
from echocal.observations.found import Found
from echocal.observations.hints import is_time_name
from echocal.observations.in_time import counts_per_second
from echocal.observations.numbers import NO_NUMBER
from echocal.observations.units import NAMES

__all__ = ["date_in_pieces", "one_time"]

_NAMELESS = re.compile(r"column \d+")
_UNITS = {1.0: "time_s", 1e3: "time_ms", 1e6: "time_us"}
_LOOK = 500
_PIECES: dict[str, tuple[frozenset[str], tuple[int, int]]] = {
    "year": (frozenset({"year", "yyyy", "yr", "jahr", "annee", "año", "år"}), (1970, 2261)),
    "month": (frozenset({"month", "mon", "mo", "monat", "mois", "mes", "måned"}), (1, 12)),
    "day": (frozenset({"day", "dd", "mday", "tag", "jour", "dia", "dag", "day_of_month"}), (1, 31)),
    "day_of_year": (frozenset({"day_of_year", "doy", "yday", "jday", "julian_day", "julday"}), (1, 366)),
    "hour": (frozenset({"hour", "hours", "hh", "hr", "stunde", "heure", "hora", "time_hour"}), (0, 24)),
    "minute": (frozenset({"minute", "minutes", "min", "mins", "mi", "time_minute"}), (0, 59)),
    "second": (frozenset({"second", "seconds", "sec", "secs", "ss", "sekunde", "time_second"}), (0, 60)),
}
"""Names of each piece, in lower case, and its least and largest value."""

_COARSER = {"second": "minute", "minute": "hour"}
_SOUND = 0.9  # of the fields: as of other columns of numbers


def one_time(table: pd.DataFrame, found: Found) -> tuple[pd.DataFrame, Found]:
    """Make one column `time` or `time_s` where the log has times in another way."""
    named = [str(name) for name in table.columns if is_time_name(str(name)) or _NAMELESS.fullmatch(str(name))]
    days = [n for n in named if _share(table[n], DAY, clock=False)]
    clocks = [n for n in named if _share(table[n], CLOCK)]
    whole = [n for n in named if _share(table[n], DAY, clock=True)]
    if len(days) == 1 and len(clocks) == 1 and not whole:
        return _joined(table, found, days[0], clocks[0])
    if len(clocks) == 1 and not whole and not days and not any(n in NAMES and n != "time" for n in named):
        return _clock(table, found, clocks[0])
    if "time" in table.columns and not pd.api.types.is_numeric_dtype(table["time"]):
        return table, found
    if len(whole) + len(days) == 1 and "time" not in table.columns:
        return table, _said(found, (whole + days)[0], "time")
    for name in named:
        if name in NAMES and name != "time":
            return table, found
        if scale := _epoch(table[name]):
            if unit := _UNITS.get(scale):
                return table, _said(found, name, unit)
            table = table.assign(time_s=table[name] / scale)
            return table, _said(found, name, "ignore", f"'{name}' is read as nanoseconds since 1970")
    return table, found


def _joined(table: pd.DataFrame, found: Found, day: str, clock: str) -> tuple[pd.DataFrame, Found]:
    both = [
        f"{str(a).strip().split(' ')[0].split('T')[0]} {str(b).strip()}"
        if _filled(a) and _filled(b)
        else None
        for a, b in zip(table[day], table[clock], strict=True)
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


def _epoch(values: pd.Series[Any]) -> float | None:
    """How many make a second since 1970; None for other numbers."""
    numbers = pd.to_numeric(values, errors="coerce")
    return counts_per_second(numbers.to_numpy(dtype=np.float64, na_value=np.nan))


def _filled(value: Any) -> bool:
    return value is not None and value == value and str(value).strip() not in NO_NUMBER


def date_in_pieces(table: pd.DataFrame, found: Found) -> tuple[pd.DataFrame, Found]:
    """Make one column `time` of the pieces, where the year and the day are among them.

    Examples
    --------
    >>> import pandas as pd
    >>> table = pd.DataFrame({"Year": [2024], "Month": [5], "Day": [31], "Hour": [13], "Min": [45]})
    >>> made, found = date_in_pieces(table, Found())
    >>> made["time"].astype(str).tolist(), found.notes
    (['2024-05-31 13:45:00'], ("'Year', 'Month', 'Day', 'Hour', 'Min' are read together as time",))
    """
    columns = _columns(table)
    days = {"month", "day"} if {"month", "day"} <= {*columns} else {"day_of_year"}
    if "time" in table.columns or not {"year", *days} <= {*columns}:
        return table, found
    used = {
        piece: name for piece, name in columns.items() if piece in {"year", *days, *_time_of_day(columns)}
    }
    values = {piece: _numbers(table[name]) for piece, name in used.items()}
    if not all(_is_piece(piece, own) for piece, own in values.items()):
        return table, found
    time = _dates(values)
    for piece, seconds in (("hour", 3600.0), ("minute", 60.0), ("second", 1.0)):
        if piece in values:
            time = time + pd.to_timedelta(seconds * values[piece], unit="s")
    names = ", ".join(f"'{name}'" for name in used.values())
    requests = {**found.requests, **dict.fromkeys(used.values(), "ignore")}
    notes = (*found.notes, f"{names} are read together as time")
    return table.assign(time=time), replace(found, notes=notes, requests=requests)


def _columns(table: pd.DataFrame) -> dict[str, str]:
    """Column of each piece, where one alone is called so."""
    plain = {str(name): str(name).strip().lower().replace(" ", "_") for name in table.columns}
    listed = {
        piece: [name for name, own in plain.items() if own in words] for piece, (words, _) in _PIECES.items()
    }
    return {piece: names[0] for piece, names in listed.items() if len(names) == 1}


def _time_of_day(columns: dict[str, str]) -> list[str]:
    """Pieces of the clock: a minute without its hour is none."""
    return [p for p in ("hour", "minute", "second") if p in columns and _COARSER.get(p, p) in columns]


def _numbers(values: pd.Series[Any]) -> NDArray[np.float64]:
    numbers = pd.to_numeric(values, errors="coerce")
    return np.asarray(numbers.to_numpy(dtype=np.float64, na_value=np.nan))


def _is_piece(piece: str, values: NDArray[np.float64]) -> bool:
    low, high = _PIECES[piece][1]
    sound = (values >= low) & (values < high + 1)
    if piece != "second":
        sound &= values == np.floor(values)
    return bool(len(values)) and float(sound.mean()) >= _SOUND


def _dates(values: dict[str, NDArray[np.float64]]) -> pd.Series[Any]:
    """Midnights; none where a piece is missing or impossible."""
    if "month" in values:
        parts = {piece: values[piece] for piece in ("year", "month", "day")}
        dates: pd.Series[Any] = pd.to_datetime(pd.DataFrame(parts), errors="coerce")
        return dates
    first = {
        "year": values["year"],
        "month": np.ones_like(values["year"]),
        "day": np.ones_like(values["year"]),
    }
    days = pd.to_timedelta(values["day_of_year"] - 1.0, unit="D")
    years: pd.Series[Any] = pd.to_datetime(pd.DataFrame(first), errors="coerce")
    return years + days
