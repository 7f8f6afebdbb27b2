"""Rows of a period of time."""

import re
from dataclasses import replace
from datetime import UTC, datetime

import numpy as np
from numpy.typing import NDArray

from echocal.errors import UsageError
from echocal.observations import Observations

__all__ = ["between", "instant", "times"]

Mask = NDArray[np.bool_]

OUTSIDE = "outside the requested period"
_DATE = len("2022-07-20")


def between(observations: Observations, since: str | None, until: str | None) -> Observations:
    """Mark rows outside a period as unusable.

    Parameters
    ----------
    observations : Observations
    since, until : str or None
        ISO 8601, both inclusive; a date means its whole day.
    """
    if since is None and until is None:
        return observations
    if since is not None and until is not None and instant(since) > instant(until, last=True):
        message = f"there are no rows since {since} and until {until}: the first time is the later one"
        raise UsageError(message)
    outside = np.zeros(len(observations), dtype=bool)
    if since is not None:
        outside |= ~(times(observations, since) >= instant(since))
    if until is not None:
        outside |= ~(times(observations, until) <= instant(until, last=True))
    if len(observations) and outside.all():
        time = times(observations, since or until or "")
        ends = (np.datetime_as_string(end(time), unit="s") for end in (np.nanmin, np.nanmax))
        there = "none" if np.isnat(time).all() else " to ".join(map(str, ends))
        message = f"no row is in the requested period ({since or ''} .. {until or ''}); the rows: {there}"
        raise UsageError(message)
    reasons = observations.unusable.astype(object)
    reasons[outside & (observations.unusable == "")] = OUTSIDE
    return replace(observations, unusable=reasons.astype(str))


def times(observations: Observations, wanted: str) -> NDArray[np.datetime64]:
    """Time of every row; refuses a table without times."""
    if observations.time is None:
        message = f"'{wanted}' is a time, and the table has no column of times (map one to time)"
        raise UsageError(message)
    return observations.time


def instant(text: str, *, last: bool = False) -> np.datetime64:
    """Read an ISO 8601 time; with `last`, a date means its last instant."""
    try:
        instant = np.datetime64(_in_utc(text), "ns")
        if np.isnat(instant):
            raise ValueError
    except ValueError:
        message = f"'{text}' is not an ISO 8601 time such as 2022-07-20 or 2022-07-20T12:00"
        raise UsageError(message) from None
    whole_day = last and len(text) == _DATE
    return instant + np.timedelta64(1, "D") - np.timedelta64(1, "ns") if whole_day else instant


def _in_utc(text: str) -> str:
    """Text of the same instant in UTC without an offset, as NumPy requires."""
    if not re.match(r"\d{4}", text):
        raise ValueError  # NumPy accepts "now" and "today"
    if len(text) <= _DATE:
        return text
    instant = datetime.fromisoformat(text)
    return (
        instant.isoformat() if instant.tzinfo is None else f"{instant.astimezone(UTC):%Y-%m-%dT%H:%M:%S.%f}"
    )
