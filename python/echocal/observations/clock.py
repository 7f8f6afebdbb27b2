"""Times of day to elapsed time, and clocks that were not set, set anew, stood still, or count otherwise."""

from __future__ import annotations

import re
from datetime import timedelta, timezone, tzinfo
from typing import Any
from zoneinfo import ZoneInfo, ZoneInfoNotFoundError

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from echocal.arrays import Column, Mask
from echocal.errors import DataError, UsageError
from echocal.keywords import keyword
from echocal.observations.dates import as_iso, by_format
from echocal.observations.fields import fields, row, rows, shown, span
from echocal.observations.numbers import NO_NUMBER
from echocal.observations.plan import Assignment

Instants = NDArray[np.datetime64]

_OFFSET = r"(?P<sign>[+-])(?P<hours>\d{1,2})(?::?(?P<minutes>\d\d))?"
_SAID = re.compile(rf"(?:GMT|UTC)\s*{_OFFSET}(?!\d)", re.IGNORECASE)

_HOUR = 3600.0
_AUTUMN = 30 * 86400.0  # s: two clock changes are further apart

YEARS = (1678, 2261)
"""First and last year that 64 bits of nanoseconds hold as a whole; beyond, they would wrap around."""
_FIRST = np.datetime64("1990-01-01", "ns")  # clocks that were not set begin in 1970 or 1980
_SURE = np.datetime64("2000-01-01", "ns")

_LONGEST = 5e9  # s: since 1970 it is the year 2128
_SHORTEST = 1e-3  # s: sound comes back from 17 cm in this time, and a ranger waits for its echo
_FEWEST = 5  # steps
_OFTEN = 3600.0  # s: people who log less often choose whole half hours, hours or days
_NEAR = 0.04  # of these: the clock of a sleeping device is off by some percent
_ROUND = ((6 * 3600.0, 1800.0), (0.97 * 86400.0, 3600.0), (np.inf, 86400.0))
"""Steps below which a person chooses multiples of which time [s]."""

_EVEN = 0.25  # of a step: half of the steps lie within it

_USUAL = (2e-3, 7 * 86400.0)  # s: steps in another unit that are offered


def instants(
    values: pd.Series[Any], column: str, time_zone: str, time_format: str | None = None
) -> tuple[Instants, Mask]:
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
        raise DataError(
            f"column '{column}' holds numbers, not ISO 8601 times; rename it to its unit: "
            "time_s, time_ms, time_us, time_min or time_h; hours and minutes as 1345, beside a date: HHMM"
        )
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


def elapsed(times: Instants, start: object = None) -> Column:
    """Seconds since the earliest time, or since a given instant in UTC; NaN where there is none."""
    if not isinstance(start, np.datetime64):
        known = times[~np.isnat(times)]
        start = known.min() if len(known) else np.datetime64("NaT")
    return np.asarray((times - start) / np.timedelta64(1, "s"), dtype=np.float64)


def hour_angle(times: Instants, time_zone: str) -> Column:
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
        raise UsageError(
            f"unknown time zone '{name}'; IANA names are like UTC or Europe/Copenhagen, offsets like +02:00"
        ) from None


def _parse(values: pd.Series[Any], column: str, far: Mask, time_format: str | None) -> pd.Series[Any]:
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
        raise DataError(
            f"column '{column}' has times with and without an offset, first without at {row(first)}"
        )
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
        raise DataError(
            f"column '{column}' has {len(wrong)} of {len(texts)} rows that are not ISO 8601 "
            f"(2024-05-31T13:45:00), first at {row(wrong[0])}: '{shown(texts.iloc[wrong[0]])}'; "
            f"written otherwise: {keyword('time_format', '%d.%m.%Y %H:%M:%S')}"
        )


def _localize(times: pd.Series[Any], column: str, zone: tzinfo) -> pd.Series[Any]:
    local: pd.Series[Any] = times.dt.tz_localize(zone, ambiguous="NaT", nonexistent="NaT")
    wrong = np.flatnonzero(local.isna() & times.notna())
    if len(wrong):
        summer = _summer(times, wrong)
        if summer is not None:
            local = times.dt.tz_localize(zone, ambiguous=summer, nonexistent="NaT")
            wrong = np.flatnonzero(local.isna() & times.notna())
    if len(wrong):
        raise DataError(
            f"column '{column}' has {len(wrong)} local times that a clock change skips or repeats, "
            f"first at {row(wrong[0])}: {times.iloc[wrong[0]]}; a logger that keeps one offset all year "
            f"needs it as its zone: {keyword('time_zone', 'Etc/GMT-1')} is UTC+1"
        )
    return local


