"""The clock of a sensor: how times are read, which are believed, and how the time of the test goes on."""

import re
from collections.abc import Sequence
from dataclasses import dataclass, field
from datetime import UTC, datetime
from typing import Any
from zoneinfo import ZoneInfo

import numpy as np
import pandas as pd

from echocal.arrays import Column
from echocal.errors import DataError
from echocal.keywords import keyword
from echocal.observations.clock import YEARS, instants
from echocal.observations.dates import DAY, as_iso
from echocal.observations.fields import shown
from echocal.observations.options import ReadOptions
from echocal.watch.settings import WatchSettings

_STEPS = 32  # waits between rows that say what is usual
_KEPT = 100  # times that a clock was set which are remembered
_CALENDAR = 1e8  # s: a clock below counts from its own start, or was not set

_DIGITS = re.compile(r"\d+")
_LETTERS = re.compile(r"[^\W\d_]+")
_NUMBER = re.compile(r"[-+]?\d+(?:\.\d*)?(?:[eE][-+]?\d+)?")
_ISO = re.compile(r"(?P<year>\d{4})-\d\d-\d\d[T ]\d\d:\d\d(?::\d\d(?:\.\d{1,9})?)?Z?", re.ASCII)
_SKIPPED = (
    "a clock change skips this local time; a logger that keeps one offset all year needs it as its zone"
)


@dataclass
class Waiting:
    """A row on its way to the test."""

    time: float
    """By the clock of the sensor [s]."""
    number: int
    # residual, signature, distance, reading: see `echocal.watch.monitor.Monitor.add`
    """Of the row among those of the sensor."""
    residual: float
    signature: list[float]
    distance: float
    reading: float
    row: dict[str, Any]
    """The row for a diagnosis."""
    target: tuple[str, int] | None = None
    """Target of the row, and the number of the row among those of the target."""

    def to_list(self) -> list[Any]:
        """As plain data."""
        return list(vars(self).values())

    @classmethod
    def restored(cls, kept: list[Any]) -> "Waiting":
        """From what `to_list` gave."""
        own = cls(*kept)
        own.target = None if own.target is None else (own.target[0], own.target[1])
        return own


@dataclass(frozen=True)
class Moved:
    """The clock does not go on from the row before: it was set, or began again."""

    # before, after: time of the row before, and of the first row that goes on from elsewhere [s]
    before: float
    after: float


