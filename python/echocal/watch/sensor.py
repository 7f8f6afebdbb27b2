"""One sensor: its rows wait for what their correction needs, its monitor tests them, its changes are told."""

import warnings
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any, Protocol

import numpy as np

from echocal.arrays import Column
from echocal.correct.needed import context_of
from echocal.correct.results import LEVEL, STATUS, UNCERTAINTY
from echocal.errors import DataError
from echocal.keywords import keyword
from echocal.model import Model
from echocal.observations.clock import hour_angle, zone_of
from echocal.observations.marks import MARKS
from echocal.watch import sentences
from echocal.watch.clock import Clock, Times, Waiting
from echocal.watch.correction import RATES, Entry
from echocal.watch.events import Event, finite
from echocal.watch.monitor import Monitor
from echocal.watch.rows import Row, conditions_of, row_to_keep
from echocal.watch.settings import WatchSettings
from echocal.watch.signatures import Signature, Signatures, refuse_unwatchable, step_and_drift


def results(first: str) -> tuple[str, str, str]:
    """Names of the columns that are appended, where the first is that of a distance or of a level."""
    return first, UNCERTAINTY, STATUS


_DIGITS = 9  # of a distance [m]: to a nanometer
_WINDOW = 15.0  # s: what a rate is taken over at least, as far back as at the end of a table
_PLAIN = ("recorded", "level", "before", "follow", "told", "ignored", "rows", "done", "dated", "requests")


@dataclass
class Done:
    """A corrected row of a sensor."""

    entry: Entry
    sensor: "Sensor | None"  # None where there is no model
    status: str
    # distance, uncertainty: corrected distance and its standard uncertainty [m]
    distance: float = np.nan
    uncertainty: float = np.nan
    level: float = np.nan  # what is written of a level [m]
    released: int = 0  # place of the row that this one has waited for
    reference: float = np.nan  # reference distance [m]
    target: tuple[str, int] | None = None  # see `Waiting`

    def order(self) -> tuple[int, int]:
        """Rows come out when they are released, in the order in which they came."""
        return self.released, self.entry.place

    def output(self, names: tuple[str, str, str]) -> Row:
        """The row with its results under their names; not a number is None."""
        uncertainty = float(str(np.float32(self.uncertainty)))
        value = self.level if names[0] == LEVEL else self.distance
        own = map(finite, (round(value, _DIGITS), uncertainty, self.status))
        return {**self.entry.row, **dict(zip(names, own, strict=True))}


class Host(Protocol):
    """What a sensor asks of those who watch it."""

    def keep(self, sensor: "Sensor", row: Waiting, time: float) -> None:
        """Keep a row that is tested, by the time of the test [s]."""

    def diagnosed(self, sensor: "Sensor", row: Waiting) -> Event | None:
        """Run the diagnosis on the rows up to this one; an event if there is news."""

    def farthest(self, row: Waiting, since: float) -> str | None:
        """The sensor of the target that has moved farthest since a time [s]."""


