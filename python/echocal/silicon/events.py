"""What happens on the emulated board, event by event, and which line belongs to which row."""

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

CLOCK = 16_000_000
"""Cycles in a second."""

_NO_WAIT = CLOCK // 500
"""Shorter gaps are none that a sketch makes on purpose [cycles]."""


@dataclass(frozen=True)
class Line:
    """A line that the sketch sent: when it began, the numbers of its first and last byte, and its text."""

    cycle: int
    first: int
    last: int
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
                begun, first, last, text = rest.split(" ", 3)
                self.lines.append(Line(int(begun), int(first), int(last), text))
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

    def written_at(self, line: Line) -> tuple[int, int]:
        """Return the cycles in which the sketch wrote the first and the last byte of a line, to 250 us."""
        counts = [count for _, count in self.written]
        first, last = (int(place) for place in np.searchsorted(counts, [line.first, line.last], side="right"))
        begun = min(line.cycle, self.written[first][0] if first < len(counts) else line.cycle)
        return begun, self.written[last][0] if last < len(counts) else self.end

    @property
    def ends(self) -> list[int]:
        """Cycles of the triggers, the one after the last row included."""
        return [*self.triggers, *([] if self.asked_again is None else [self.asked_again])]


@dataclass(frozen=True)
class Habit:
    """In what order a sketch does things in its loop."""

    early: bool = False  # whether it reads the analog pins before it triggers
    lines_before: int = 0  # lines that it prints before it triggers


def habit_of(log: Log) -> Habit:
    """Return the habit that the last whole loop of a run shows.

    A loop goes from trigger to trigger. A sketch waits somewhere in it, mostly by ``delay``, and not within a
    line. What it does between this longest wait and the next trigger belongs to the next row. Where it does
    not wait, the first loop tells.
    """
    if len(log.ends) < 2:
        return Habit()
    begin, end = log.ends[-2:]
    start = max((fall for fall in log.falls if begin < fall < end), default=begin)
    prints = [log.written_at(line) for line in log.lines]
    converts = [at for *_, at in log.conversions if begin <= at < end]
    spans = [(at, at) for at in converts] + prints
    inside = [(max(first, start), min(last, end)) for first, last in spans if last >= start and first < end]
    wait, resumed = _longest_wait(sorted([(start, start), *inside, (end, end)]))
    if wait < _NO_WAIT:
        return _habit_of_the_first_loop(log)
    ended = [last for _, last in prints if begin < last <= end]
    return Habit(any(at >= resumed for at in converts), sum(last >= resumed for last in ended))


def _longest_wait(spans: list[tuple[int, int]]) -> tuple[int, int]:
    """Return the longest gap between spans, which are sorted, and where the next one begins."""
    longest, resumed, reached = -1, spans[0][0], spans[0][1]
    for first, last in spans[1:]:
        if first - reached > longest:
            longest, resumed = first - reached, first
        reached = max(reached, last)
    return longest, resumed


def _habit_of_the_first_loop(log: Log) -> Habit:
    """Return the habit of a sketch that never waits: what it converts before the first trigger is early."""
    begin = log.ends[0]
    early = [at for *_, at in log.conversions if at < begin]
    ended = [log.written_at(line)[1] for line in log.lines]
    return Habit(bool(early), sum(max(early, default=begin) < last <= begin for last in ended))


def told_late(habit: Habit, log: Log, other: Log) -> Habit:
    """Return a habit less what a sketch tells of an echo only after its wait.

    The runs differ in their last echo: a line that differs, too, tells of that echo, not of the next.
    """
    if len(log.ends) != len(other.ends):
        return habit
    lines, others = (_of_the_last_loop(one) for one in (log, other))
    alike = 0
    for line, text in zip(lines[::-1], others[::-1], strict=False):
        if line.text != text.text:
            break
        alike += 1
    if alike >= habit.lines_before:
        return habit
    told = log.written_at(lines[-1 - alike])[0] if alike < len(lines) else 0
    after = any(told <= at < log.ends[-1] for *_, at in log.conversions)
    return Habit(habit.early and after, alike)


def _of_the_last_loop(log: Log) -> list[Line]:
    begin, end = log.ends[-2:]
    return [line for line in log.lines if begin < log.written_at(line)[1] <= end]


def rows_of(log: Log, habit: Habit, count: int) -> tuple[tuple[str, ...], list[tuple[str, ...]]]:
    """Return what was printed before the first row, and the lines of each row."""
    ended = [log.written_at(line)[1] for line in log.lines]
    places = np.searchsorted(log.ends, ended, side="left") - 1  # what is seen at a trigger was before it
    between: list[list[str]] = [[] for _ in range(count + 1)]
    for line, place in zip(log.lines, places, strict=True):
        if place < count:
            between[place + 1].append(line.text)
    kept = [max(0, len(lines) - habit.lines_before) for lines in between]
    rows = [(*between[row][kept[row] :], *between[row + 1][: kept[row + 1]]) for row in range(count)]
    return tuple(between[0][: kept[0]]), rows


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
