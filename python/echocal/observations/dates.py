"""Times as loggers and people write them, to ISO 8601."""

from __future__ import annotations

import re
from typing import Any

import numpy as np
import pandas as pd

from echocal.arrays import Column
from echocal.errors import DataError, UsageError
from echocal.keywords import keyword
from echocal.observations.fields import row, shown

DAY = re.compile(
    r"(?:(?P<y1>\d{4})[-/.](?P<m1>\d{1,2})[-/.](?P<d1>\d{1,2})"
    r"|(?P<a>\d{1,2})(?P<cut>[-/.])(?P<b>\d{1,2})(?P=cut)(?P<y2>\d{4}|\d{2}))"
    r"(?:[ T,]+(?P<clock>.+))?"
)
CLOCK = re.compile(
    r"(?P<h>\d{1,2}):(?P<m>\d{2})(?::(?P<s>\d{2})(?:[.,](?P<f>\d{1,9}))?)?\s*(?P<half>[AaPp]\.?[Mm]\.?)?"
    r"\s*(?P<zone>Z|UTC|GMT|[+-]\d{2}:?\d{2})?"
)
MONTH = re.compile(r"(?i)\b(jan|feb|mar|apr|may|jun|jul|aug|sep|oct|nov|dec)[a-z]*\b")
_TWELVE = 12
_CENTURY = 2000


def by_format(texts: pd.Series[Any], column: str, time_format: str) -> pd.Series[Any]:
    """Times by a format of `datetime.strptime`.

    Raises `DataError` if a field is not written so, and `UsageError` if the format is none.
    """
    filled = texts != ""
    try:
        times: pd.Series[Any] = pd.to_datetime(texts.where(filled), format=time_format, errors="coerce")
    except (ValueError, TypeError) as error:
        raise UsageError(
            f'{keyword("time_format", time_format)}: no format of times: {error}; like "%d.%m.%Y %H:%M:%S"'
        ) from None
    wrong = np.flatnonzero(times.isna() & filled)
    if 2 * len(wrong) > filled.sum():
        raise DataError(
            f"column '{column}' has {len(wrong)} of {len(texts)} rows that are not written as "
            f"\"{time_format}\", first at {row(wrong[0])}: '{shown(texts.iloc[wrong[0]])}'"
        )
    return times


def as_iso(texts: pd.Series[Any], column: str) -> pd.Series[Any]:
    """Texts in ISO 8601 where all are dates in one other way of writing; else as they are.

    Raises `DataError` if day and month cannot be told apart.

    Examples
    --------
    >>> import pandas as pd
    >>> as_iso(pd.Series(["31.05.2024 13:45", "01.06.2024 01:45"]), "time").tolist()
    ['2024-05-31T13:45:00', '2024-06-01T01:45:00']
    """
    filled = texts[texts != ""].astype(str)
    if filled.empty:
        return texts
    matches = [DAY.fullmatch(text) for text in filled]
    sound = [match is not None for match in matches]
    if 10 * sum(sound) < 9 * len(sound):
        return _by_month_name(texts, filled)
    known = [match for match in matches if match]
    short = [match for match in known if match["a"]]
    if short and len(short) < len(known):
        return texts  # two ways of writing
    plain = all(match["y1"] and "-" in match[0][:5] for match in known) and not _other_clocks(known)
    if plain:
        return texts
    day_first = _day_first(short, column) if short else True
    iso = [
        _iso(match, day_first=day_first) if match else text
        for match, text in zip(matches, filled, strict=True)
    ]
    return pd.Series(iso, index=filled.index, dtype=object).reindex(texts.index, fill_value="")


def unwrapped_clock(texts: pd.Series[Any]) -> Column:
    """Seconds from the first midnight of times of day; a clock that falls back by hours has passed midnight.

    Examples
    --------
    >>> import pandas as pd
    >>> unwrapped_clock(pd.Series(["23:59:59.5", "00:00:01"])).tolist()
    [86399.5, 86401.0]
    """
    seconds = np.array([_seconds(CLOCK.fullmatch(str(text).strip())) for text in texts], dtype=np.float64)
    known = np.flatnonzero(np.isfinite(seconds))
    days = np.cumsum(np.diff(seconds[known], prepend=seconds[known][:1]) < -43200.0)
    seconds[known] += 86400.0 * days
    return seconds


def _seconds(match: re.Match[str] | None) -> float:
    if match is None:
        return np.nan
    hour = int(match["h"])
    if match["half"]:
        hour = hour % _TWELVE + (_TWELVE if match["half"][0] in "pP" else 0)
    return hour * 3600.0 + int(match["m"]) * 60.0 + int(match["s"] or 0) + float(f"0.{match['f'] or 0}")


def _other_clocks(matches: list[re.Match[str]]) -> bool:
    clocks = (match["clock"] for match in matches[:200] if match["clock"])
    return any(re.search(r"[AaPp]\.?[Mm]\.?$|UTC$|GMT$| [+-]\d|^\d:", clock) for clock in clocks)


def _day_first(matches: list[re.Match[str]], column: str) -> bool:
    if all(match["cut"] == "." for match in matches):
        return True
    first, second = ({int(match[name]) for match in matches} for name in "ab")
    if max(first) > _TWELVE or max(second) > _TWELVE:
        return max(first) > _TWELVE
    if any(match["clock"] and re.search(r"[AP]M$", match["clock"]) for match in matches):
        return False  # where clocks have twelve hours
    if len(first) != len(second):  # days pass faster than months
        return len(first) > len(second)
    message = (
        f"column '{column}' has dates whose day and month cannot be told apart ('{shown(matches[0][0])}'): "
        f"say which comes first, {keyword('time_format', '%d/%m/%Y %H:%M:%S')} or "
        f"{keyword('time_format', '%m/%d/%Y %H:%M:%S')}"
    )
    raise DataError(message.replace("/", matches[0]["cut"]) if matches[0]["cut"] != "/" else message)


def _iso(match: re.Match[str], *, day_first: bool) -> str:
    if match["y1"]:
        year, month, day = int(match["y1"]), int(match["m1"]), int(match["d1"])
    else:
        year, first, second = int(match["y2"]), int(match["a"]), int(match["b"])
        day, month = (first, second) if day_first else (second, first)
        year += 0 if len(match["y2"]) > 2 else _CENTURY
    date = f"{year:04d}-{month:02d}-{day:02d}"
    if match["clock"] is None:
        return date
    clock = CLOCK.fullmatch(match["clock"].strip())
    if clock is None:
        return match[0]
    seconds = _seconds(clock)
    whole = int(seconds)
    fraction = f".{clock['f']}" if clock["f"] else ""
    zone = clock["zone"] or ""
    zone = "+00:00" if zone in {"Z", "UTC", "GMT"} else zone
    return f"{date}T{whole // 3600:02d}:{whole // 60 % 60:02d}:{whole % 60:02d}{fraction}{zone}"


def _by_month_name(texts: pd.Series[Any], filled: pd.Series[Any]) -> pd.Series[Any]:
    """Dates with the name of a month."""
    if not all(MONTH.search(text) and re.search(r"\d", text) for text in filled.iloc[:50]):
        return texts
    times = pd.to_datetime(filled, format="mixed", dayfirst=True, errors="coerce")
    if times.isna().any():
        return texts
    iso = times.map(lambda time: time.isoformat())
    return iso.astype(object).reindex(texts.index, fill_value="")