def _summer(times: pd.Series[Any], twice: NDArray[np.intp]) -> Mask | None:
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


def not_set(times: Instants) -> Mask:
    """Rows before 1990 in a table most of whose rows are from 2000 or later: the clock was not set yet.

    Examples
    --------
    >>> import numpy as np
    >>> not_set(np.array(["1970-01-01", "2024-05-01", "2024-05-02"], dtype="datetime64[ns]")).tolist()
    [True, False, False]
    """
    early = times < _FIRST
    if early.any() and 2 * int((times >= _SURE).sum()) > int((~np.isnat(times)).sum()):
        return np.asarray(early)
    return np.zeros(len(times), dtype=np.bool_)


def said_of_order(elapsed: Column, source: Assignment, *, bursts: bool) -> list[str]:
    """Sentences on times that go back, in most rows or in some, and on rows at the time of the row before.

    The times are in seconds. Rows that belong to bursts share a time.
    """
    known = np.flatnonzero(np.isfinite(elapsed))
    steps = np.diff(elapsed[known])
    falling, still = np.flatnonzero(steps < 0.0), np.flatnonzero(steps == 0.0)
    said = []
    if len(falling) > int((steps > 0.0).sum()):
        said.append(
            f"{source.column} falls in {len(falling)} of {rows(len(steps))}, as where the newest row comes "
            "first; rows stay in their order, and what depends on it (rows that follow each other) is better "
            "told of a table sorted by time"
        )
    elif len(falling):
        first = falling[0]
        said.append(
            f"{source.column} goes back in {rows(len(falling))}, first at {row(known[first + 1])}, by "
            f"{-steps[first]:g} s: a clock that was set, or parts of a log in another order. The rows stay "
            "in their order"
        )
    if len(still) and not bursts:
        said.append(
            f"{source.column} is that of the row before in {rows(len(still))}, first at "
            f"{row(known[still[0] + 1])}: a clock that stood still, or counts too coarsely"
        )
    return said


def refuse_other_clock(seconds: Column, source: Assignment) -> None:
    """Refuse a count of time whose steps make sense only in another unit.

    A program that counts milliseconds or microseconds makes whole numbers with nearly even steps. Taken for
    seconds, they are hours that are no multiples of half an hour, an hour or a day. The times are those in
    the unit that the column's name says. Raises `DataError` if they are such.
    """
    known = seconds[np.isfinite(seconds)]
    steps = np.abs(np.diff(known))
    steps = steps[steps > 0.0]
    own = source.unit.numerator / source.unit.denominator
    if len(steps) < _FEWEST or (_is_usual(steps, own) and np.abs(known).max() < _LONGEST):
        return
    step = float(np.median(steps))
    units = {
        f"{source.form.role}_{n}": u.numerator / u.denominator for n, u in source.form.units.items() if n
    }
    others = {
        name: step * unit / own
        for name, unit in units.items()
        if (unit < own) == (step >= _SHORTEST) and unit != own
        if _USUAL[0] <= step * unit / own <= _USUAL[1] and np.abs(known).max() * unit / own < _LONGEST
    }
    told = "; ".join(
        f"as {name} a row each {span(time)}" for name, time in {source.name: step, **others}.items()
    )
    ways = [keyword("columns", {source.column: name}) for name in others]
    raise DataError(
        f"column '{source.column}' has usual steps of {step / own:.6g}: {told}. Say which it is: "
        f"{', '.join([*ways, 'or if it is right as it stands'])}: {keyword('trust', [source.column])}"
    )


def _is_usual(steps: Column, unit: float) -> bool:
    """Whether steps [s] of a count in a unit [s] may be those of a logger."""
    middle = float(np.median(steps))
    if middle < _OFTEN:
        return middle >= _SHORTEST
    counts = steps / unit
    low, high = np.quantile(counts, [0.25, 0.75])
    even = high - low <= _EVEN * middle / unit and np.allclose(counts, np.round(counts), rtol=0.0, atol=1e-6)
    choice = next(multiple for below, multiple in _ROUND if middle < below)
    near = np.abs(steps / choice - np.round(steps / choice)) <= _NEAR
    # equal steps without any jitter may be computed; then only a round count, or a huge one, is of a program
    computed = np.ptp(counts) <= 1e-6 and middle < _USUAL[1] and float(f"{counts[0]:.2g}") != round(counts[0])
    return bool(not even or near.mean() >= 0.5 or computed)