@dataclass
class Clock:
    """Time of the test of one sensor, in which rows only go forward.

    A time that is later than the last one, by a few usual waits at most, is believed at once. Any other
    time is a leap. Its row waits until some rows in a row go on from it. Where the next row goes on from the
    last believed time instead, the leap was an error, and its rows are given back. So a wrong time costs
    one row, and no clock silences a sensor.
    """

    settings: WatchSettings
    last: float | None = None
    """Last time that was believed, by the clock of the sensor [s]."""
    offset: float = 0.0
    """Time of the test less that of the clock [s]."""
    parts: list[list[float]] = field(default_factory=list)
    """From which time of the test on there is which offset."""
    steps: list[float] = field(default_factory=list)
    """Last waits between rows [s]."""
    waiting: list[Waiting] = field(default_factory=list)
    """Rows that may be a leap."""

    def add(self, row: Waiting) -> tuple[list[Waiting], list[Waiting], Moved | None]:
        """Take one row in.

        Returns the rows that are ready for the test, in the order of time; rows whose times are errors; and
        whether the clock was set.
        """
        if row.time == self.last:
            return [], [row], None
        if self.last is not None and 0.0 < row.time - self.last <= self._reach():
            refuted, self.waiting = self.waiting, []
            self._go_on([row])
            return [row], refuted, None
        refuted = [] if self._goes_on(row.time) else self.waiting
        self.waiting = [row] if refuted else [*self.waiting, row]
        if len(self.waiting) < self.settings.confirm:
            return [], refuted, None
        believed, self.waiting = self.waiting, []
        moved = self._leap(believed[0].time)
        self._go_on(believed)
        return believed, refuted, moved

    def of_test(self, time: float) -> float:
        """Time of the test at a believed time of the present clock [s]."""
        return time + self.offset

    def shown(self, time: float) -> float:
        """Time by the clock of the sensor, as it was then, at a time of the test [s]."""
        own = [offset for begin, offset in self.parts if begin <= time]
        return time - (own[-1] if own else self.parts[0][1] if self.parts else 0.0)

    def _reach(self) -> float:
        """Longest wait that is no leap [s]: by the lower median, as the first of two waits may be a leap."""
        return self.settings.gap * sorted(self.steps)[(len(self.steps) - 1) // 2]

    def _goes_on(self, time: float) -> bool:
        """Whether a time goes on from the leap that waits."""
        if not self.waiting:
            return True
        came_back = self.last is not None and self.waiting[0].time < self.last < time
        return time > self.waiting[-1].time and not came_back

    def _leap(self, first: float) -> Moved | None:
        """Go on at another time. A leap forward is a pause, unless the clock had no date before."""
        if self.last is None:
            self.parts.append([first, 0.0])
            return None
        end = self.last + self.offset
        was_set = first < self.last or (self.offset != 0.0 and self.last < _CALENDAR <= first)
        if was_set or (first >= _CALENDAR and first > end):
            offset = 0.0 if first > end else end + 1.2 * self._reach() - first
            if offset != self.offset:
                self.offset = offset
                self.parts = [*self.parts[1 - _KEPT :], [first + offset, offset]]
        return Moved(self.last, first) if was_set else None

    def _go_on(self, rows: list[Waiting]) -> None:
        for row in rows:
            if self.last is not None and row.time > self.last:
                self.steps = [*self.steps[1 - _STEPS :], row.time - self.last]
            self.last = row.time

    def to_dict(self) -> dict[str, Any]:
        """As plain data, exactly."""
        names = ("last", "offset", "parts", "steps")
        return {name: getattr(self, name) for name in names} | {
            "waiting": [row.to_list() for row in self.waiting]
        }

    @classmethod
    def restored(cls, kept: dict[str, Any], settings: WatchSettings) -> "Clock":
        """Continue where `to_dict` was called."""
        waiting = [Waiting.restored(row) for row in kept["waiting"]]
        return cls(settings, **{**kept, "waiting": waiting})


@dataclass
class Times:
    """Texts of the clock of one sensor, to seconds since 1970 in UTC.

    A text says its time alone, with two exceptions. The order of day and month is that of the dates before
    it. An hour that comes twice when summer time ends is the first one, unless this is not later than the
    row before.
    """

    column: str
    zone: str = ReadOptions.time_zone
    """Time zone of texts without an offset."""
    time_format: str | None = None
    """How times are written; see `echocal.read_observations`."""
    dates: list[str] = field(default_factory=list)
    """Texts with the dates so far, up to those that tell day and month apart."""
    told_apart: bool = False
    """Whether they do."""
    last: float | None = None
    """Seconds of the last row that was read."""

    def read(self, values: Sequence[Any]) -> tuple[Column, list[str]]:
        """Seconds of each row, NaN where it has none; and why its field is no time."""
        seconds, reasons = np.full(len(values), np.nan), [""] * len(values)
        groups: dict[str, list[int]] = {}
        for place, value in enumerate(values):
            if not self.told_apart and self._has_two_ways(value):
                reasons[place] = self._tell_apart(value.strip())
            if not reasons[place]:
                groups.setdefault(_form(value), []).append(place)
        twice: dict[int, tuple[float, float]] = {}
        for places in groups.values():
            self._group(places, [values[place] for place in places], seconds, reasons, twice)
        for place in np.flatnonzero(np.isfinite(seconds)).tolist() if twice else ():
            if place in twice and self.last is not None and twice[place][0] <= self.last:
                seconds[place] = twice[place][1]
            self.last = float(seconds[place])
        known = np.flatnonzero(np.isfinite(seconds))
        if len(known):
            self.last = float(seconds[known[-1]])
        return seconds, reasons

    def _has_two_ways(self, value: Any) -> bool:
        match = DAY.fullmatch(value.strip()) if isinstance(value, str) and not self.time_format else None
        return match is not None and match["a"] is not None and match["cut"] != "."

    def _tell_apart(self, text: str) -> str:
        """Why day and month cannot be told apart by the dates so far; empty if they can."""
        if _date(text) not in map(_date, self.dates):
            self.dates.append(text)
        try:
            as_iso(pd.Series(self.dates, dtype=object), self.column)
        except DataError as error:
            return str(error)
        self.told_apart = True
        return ""

    def _group(
        self,
        places: list[int],
        values: list[Any],
        seconds: Column,
        reasons: list[str],
        twice: dict[int, tuple[float, float]],
    ) -> None:
        """Read texts that are written alike; one that cannot be read stops no other."""
        try:
            found = self._instants(values)
        except DataError as error:
            if len(places) == 1:
                reasons[places[0]] = str(error) if _is_number(values[0]) else self._no_time(values[0])
                return
            for place, value in zip(places, values, strict=True):
                self._group([place], [value], seconds, reasons, twice)
            return
        zone = None if re.match(r"[+-]\d|UTC$", self.zone) else ZoneInfo(self.zone)
        if zone is None or self._says_offset(values[0]):
            seconds[places] = found
            return
        for place, local in zip(places, found.tolist(), strict=True):
            both = _in_zone(local, zone)
            seconds[place] = both[0] if both else np.nan
            if len(both) > 1:
                twice[place] = (both[0], both[1])
            if not both and np.isfinite(local):
                reasons[place] = f"{_SKIPPED}: {keyword('time_zone', 'Etc/GMT-1')} is UTC+1"

    def _no_time(self, value: Any) -> str:
        return (
            f"its {self.column} is {shown(str(value))!r}, which is no time in ISO 8601 "
            f"(2024-05-31T13:45:00); written otherwise: {keyword('time_format', '%d.%m.%Y %H:%M:%S')}"
        )

    def _instants(self, values: list[Any], zone: str | None = None) -> Column:
        """Seconds since 1970; of local times in a zone with clock changes, as if it were UTC."""
        if (plain := self._plain(values)) is not None:
            return plain
        fixed = self.zone if self.zone[:1] in {"+", "-"} else "UTC"
        known = self.dates if self._has_two_ways(values[0]) else []
        column = pd.Series([*known, *values], dtype=float if _is_number(values[0]) else object)
        times, _ = instants(column, self.column, zone or fixed, self.time_format)
        found = (times - np.datetime64(0, "ns")) / np.timedelta64(1, "s")
        return np.asarray(np.where(np.isnat(times), np.nan, found), dtype=np.float64)[len(known) :]

    def _plain(self, values: list[Any]) -> Column | None:
        """Seconds of texts in ISO 8601 and UTC, a hundred times as fast; None where one is another."""
        if self.zone != "UTC" or self.time_format or not all(map(_is_plain, values)):
            return None
        try:
            times = np.array([text.strip(" Z").replace(" ", "T") for text in values], dtype="datetime64[ns]")
        except ValueError:  # no such day
            return None
        return np.asarray(times.astype(np.int64) / 1e9)

    def _says_offset(self, value: Any) -> bool:
        return bool(self._instants([value], "UTC")[0] == self._instants([value], "+01:00")[0])


def _form(value: Any) -> str:
    """Texts of one form are read together: they differ in digits and names only."""
    if not isinstance(value, str):
        return type(value).__name__
    text = _LETTERS.sub("A", value.strip())
    return _DIGITS.sub(lambda match: "9" * len(match[0]), text)


def _is_plain(value: Any) -> bool:
    match = _ISO.fullmatch(value.strip()) if isinstance(value, str) else None
    return match is not None and YEARS[0] < int(match["year"]) < YEARS[1]


def _date(text: str) -> tuple[str, ...]:
    match = DAY.fullmatch(text)
    return (match["a"], match["b"], match["y2"]) if match else (text,)


def _is_number(value: Any) -> bool:
    if isinstance(value, str):
        return bool(_NUMBER.fullmatch(value.strip()))
    return isinstance(value, int | float) and not isinstance(value, bool)


def _in_zone(local: float, zone: ZoneInfo) -> list[float]:
    """Instants at which the clocks of a zone show a time: mostly one, none or two at a clock change [s]."""
    if not np.isfinite(local):
        return []
    whole = int(local // 1.0)
    shown = datetime.fromtimestamp(whole, UTC).replace(tzinfo=None)
    found = []
    for fold in (0, 1):
        instant = int(shown.replace(tzinfo=zone, fold=fold).timestamp())
        if datetime.fromtimestamp(instant, zone).replace(tzinfo=None) == shown and instant not in found:
            found.append(instant)
    return [instant + (local - whole) for instant in found]
