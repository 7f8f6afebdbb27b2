"""A date in pieces: columns of the year, the month, the day, the hour, the minute and the second.

The time of day may also be one number, as 1345 (hours and minutes) or 13.75 (hours), and the day of the year
may have it as its fraction.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pandas as pd

from echocal.arrays import Column
from echocal.observations.dates import DAY
from echocal.observations.fields import floats
from echocal.observations.found import Found
from echocal.observations.readers.times import together

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

_HHMM = frozenset(
    {"hhmm", "hh:mm", "hourmin", "hour_min", "hour_minute", "hrmin", "hrmn", "time_hhmm", "time"}
)
"""Names of hours and minutes as one number: 1345."""
_DATES = frozenset({"date", "datum", "fecha"})
"""Names of a date that hours and minutes as one number may be beside."""
_MIDNIGHT = ("00:00:00", "00:00", "0:00", "0:00:00")
_SUFFIX = "_rtm"  # of a Campbell array: Year_RTM, Day_RTM, Hour_Minute_RTM
_COARSER = {"second": "minute", "minute": "hour"}
_MINUTES, _HOURS, _LAST = 60, 24, 2400
_DIGITS = 3  # of a second: as printed fractions of a day have them
_SOUND = 0.9  # of the fields: as of other columns of numbers


def step(table: pd.DataFrame, found: Found) -> tuple[pd.DataFrame, Found]:
    """Make one column `time` of the pieces, where the year and the day are among them.

    Examples
    --------
    >>> import pandas as pd
    >>> table = pd.DataFrame({"Year": [2024], "Month": [5], "Day": [31], "Hour": [13], "Min": [45]})
    >>> made, found = step(table, Found())
    >>> made["time"].astype(str).tolist(), found.notes
    (['2024-05-31 13:45:00'], ("'Year', 'Month', 'Day', 'Hour', 'Min' are read together as time",))
    """
    if "time" in table.columns and not pd.api.types.is_numeric_dtype(table["time"]):
        return table, found
    if beside := _beside_a_date(table):
        hours = _in_hours({"hour": floats(table[beside[1]])}, {"hour": beside[1]})["hour"]
        minutes = np.round(_MINUTES * hours)
        clock = [None if np.isnan(m) else f"{int(m) // 60:02d}:{int(m) % 60:02d}" for m in minutes]
        return together(table, found, *beside, clock)
    columns = _columns(table)
    days = {"month", "day"} if {"month", "day"} <= {*columns} else {"day_of_year"}
    if not {"year", *days} <= {*columns}:
        return table, found
    used = {piece: name for piece, name in columns.items() if piece in {"year", *days, *_clock(columns)}}
    values = _in_hours({piece: floats(table[name]) for piece, name in used.items()}, used)
    if "hour" in values and "second" in columns and (values["hour"] % 1.0).any() and "minute" not in used:
        used["second"] = columns["second"]  # of hours and minutes as one number
        values["second"] = floats(table[used["second"]])
    one_number = {"hour"} if "minute" not in used else set()
    finest = next(piece for piece in ("second", "minute", "hour", "day", "day_of_year") if piece in values)
    if not all(_is_piece(piece, own, piece in {finest, *one_number}) for piece, own in values.items()):
        return table, found
    table = table.rename(columns={"time": "time of day"})
    used = {piece: "time of day" if name == "time" else name for piece, name in used.items()}
    time = _dates(values)
    for piece, seconds in (("hour", 3600.0), ("minute", 60.0), ("second", 1.0)):
        if piece in values:
            time = time + pd.to_timedelta(np.round(seconds * values[piece], _DIGITS), unit="s")
    names = ", ".join(f"'{name}'" for name in used.values())
    requests = {**found.requests, **dict.fromkeys(used.values(), "ignore")}
    notes = (*found.notes, f"{names} are read together as time")
    return table.assign(time=time), replace(found, notes=notes, requests=requests)


def _beside_a_date(table: pd.DataFrame) -> tuple[str, str] | None:
    """Columns of a written date and of its hours and minutes; a `time` of numbers may be of another kind."""
    days = [n for n in map(str, table) if _plain(n) in _DATES and _are_days(table[n])]
    clocks = [n for n in map(str, table) if _plain(n) in _HHMM - {"time"}]
    if "time" in table.columns or (len(days), len(clocks)) != (1, 1):
        return None
    hours = _in_hours({"hour": floats(table[clocks[0]])}, {"hour": clocks[0]})["hour"]
    return (days[0], clocks[0]) if _is_piece("hour", hours, finest=True) else None


def _are_days(values: pd.Series[Any]) -> bool:
    """Whether these are dates without a time of day, apart from midnight."""
    found = [DAY.fullmatch(str(own).strip()) for own in values.dropna() if str(own).strip()]
    sound = [own is not None and (own["clock"] or "00:00:00") in _MIDNIGHT for own in found]
    return bool(sound) and sum(sound) >= _SOUND * len(sound)


def _plain(name: object) -> str:
    return str(name).strip().lower().replace(" ", "_").removesuffix(_SUFFIX)


def _columns(table: pd.DataFrame) -> dict[str, str]:
    """Column of each piece, where one alone is called so; hours and minutes in one are the hour."""
    plain = {str(name): _plain(name) for name in table.columns}
    listed = {
        piece: [name for name, own in plain.items() if own in words] for piece, (words, _) in _PIECES.items()
    }
    listed["hour"] = listed["hour"] or [name for name, own in plain.items() if own in _HHMM]
    found = {piece: names[0] for piece, names in listed.items() if len(names) == 1}
    if "month" not in found and "day_of_year" not in found and "day" in found:
        found["day_of_year"] = found.pop("day")  # a year and a day alone
    return found


def _in_hours(values: dict[str, Column], used: dict[str, str]) -> dict[str, Column]:
    """The values, with hours in place of hours and minutes as one number; NaN where no clock shows it."""
    if "hour" not in values or "minute" in values:
        return values
    own = values["hour"]
    known = np.isfinite(own)
    named = _plain(used["hour"]) in _HHMM
    clock = (own == np.floor(own)) & (own >= 0) & (own <= _LAST) & (own % 100 < _MINUTES)
    if not known.any() or clock[known].mean() < _SOUND or not (named or own[known].max() > _HOURS):
        return values
    return {**values, "hour": np.where(clock, own // 100 + own % 100 / _MINUTES, np.nan)}


def _clock(columns: dict[str, str]) -> list[str]:
    """Pieces of the clock: a minute without its hour is none."""
    return [p for p in ("hour", "minute", "second") if p in columns and _COARSER.get(p, p) in columns]


def _is_piece(piece: str, values: Column, finest: bool) -> bool:
    """Whether the values may be this piece; only the finest one may have a fraction."""
    low, high = _PIECES[piece][1]
    sound = (values >= low) & (values < high + 1)
    if not finest:
        sound &= values == np.floor(values)
    return bool(len(values)) and float(sound.mean()) >= _SOUND


def _seconds_of(days: Column) -> Column:
    return np.round(86400.0 * days, _DIGITS)


def _dates(values: dict[str, Column]) -> pd.Series[Any]:
    """Midnights, and the fraction of a day; none where a piece is missing or impossible."""
    if "month" in values:
        parts = {"year": values["year"], "month": values["month"], "day": np.floor(values["day"])}
        dates: pd.Series[Any] = pd.to_datetime(pd.DataFrame(parts), errors="coerce")
        return dates + pd.to_timedelta(_seconds_of(values["day"] % 1.0), unit="s")
    first = {
        "year": values["year"],
        "month": np.ones_like(values["year"]),
        "day": np.ones_like(values["year"]),
    }
    days = pd.to_timedelta(_seconds_of(values["day_of_year"] - 1.0), unit="s")
    years: pd.Series[Any] = pd.to_datetime(pd.DataFrame(first), errors="coerce")
    return years + days
