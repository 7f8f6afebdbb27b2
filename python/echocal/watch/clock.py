"""The clock of a sensor: which times of rows are believed, and how the time of the test goes on."""

from dataclasses import dataclass, field
from typing import Any

from echocal.watch.settings import WatchSettings

__all__ = ["Clock", "Moved", "Waiting"]

_STEPS = 32  # waits between rows that say what is usual
_KEPT = 100  # times that a clock was set which are remembered
_CALENDAR = 1e8  # s: a clock below counts from its own start, or was not set


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

        Returns
        -------
        believed : list of Waiting
            Rows that are ready for the test, in the order of time.
        refuted : list of Waiting
            Rows whose times are errors.
        moved : Moved or None
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
