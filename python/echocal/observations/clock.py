"""Times of day to elapsed time."""

from __future__ import annotations

import re
from datetime import timedelta, timezone, tzinfo
from typing import Any
from zoneinfo import ZoneInfo, ZoneInfoNotFoundError

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from echocal.errors import DataError, UsageError
from echocal.keywords import keyword
from echocal.observations.dates import as_iso, by_format
from echocal.observations.fields import fields, row, shown
from echocal.observations.numbers import NO_NUMBER

__all__ = ["YEARS", "Instants", "elapsed", "hour_angle", "instants", "zone_of"]

Instants = NDArray[np.datetime64]

_OFFSET = r"(?P<sign>[+-])(?P<hours>\d{1,2})(?::?(?P<minutes>\d\d))?"
_SAID = re.compile(rf"(?:GMT|UTC)\s*{_OFFSET}(?!\d)", re.IGNORECASE)

_HOUR = 3600.0
_AUTUMN = 30 * 86400.0  # s: two clock changes are further apart

YEARS = (1678, 2261)
"""First and last year that 64 bits of nanoseconds hold as a whole; beyond, they would wrap around."""


def instants(
    values: pd.Series[Any], column: str, time_zone: str, time_format: str | None = None
) -> tuple[Instants, NDArray[np.bool_]]:
    """Instants in UTC of a column of texts or of datetimes, and which lie outside `YEARS`.

    An instant is NaT where the field is empty or outside. Raises `DataError` if a field is no time, or a
    local time is skipped or repeated by a clock change, and `UsageError` if the time zone is unknown.

    Parameters
    ----------
    time_zone : str
        IANA name of the time zone for times without an offset, or an offset: ``+02:00``.
    time_format : str, optional
        How times are written; default: ISO 8601, or seen in the column.
    """
    if (
        time_format is None
        and pd.api.types.is_numeric_dtype(values)
        and not pd.api.types.is_bool_dtype(values)
    ):
        message = (
            f"column '{column}' holds numbers, not ISO 8601 times; rename it to its unit: "
            "time_s, time_ms, time_us, time_min or time_h"
        )
        raise DataError(message)
    zone = _zone(time_zone)
    far = np.zeros(len(values), dtype=np.bool_)
    times = (
        values if pd.api.types.is_datetime64_any_dtype(values) else _parse(values, column, far, time_format)
    )
    year = times.dt.year.to_numpy(dtype=np.float64, na_value=np.nan)
    outside = far | (year < YEARS[0]) | (year > YEARS[1])
    times = times.mask(outside)
    if times.dt.tz is None:
        times = _localize(times, column, zone)
    return np.array(times.dt.tz_convert("UTC").dt.tz_localize(None), dtype="datetime64[ns]"), outside


def zone_of(column: str, time_zone: str) -> str:
    """Offset from UTC that the name of a column of times says, where the user says no other zone.

    Examples
    --------
    >>> zone_of("Date Time, GMT+02:00", "UTC"), zone_of("Zeit (UTC-3)", "UTC"), zone_of("time", "UTC")
    ('+02:00', '-03:00', 'UTC')
    """
    said = _SAID.search(column)
    if time_zone != "UTC" or said is None:
        return time_zone
    return f"{said['sign']}{int(said['hours']):02d}:{said['minutes'] or '00'}"


def elapsed(times: Instants, start: object = None) -> NDArray[np.float64]:
    """Seconds since the earliest time, or since a given instant in UTC; NaN where there is none."""
    if not isinstance(start, np.datetime64):
        known = times[~np.isnat(times)]
        start = known.min() if len(known) else np.datetime64("NaT")
    return np.asarray((times - start) / np.timedelta64(1, "s"), dtype=np.float64)


def hour_angle(times: Instants, time_zone: str) -> NDArray[np.float64]:
    """Hour angle of the local clock at each instant, 0 at noon, within half a turn [rad]; NaN without time.

    Examples
    --------
    >>> import numpy as np
    >>> noon = np.array(["2024-03-20T12:00", "2024-03-20T06:00"], dtype="datetime64[ns]")
    >>> hour_angle(noon, "UTC").round(3).tolist()
    [0.0, -1.571]
    """
    local = pd.Series(times).dt.tz_localize("UTC").dt.tz_convert(_zone(time_zone))
    midnight = local.dt.tz_localize(None).dt.normalize()
    seconds = (local.dt.tz_localize(None) - midnight).dt.total_seconds()
    return np.asarray((seconds / 43200.0 - 1.0) * np.pi, dtype=np.float64)


