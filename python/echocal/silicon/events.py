"""What happens on the emulated board, event by event, and which line belongs to which row."""

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

__all__ = ["CLOCK", "Habit", "Line", "Log", "codes_of", "habit_of", "rows_of"]

CLOCK = 16_000_000
"""Cycles in a second."""


@dataclass(frozen=True)
class Line:
    """A line that the sketch sent: when its first byte was sent, its number among all bytes, and its text."""

    cycle: int
    index: int
    text: str


@dataclass
class Log:
    """Events of a run, in cycles."""

    triggers: list[int] = field(default_factory=list)
    falls: list[int] = field(default_factory=list)
    conversions: list[tuple[int, int, int, int]] = field(default_factory=list)
    """Row, pin, code and cycle."""
    written: list[tuple[int, int]] = field(default_factory=list)
    """Cycle, and bytes written to ``Serial`` by then."""
    lines: list[Line] = field(default_factory=list)
    asked_again: int | None = None
    other_pins: list[tuple[int, int, int]] = field(default_factory=list)
    """Pin, number of pulses, and cycles of the longest."""
    short_pulses: tuple[int, int] = (0, 0)
    """Number, and cycles of the longest."""
    end: int = 0
    reason: str = "crashed"

    def add(self, told: str) -> bool:
        """Take in a line of the simulator; return whether it is a trigger."""
        kind, _, rest = told.rstrip("\n").partition(" ")
        match kind:
            case "t":
                self.triggers.append(int(rest))
            case "f":
                self.falls.append(int(rest))
            case "c":
                row, pin, code, cycle = map(int, rest.split())
                self.conversions.append((row, pin, code, cycle))
            case "w":
                self.written.append(_two(rest))
            case "l":
                begun, index, text = rest.split(" ", 2)
                self.lines.append(Line(int(begun), int(index), text))
            case "a":
                self.asked_again = int(rest)
            case "p":
                pin, number, longest = map(int, rest.split())
                self.other_pins.append((pin, number, longest))
            case "s":
                self.short_pulses = _two(rest)
            case "e":
                end, self.reason = rest.split()
                self.end = int(end)
        return kind == "t"

    def written_at(self, line: Line) -> int:
        """Return the cycle in which the sketch wrote the first byte of a line, to 250 us."""
        place = int(np.searchsorted([count for _, count in self.written], line.index, side="right"))
        return min(line.cycle, self.written[place][0] if place < len(self.written) else line.cycle)


@dataclass(frozen=True)
class Habit:
    """In what order a sketch does things in its loop.

    Attributes
    ----------
    early : bool
        Whether it reads the analog pins before it triggers.
    lines : int
        Lines that it prints in a loop.
    lines_before : int
        Those of them that it prints before it triggers.
    """

    early: bool = False
    lines: int = 1
    lines_before: int = 0


def habit_of(log: Log) -> Habit:
    """Return the habit that the last whole loop of a run shows.

    A loop goes from trigger to trigger. A sketch waits somewhere in it, mostly by ``delay``. What it does
    between this longest wait and the next trigger belongs to the next row.
    """
    ends = [*log.triggers, *([log.asked_again] if log.asked_again is not None else [])]
    if len(ends) < 2:
        return Habit()
    begin, end = ends[-2:]
    start = max((fall for fall in log.falls if begin < fall < end), default=begin)
    prints = [at for at in map(log.written_at, log.lines) if begin <= at < end]
    converts = [at for *_, at in log.conversions if begin <= at < end]
    times = sorted([start, *(at for at in (*prints, *converts) if at > start), end])
    waits = np.diff(times)
    resumed = times[int(np.argmax(waits)) + 1]
    later = sum(at >= resumed for at in prints)
    return Habit(any(at >= resumed for at in converts), len(prints), later)


def rows_of(log: Log, habit: Habit, count: int) -> tuple[tuple[str, ...], list[tuple[str, ...]]]:
    """Return what was printed before the first row, and the lines of each row."""
    ends = [*log.triggers, *([log.asked_again] if log.asked_again is not None else [])]
    places = np.searchsorted(ends, [log.written_at(line) for line in log.lines], side="right") - 1
    between: list[list[str]] = [[] for _ in range(count + 1)]
    for line, place in zip(log.lines, places, strict=True):
        if place < count:
            between[place + 1].append(line.text)
    kept = [len(lines) - habit.lines_before for lines in between]
    rows = [
        (*between[row][max(0, kept[row]) :], *between[row + 1][: max(0, kept[row + 1])])
        for row in range(count)
    ]
    return tuple(between[0][: max(0, kept[0])]), rows


def codes_of(log: Log, count: int, pins: int) -> NDArray[np.int64]:
    """Return the last code of each analog pin in each row, shape (count, pins); -1 where it was not read."""
    codes = np.full((count, pins), -1, dtype=np.int64)
    for row, pin, code, _ in log.conversions:
        if 0 <= row < count:
            codes[row, pin] = code
    return codes


def _two(text: str) -> tuple[int, int]:
    first, second = map(int, text.split())
    return first, second