@dataclass
class Sensor:
    """The rows of one sensor, in the order in which they come."""

    id: str
    model: Model
    settings: WatchSettings
    reference: str
    """Where its reference distance comes from; one of "column", "distance", "constant", "others", "none"."""
    interval: float | None = None  # time between rows [s] that the user states
    mark_rows: bool = True  # whether rules of the model mark rows
    monitor: Monitor = field(init=False)
    clock: Clock = field(init=False)
    times: Times = field(default_factory=lambda: Times(""))
    recorded: list[str] | None = None
    level: float | None = None
    before: list[list[float]] = field(default_factory=list)
    follow: dict[str, Any] | None = None
    told: list[Any] | None = None
    ignored: int = 0
    rows: int = 0
    window: list[Entry] = field(default_factory=list)
    """Rows that wait for later ones, and the corrected ones before them that their marks look at."""
    done: int = 0  # how many of them are corrected
    dated: bool = False
    requests: dict[str, str] = field(default_factory=dict)
    _signatures: Signatures | None = None

    def __post_init__(self) -> None:
        refuse_unwatchable(self.model)
        self.monitor = Monitor(self.settings, self.interval)
        self.clock = Clock(self.settings)

    @property
    def context(self) -> int:
        """Rows before and after a row that its marks look at."""
        return context_of(self.model) if self.mark_rows and MARKS in self.model.provenance else 0

    def arrive(self, entries: Sequence[Entry], zone: str, time_format: str | None) -> None:
        """Read the times of new rows and the rates at them, and let them wait."""
        written: dict[str, list[Entry]] = {}
        for entry in entries:
            clock = entry.columns.clock if entry.columns is not None else None
            if clock is not None and clock.name == "time":
                written.setdefault(clock.column, []).append(entry)
                self.dated = True
            elif clock is not None:
                entry.time = float(clock.unit.to_si(entry.numbers[clock.column]))
                entry.untimed = f"{clock.column} is no number" if clock.column in entry.damaged else ""
            elif self.interval is not None:
                entry.time = self.interval * entry.number
        for column, own in written.items():
            self.times.column, self.times.zone = column, zone_of(column, zone)
            self.times.time_format = time_format
            seconds, reasons = self.times.read([entry.row[column] for entry in own])
            for entry, time, reason in zip(own, seconds.tolist(), reasons, strict=True):
                entry.time, entry.untimed = time, reason
        for entry in entries:
            self._rate(entry)
        self.window += entries

    def released(self, *, all_of_them: bool = False) -> range:
        """Places in the window of the rows that wait no longer."""
        return range(self.done, len(self.window) if all_of_them else self.done + self.ready)

    @property
    def ready(self) -> int:
        """How many rows wait no longer."""
        return max(len(self.window) - self.done - self.context, 0)

    def release(self, rows: range) -> None:
        """Take rows for corrected; keep as many as the marks of the next ones look at."""
        first = max(rows.stop - self.context, 0)
        self.window, self.done = self.window[first:], rows.stop - first

    def test(self, rows: Sequence[Done], host: Host) -> list[tuple[int, Event]]:
        """Test corrected rows against their reference, in their order; events with the places of rows."""
        if self.reference == "none":
            return []
        if self.reference == "constant" and self.level is None:
            self.level = next((row.distance for row in rows if np.isfinite(row.distance)), None)
        usable = [row for row in rows if np.isfinite(row.distance) and np.isfinite(row.reference)]
        if not usable:
            return []
        signatures = self._at(usable)
        events: list[tuple[int, Event]] = []
        for row, signature in zip(usable, signatures.tolist(), strict=True):
            entry = row.entry
            against = row.reference if self.level is None else self.level
            if entry.units and entry.columns is not None:
                self.requests |= entry.columns.requests
            kept = row_to_keep(entry.row, entry.numbers, entry.columns)
            if self.reference == "others":
                kept["distance_m"] = row.reference
            reading = entry.numbers.get(entry.columns.echo, np.nan) if entry.columns is not None else np.nan
            residual = row.distance - against
            one = Waiting(entry.time, entry.number, residual, signature, against, reading, kept, row.target)
            if row.status:
                events += [(entry.place, e) for e in sentences.ignored(self, one, [one], row.status)]
                continue
            events += [(entry.place, event) for event in self._row(one, entry.untimed, host)]
        return events

    def _row(self, row: Waiting, untimed: str, host: Host) -> list[Event]:
        if not np.isfinite(row.time):
            why = untimed or "it has no time of the years 1678 to 2261"
            return sentences.ignored(self, row, [row], why)
        last = self.clock.last
        believed, refuted, moved = self.clock.add(row)
        events = []
        if refuted:
            events = sentences.ignored(self, row, refuted, sentences.why_refuted(self, refuted, last))
        if moved is not None:
            events.append(sentences.moved(self, row, moved))
        for one in believed:
            events += self._tested(one, host)
        return events

    def _tested(self, row: Waiting, host: Host) -> list[Event]:
        time = self.clock.of_test(row.time)
        host.keep(self, row, time)
        events = []
        was_learning = self.monitor.learning
        alarm = self.monitor.add(time, row.residual, np.array(row.signature), row.distance, row.reading)
        if was_learning and not self.monitor.learning:
            events.append(sentences.learned(self, row))
        if alarm is not None:
            farthest = host.farthest(row, self.clock.shown(alarm.times[0]))
            events.append(sentences.changed(self, row, alarm, farthest))
        verdict = host.diagnosed(self, row) if self._is_due() else None
        return events if verdict is None else [*events, verdict]

    def _is_due(self) -> bool:
        """Whether the diagnosis runs: at the fewest rows after an onset, and whenever they have doubled."""
        if self.follow is None:
            return False
        self.follow["rows"] += 1
        rows, before = self.follow["rows"], self.follow["at"]
        return bool(rows >= self.settings.fewest and rows >= 2 * before)

    def _at(self, rows: Sequence[Done]) -> Column:
        """What each cause would add to the residual of each row; the step is the first [m]."""
        given = [self._conditions(row.entry) for row in rows]
        if self.dated:
            instants = np.array([row.entry.time for row in rows]) * 1e9
            angles = hour_angle(instants.astype("datetime64[ns]"), self.times.zone).tolist()
            given = [{**own, "hour_angle": angle} for own, angle in zip(given, angles, strict=True)]
        if self.recorded is None:
            self.recorded = list(given[0])
        conditions = {name: np.array([own.get(name, np.nan) for own in given]) for name in self.recorded}
        with warnings.catch_warnings(action="ignore"):  # the correction has told it
            found = self._candidates().at(np.array([row.reference for row in rows]), conditions)
        return np.column_stack([np.full(len(rows), 0.005), found])

    def _conditions(self, entry: Entry) -> dict[str, float]:
        """Influence quantities of a row, with the rates."""
        assert entry.columns is not None
        found = conditions_of(entry.numbers, entry.columns)
        for rate, value in zip(RATES, entry.rates, strict=True):
            if RATES[rate] in found and entry.columns.clock is not None:
                found[rate] = value
        return found

    def _candidates(self) -> Signatures:
        if self._signatures is None:
            self._signatures = Signatures(self.model, self.recorded or ())
        return self._signatures

    def _rate(self, entry: Entry) -> None:
        """Rates from this row and the rows before it; the rows after it have not come yet.

        Where the clock goes back, the rows before are of another time: rates begin anew.
        """
        if entry.columns is None or not np.isfinite(entry.time) or entry.columns.clock is None:
            return
        given, now = conditions_of(entry.numbers, entry.columns), entry.time
        values = [given.get(of, np.nan) for of in RATES.values()]
        if not np.isfinite(values).any():
            return
        if self.before and now < self.before[-1][0]:
            self.before = []
        for place, value in enumerate(values):
            entry.rates[place] = self._rate_of(now, value, place)
        if not self.before or now > self.before[-1][0]:
            old = [row for row in self.before if row[0] < now - _WINDOW]
            self.before = [*old[-1:], *[r for r in self.before if r[0] >= now - _WINDOW], [now, *values]]

    def _rate_of(self, now: float, value: float, place: int) -> float:
        earlier = [row for row in self.before if row[0] < now and np.isfinite(row[1 + place])]
        if not earlier or not np.isfinite(value):
            return 0.0 if np.isfinite(value) else np.nan
        times = [row[0] for row in earlier]
        start = max(min(now - _WINDOW, times[-1]), times[0])
        was = float(np.interp(start, times, [row[1 + place] for row in earlier]))
        return (value - was) / (now - start)

    def signatures(self) -> list[Signature]:
        """All that are tested or belong to the class of one that is."""
        return [step_and_drift()[0], *self._candidates().listed, step_and_drift()[1]]

    def classes(self) -> list[list[str]]:
        """Causes by class, the drift last: the rows so far cannot tell those of one class apart."""
        listed = self.signatures()
        return [[listed[c].id for c in own] for own in self.monitor.classes] + [[listed[-1].id]]

    def to_dict(self) -> dict[str, Any]:
        """As plain data, exactly."""
        times = {name: getattr(self.times, name) for name in ("dates", "told_apart", "last")}
        return {name: getattr(self, name) for name in _PLAIN} | {
            "monitor": self.monitor.to_dict(),
            "clock": self.clock.to_dict(),
            "times": times,
            "window": [entry.to_list() for entry in self.window],
            "model": self.model.hash,
        }

    def restore(self, kept: dict[str, Any]) -> None:
        """Continue where `to_dict` was called; the rows of the window are still to be read."""
        if kept["model"] != self.model.hash:
            who = f"sensor {self.id}" if self.id else "the sensor"
            raise DataError(
                f"the state is of another model of {who} ({kept['model'][:12]}, now {self.model.hash[:12]}): "
                f"give that model, or begin with another {keyword('state')}"
            )
        for name in _PLAIN:
            setattr(self, name, kept[name])
        self.times = Times("", **kept["times"])
        self.clock = Clock.restored(kept["clock"], self.settings)
        self.monitor = Monitor.restored(kept["monitor"], self.settings)
        self.window = [Entry(*row) for row in kept["window"]]
