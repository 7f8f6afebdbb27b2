"""Values of one record at the times of another."""

from __future__ import annotations

from typing import Any, Literal

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from echocal.errors import DataError
from echocal.observations.dates import CLOCK, as_iso, unwrapped_clock
from echocal.observations.join import Join

__all__ = ["joined", "seconds_of", "spread"]

Column = NDArray[np.float64]

_REACH = 3.0
"""Usual intervals between two values that a straight line may bridge: two that are lost in a row."""

_COURSE = 3 * 3600.0
"""s. A straight line over 3 h misses the course of a day by 1 - cos(pi 3/24), 8 % of its amplitude."""

_CYCLE = 0.01
"""Of the usual interval: a value so near in time is of the same moment."""

_FEW = 20  # values that show how a record is kept
_EVEN = 2.0  # ratio of long to usual intervals up to which they are even


def joined(at: Column, times: Column, values: Column, *, smooth: bool) -> tuple[Column, Join]:
    """Values of a record at other times; NaN where the record has none that is near enough.

    Quantities of the air are interpolated in time, others take the nearest value. Two values are bridged if
    they are at most three usual intervals apart, and three hours. A record that is written only when its
    value changes holds it in between, however long.

    Parameters
    ----------
    at : ndarray, shape (n,)
        Times that need a value [s].
    times, values : ndarray, shape (m,)
        The record; a NaN says that there was no value.
    smooth : bool
        Whether the quantity goes from one value to the next without a jump.

    Examples
    --------
    >>> import numpy as np
    >>> minutes = np.array([0, 1, 2, 3, 4, 5, 6, 7, 12, 13, 14.0])
    >>> values, join = joined(np.array([30.0, 150.0, 600.0]), 60 * minutes, 20 + minutes, smooth=True)
    >>> values.tolist(), str(join)  # doctest: +NORMALIZE_WHITESPACE
    ([20.5, 22.5, nan],
     'interpolated in time (values 60 s apart, up to 3 min), no value near enough for 1 row')
    """
    known = np.isfinite(times)
    order = np.argsort(times[known], kind="stable")
    marks, heights = times[known][order], values[known][order]
    filled = np.isfinite(heights)
    last = np.append(np.diff(marks[filled]) > 0.0, True) if filled.any() else np.zeros(0, dtype=np.bool_)
    own, held = marks[filled][last], heights[filled][last]
    steps = np.diff(own)
    interval = _usual(steps)
    limit = min(_REACH * interval, _COURSE) if len(steps) else _COURSE
    if not len(own):
        return np.full(len(at), np.nan), Join("nearest", 0.0, 0.0, len(at))
    before = np.clip(np.searchsorted(own, at, side="right") - 1, 0, len(own) - 1)
    after = np.clip(before + (own[before] < at), 0, len(own) - 1)
    outside = (at < own[0]) | (at > own[-1])
    wide = (own[after] - own[before] > limit) & ~_unchanged(own, held, marks[~filled], before, after)
    closest = np.where(at - own[before] <= own[after] - at, before, after)
    near = np.abs(at - own[closest]) <= 0.5 * min(interval or _COURSE, _COURSE)
    taken = np.interp(at, own, held) if smooth else held[closest]
    # a value that was logged in the same cycle stays the number that it is
    taken = np.where(wide | (np.abs(at - own[closest]) <= _CYCLE * interval), held[closest], taken)
    taken = np.where((outside | wide) & ~near | ~np.isfinite(at), np.nan, taken)
    how: Literal["interpolated", "nearest"] = "interpolated" if smooth else "nearest"
    return taken, Join(how, interval, limit, int(np.isnan(taken).sum()))


def _usual(steps: Column) -> float:
    """Interval up to which half of the time of a record lies, so that bursts do not count by their rows."""
    if not len(steps):
        return 0.0
    ordered = np.sort(steps)
    total = np.cumsum(ordered)
    return float(ordered[np.searchsorted(total, 0.5 * total[-1])])


def _unchanged(
    own: Column, held: Column, broken: Column, before: NDArray[np.intp], after: NDArray[np.intp]
) -> NDArray[np.bool_]:
    """Rows in a long interval of a record that is written when its value changes, where it hardly changed.

    Such a record has no value twice in a row, and its intervals are uneven.
    """
    steps, changes = np.diff(own), np.abs(np.diff(held))
    if len(steps) < _FEW or (changes == 0.0).any() or np.quantile(steps, 0.9) < _EVEN * np.median(steps):
        return np.zeros(len(before), dtype=np.bool_)
    between = np.searchsorted(broken, own[after]) > np.searchsorted(broken, own[before])
    return np.asarray((np.abs(held[after] - held[before]) <= np.median(changes)) & ~between)


def seconds_of(values: pd.Series[Any]) -> Column:
    """Seconds of a column of times, since any instant; NaN where there is none."""
    if pd.api.types.is_numeric_dtype(values):
        return values.to_numpy(dtype=np.float64, na_value=np.nan)
    if pd.api.types.is_datetime64_any_dtype(values):
        return _since_1970(values)
    texts = values.fillna("").astype(str).str.strip()
    filled = texts[texts != ""]
    if len(filled) and filled.map(lambda text: CLOCK.fullmatch(text) is not None).mean() > 0.9:
        return unwrapped_clock(texts)
    numbers = pd.to_numeric(texts, errors="coerce")
    if numbers.notna().sum() == len(filled):
        return numbers.to_numpy(dtype=np.float64)
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