def _zone(name: str) -> tzinfo:
    if isinstance(name, str) and (offset := re.fullmatch(_OFFSET, name.strip())):
        ahead = timedelta(hours=int(offset["hours"]), minutes=int(offset["minutes"] or 0))
        if ahead <= timedelta(hours=14):
            return timezone(ahead if offset["sign"] == "+" else -ahead)
    try:
        return ZoneInfo(name)
    except (ZoneInfoNotFoundError, TypeError, ValueError, OSError):
        message = (
            f"unknown time zone '{name}'; IANA names are like UTC or Europe/Copenhagen, offsets like +02:00"
        )
        raise UsageError(message) from None


def _parse(
    values: pd.Series[Any], column: str, far: NDArray[np.bool_], time_format: str | None
) -> pd.Series[Any]:
    """Times of texts; marks in `far` those that the resolution of the others cannot hold."""
    texts = fields(values, column)
    texts = texts.where(~texts.isin(NO_NUMBER), "")
    if time_format is not None:
        return by_format(texts, column, time_format)
    texts = as_iso(texts, column)
    filled = texts != ""
    offset = texts.str.contains(r"(?:Z|:\d\d(?:\.\d+)?[+-]\d\d(?::?\d\d)?)$", regex=True)
    aware = bool(offset.any())
    if aware and not offset[filled].all():
        first = int(np.flatnonzero(filled & ~offset)[0])
        message = f"column '{column}' has times with and without an offset, first without at {row(first)}"
        raise DataError(message)
    times = _of_texts(texts.where(filled), aware)
    wrong = times.isna() & filled
    if wrong.any():
        far |= _of_texts(texts.where(wrong), aware).notna().to_numpy()
        _refuse_others(texts, np.flatnonzero(wrong & ~far), column)
    return times


def _of_texts(texts: pd.Series[Any], aware: bool) -> pd.Series[Any]:
    # pandas takes "now" for a time, too
    dated = [isinstance(text, str) and text[0].isdigit() and text.isascii() for text in texts]
    given = texts if all(dated) else texts.where(np.array(dated))
    times: pd.Series[Any] = pd.to_datetime(given, format="ISO8601", utc=aware, errors="coerce")
    return times


def _refuse_others(texts: pd.Series[Any], wrong: NDArray[np.intp], column: str) -> None:
    if 10 * len(wrong) > len(texts):
        message = (
            f"column '{column}' has {len(wrong)} of {len(texts)} rows that are not ISO 8601 "
            f"(2024-05-31T13:45:00), first at {row(wrong[0])}: '{shown(texts.iloc[wrong[0]])}'; "
            f"written otherwise: {keyword('time_format', '%d.%m.%Y %H:%M:%S')}"
        )
        raise DataError(message)


def _localize(times: pd.Series[Any], column: str, zone: tzinfo) -> pd.Series[Any]:
    local: pd.Series[Any] = times.dt.tz_localize(zone, ambiguous="NaT", nonexistent="NaT")
    wrong = np.flatnonzero(local.isna() & times.notna())
    if len(wrong):
        summer = _summer(times, wrong)
        if summer is not None:
            local = times.dt.tz_localize(zone, ambiguous=summer, nonexistent="NaT")
            wrong = np.flatnonzero(local.isna() & times.notna())
    if len(wrong):
        message = (
            f"column '{column}' has {len(wrong)} local times that a clock change skips or repeats, "
            f"first at {row(wrong[0])}: {times.iloc[wrong[0]]}; a logger that keeps one offset all year "
            f"needs it as its zone: {keyword('time_zone', 'Etc/GMT-1')} is UTC+1"
        )
        raise DataError(message)
    return local


def _summer(times: pd.Series[Any], twice: NDArray[np.intp]) -> NDArray[np.bool_] | None:
    """Which of the local times that occur twice are in summer time, by the order of the rows.

    The hour comes a second time after a row. That row is the one after which the steps between rows are the
    most even: an hour more there, and none is negative. None where no row stands out.
    """
    summer = np.zeros(len(times), dtype=np.bool_)
    known = np.flatnonzero(times.notna())
    seconds = times.iloc[known].to_numpy(dtype="datetime64[ns]").astype(np.int64) / 1e9
    steps = np.diff(seconds)
    if not len(steps):
        return None
    usual = float(np.median(steps))
    places = np.searchsorted(known, twice)
    for own in np.split(places, np.flatnonzero(np.diff(seconds[places]) > _AUTUMN) + 1):
        before = np.arange(max(own[0] - 1, 0), min(own[-1] + 1, len(steps)))
        gain = np.abs(steps[before] + _HOUR - usual) - np.abs(steps[before] - usual)
        best = int(np.argmin(gain))
        if gain[best] >= 0.0:
            return None
        summer[known[own[own <= before[best]]]] = True
    return summer
