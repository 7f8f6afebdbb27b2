"""A date in pieces: columns of the year, the month, the day, the hour, the minute and the second."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from echocal.observations.found import Found

__all__ = ["step"]

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
    columns = _columns(table)
    days = {"month", "day"} if {"month", "day"} <= {*columns} else {"day_of_year"}
    if "time" in table.columns or not {"year", *days} <= {*columns}:
        return table, found
    used = {piece: name for piece, name in columns.items() if piece in {"year", *days, *_clock(columns)}}
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


def _clock(columns: dict[str, str]) -> list[str]:
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
