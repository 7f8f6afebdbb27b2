"""Times of day to elapsed time."""

from __future__ import annotations

from datetime import tzinfo
from typing import Any
from zoneinfo import ZoneInfo, ZoneInfoNotFoundError

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from echocal.errors import DataError, UsageError
from echocal.observations.numbers import row

__all__ = ["Instants", "elapsed", "hour_angle", "instants"]

Instants = NDArray[np.datetime64]


def instants(values: pd.Series[Any], column: str, time_zone: str) -> Instants:
    """Instants in UTC of a column of ISO 8601 texts or of datetimes; NaT where empty.

    Parameters
    ----------
    time_zone : str
        IANA name of the zone of times that carry no offset.

    Raises
    ------
    DataError
        If a field is no ISO 8601 time, or a local time is skipped or repeated by a clock change.
    UsageError
        If the time zone is unknown.
    """
    if pd.api.types.is_numeric_dtype(values) and not pd.api.types.is_bool_dtype(values):
        message = (
            f"column '{column}' holds numbers, not ISO 8601 times; rename it to its unit: "
            "time_s, time_ms, time_us, time_min or time_h"
        )
        raise DataError(message)
    zone = _zone(time_zone)
    times = values if pd.api.types.is_datetime64_any_dtype(values) else _parse(values, column)
    if times.dt.tz is None:
        times = _localize(times, column, zone)
    return np.array(times.dt.tz_convert("UTC").dt.tz_localize(None), dtype="datetime64[ns]")


def elapsed(times: Instants) -> NDArray[np.float64]:
    """Seconds since the earliest time; NaN where there is none."""
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
    try:
        return ZoneInfo(name)
    except (ZoneInfoNotFoundError, ValueError, OSError):
        message = f"unknown time zone '{name}'; IANA names are like UTC or Europe/Copenhagen"
        raise UsageError(message) from None


def _parse(values: pd.Series[Any], column: str) -> pd.Series[Any]:
    fields = values.astype(object).where(values.notna(), "").map(lambda field: str(field).strip())
    filled = fields != ""
    offset = fields.str.contains(r"(?:Z|:\d\d(?:\.\d+)?[+-]\d\d(?::?\d\d)?)$", regex=True)
    aware = bool(offset.any())
    if aware and not offset[filled].all():
        first = int(np.flatnonzero(filled & ~offset)[0])
        message = f"column '{column}' has times with and without an offset, first without at {row(first)}"
        raise DataError(message)
    times = pd.to_datetime(fields.where(filled), format="ISO8601", utc=aware, errors="coerce")
    wrong = np.flatnonzero(times.isna() & filled)
    if len(wrong):
        message = (
            f"column '{column}' has {len(wrong)} of {len(fields)} rows that are not ISO 8601 "
            f"(2024-05-31T13:45:00), first at {row(wrong[0])}: '{fields.iloc[wrong[0]]}'"
        )
        raise DataError(message)
    return times


def _localize(times: pd.Series[Any], column: str, zone: tzinfo) -> pd.Series[Any]:
    local: pd.Series[Any] = times.dt.tz_localize(zone, ambiguous="NaT", nonexistent="NaT")
    wrong = np.flatnonzero(local.isna() & times.notna())
    if len(wrong):
        message = (
            f"column '{column}' has {len(wrong)} local times that a clock change skips or repeats, "
            f"first at {row(wrong[0])}: {times.iloc[wrong[0]]}; a logger that keeps one offset all year "
            "needs it as its zone: --time-zone Etc/GMT-1 is UTC+1"
        )
        raise DataError(message)
    return local
