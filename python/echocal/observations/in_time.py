"""Values of one record at the times of another."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Literal

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from echocal.arrays import Column, Mask
from echocal.errors import DataError
from echocal.observations.dates import CLOCK, as_iso, unwrapped_clock
from echocal.observations.found import Join
from echocal.observations.hints import hint
from echocal.observations.units import NAMES

_REACH = 3.0
"""Usual intervals between two values that a straight line may bridge: two that are lost in a row."""

_COURSE = 6 * 3600.0
"""s. Over the 6 h of weather stations a straight line misses 1 - cos(pi 6/24) of a daily course, 29 %."""

_STILL = 1100.0
"""s. A value that is held so long misses sin(2 pi 1100 s/24 h) of the course of a day, 8 %."""

_CYCLE = 0.01
"""Of the usual interval: a value so near in time is of the same moment."""

_EPOCH = {1.0: (4e8, 5e9), 1e3: (4e11, 5e12), 1e6: (4e14, 5e15), 1e9: (4e17, 5e18)}
"""Seconds, ms, us and ns since 1970, from 1982 to 2128."""

_LATEST = 5e9  # s since 1970: the year 2128

_FEW = 20  # values that show how a record is kept
_EVEN = 2.0  # ratio of long to usual intervals up to which they are even


@dataclass(frozen=True)
class Clock:
    """Times of the rows of a log."""

    times: Column  # since any instant; NaN where there is none; shape (n,)
    in_seconds: bool = True  # whether they are seconds. Else they count in a unit that the log does not tell.


def joined(clock: Clock, at: Any, where: Any, values: Column, *, smooth: bool) -> tuple[Column, Join]:
    """Values of a record at other times; NaN where the record has none that is near enough.

    Quantities of the air are interpolated in time, others take the nearest value. Two values are bridged if
    they are at most three usual intervals apart, and six hours. A record that is written only when its
    value changes holds it in between, however long.

    Parameters
    ----------
    at : ndarray of int or bool
        Its rows that need a value.
    where : ndarray of int or bool
        Its rows that have one.
    values : ndarray, shape (m,)
        The values; a NaN says that there was none.
    smooth : bool
        Whether the quantity goes from one value to the next without a jump.

    Examples
    --------
    >>> import numpy as np
    >>> minutes = np.array([0, 1, 2, 3, 4, 5, 6, 7, 12, 13, 14.0])
    >>> clock = Clock(np.append([30.0, 150.0, 600.0], 60 * minutes))
    >>> values, join = joined(clock, np.arange(3), np.arange(3, 14), 20 + minutes, smooth=True)
    >>> values.tolist(), str(join)  # doctest: +NORMALIZE_WHITESPACE
    ([20.5, 22.5, nan],
     'interpolated in time (values 60 s apart, up to 3 min), no value near enough for 1 row')
    """
    rows, times = clock.times[at], clock.times[where]
    course, still = (_COURSE, _STILL) if clock.in_seconds else (np.inf, np.inf)
    known = np.isfinite(times)
    order = np.argsort(times[known], kind="stable")
    marks, heights = times[known][order], values[known][order]
    filled = np.isfinite(heights)
    last = np.append(np.diff(marks[filled]) > 0.0, True) if filled.any() else np.zeros(0, dtype=np.bool_)
    own, held = marks[filled][last], heights[filled][last]
    if not len(own):
        return np.full(len(rows), np.nan), Join("nearest", 0.0, 0.0, len(rows))
    interval = _usual(np.diff(own))
    limit = min(_REACH * interval, course) if len(own) > 1 else course
    before = np.clip(np.searchsorted(own, rows, side="right") - 1, 0, len(own) - 1)
    after = np.clip(before + (own[before] < rows), 0, len(own) - 1)
    outside = (rows < own[0]) | (rows > own[-1])
    wide = (own[after] - own[before] > limit) & ~_unchanged(own, held, marks[~filled], before, after)
    closest = np.where(rows - own[before] <= own[after] - rows, before, after)
    apart = np.abs(rows - own[closest])
    reach = 0.5 * (min(interval, course) if interval else course)
    near = apart <= (min(reach, still) if smooth else reach)
    # a value that was logged in the same cycle stays the number that it is
    between = smooth & ~wide & ~outside & (apart > _CYCLE * interval)
    taken = np.where(between, np.interp(rows, own, held), held[closest])
    taken = np.where((outside | wide) & ~near | ~np.isfinite(rows), np.nan, taken)
    how: Literal["interpolated", "nearest"] = "interpolated" if between.any() else "nearest"
    spans = (interval, limit) if clock.in_seconds else (0.0, 0.0)
    return taken, Join(how, *spans, int(np.isnan(taken).sum()))


def _usual(steps: Column) -> float:
    """Interval up to which half of the time of a record lies, so that bursts do not count by their rows."""
    if not len(steps):
        return 0.0
    ordered = np.sort(steps)
    total = np.cumsum(ordered)
    return float(ordered[np.searchsorted(total, 0.5 * total[-1])])


def _unchanged(
    own: Column, held: Column, broken: Column, before: NDArray[np.intp], after: NDArray[np.intp]
) -> Mask:
    """Rows in a long interval of a record that is written when its value changes, where it hardly changed.

    Such a record has no value twice in a row. Its intervals are uneven, or it mostly changes by one step.
    """
    steps, changes = np.diff(own), np.abs(np.diff(held))
    if len(steps) < _FEW or (changes == 0.0).any():
        return np.zeros(len(before), dtype=np.bool_)
    uneven = np.quantile(steps, 0.9) >= _EVEN * np.median(steps)
    if not uneven and np.median(changes) > (1.0 + 1e-6) * changes.min():
        return np.zeros(len(before), dtype=np.bool_)
    between = np.searchsorted(broken, own[after]) > np.searchsorted(broken, own[before])
    return np.asarray((np.abs(held[after] - held[before]) <= np.median(changes)) & ~between)


def clock_of(values: pd.Series[Any]) -> Clock:
    """Times of a column, which may be texts, or numbers whose unit its name tells, or that count since 1970.

    Examples
    --------
    >>> import pandas as pd
    >>> clock_of(pd.Series([1000, 2000], name="time_ms"))
    Clock(times=array([1., 2.]), in_seconds=True)
    >>> clock_of(pd.Series([1000, 2000], name="timestamp"))
    Clock(times=array([1000., 2000.]), in_seconds=False)
    """
    numbers = pd.to_numeric(values, errors="coerce") if values.dtype == object else values
    if pd.api.types.is_numeric_dtype(numbers) and not numbers.isna().all():
        counts = numbers.to_numpy(dtype=np.float64, na_value=np.nan)
        if numbers.notna().sum() >= (values.notna() & (values != "")).sum():
            second = _counts_of_name(str(values.name), counts) or counts_per_second(counts)
            return Clock(counts / (second or 1.0), bool(second))
    return Clock(_instants(values))


def _counts_of_name(name: str, counts: Column) -> float | None:
    """How many make a second by the name of their column; None where it does not tell, or cannot be."""
    said = hint(name)
    form, unit = NAMES.get(name) or NAMES.get("" if said is None else said.name) or (None, "")
    if form is None or form.quantity != "elapsed_time" or not unit:
        return None
    second = form.units[unit].denominator / form.units[unit].numerator
    return second if float(np.nanmax(np.abs(counts))) / second < _LATEST else None


def counts_per_second(counts: Column) -> float | None:
    """How many make a second since 1970; None for other numbers."""
    known = counts[np.isfinite(counts)]
    middle = float(np.median(known)) if len(known) else 0.0
    return next((scale for scale, (low, high) in _EPOCH.items() if low < middle < high), None)


def _instants(values: pd.Series[Any]) -> Column:
    """Seconds since any instant, of texts and of dates; NaN where there is none."""
    if pd.api.types.is_datetime64_any_dtype(values):
        return _since_1970(values)
    texts = values.fillna("").astype(str).str.strip()
    filled = texts[texts != ""]
    if len(filled) and filled.map(lambda text: CLOCK.fullmatch(text) is not None).mean() > 0.9:
        return unwrapped_clock(texts)
    try:
        texts = as_iso(texts, str(values.name))
    except DataError:  # day and month cannot be told apart: the order that makes the shorter record
        both = [
            pd.to_datetime(texts, dayfirst=first, format="mixed", errors="coerce") for first in (True, False)
        ]
        return _since_1970(min(both, key=lambda times: times.max() - times.min()))
    return _since_1970(pd.to_datetime(texts, format="mixed", utc=True, errors="coerce"))


def spread(seconds: Column) -> Column:
    """Times of rows in their order: those with the same time evenly within the last digit of the clock.

    Examples
    --------
    >>> import numpy as np
    >>> spread(np.array([0.0, 0.0, 5.0, 5.0])).tolist()
    [0.0, 0.5, 5.0, 5.5]
    """
    known = np.flatnonzero(np.isfinite(seconds))
    some = seconds[known]
    starts = (
        np.flatnonzero(np.append(True, np.diff(some) != 0.0)) if len(some) else np.zeros(0, dtype=np.intp)
    )
    if len(starts) == len(some):
        return seconds
    written = (digits for digits in range(7) if np.allclose(some, some.round(digits), rtol=0.0, atol=1e-7))
    counts = np.diff(np.append(starts, len(some)))
    place = np.arange(len(some)) - np.repeat(starts, counts)
    found = seconds.copy()
    found[known] = some + place / np.repeat(counts, counts) * 10.0 ** -next(written, 6)
    return found


def _since_1970(times: pd.Series[Any]) -> Column:
    utc = pd.to_datetime(times, utc=True)
    seconds = (utc - pd.Timestamp(0, tz="UTC")) / pd.Timedelta(seconds=1)
    return np.asarray(seconds.to_numpy(dtype=np.float64, na_value=np.nan), dtype=np.float64)
