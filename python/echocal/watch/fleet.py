"""Correct and test the rows of many sensors as they come."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from echocal.correct.rows import Reading
from echocal.errors import DataError, EchocalError, UsageError, among
from echocal.keywords import keyword
from echocal.model import Model
from echocal.model.folder import label
from echocal.observations.mount import mounted_as
from echocal.watch import verdict
from echocal.watch.clock import Waiting
from echocal.watch.comparison import Comparison
from echocal.watch.correction import NO_ECHO, Entry, Results, correct, first_of
from echocal.watch.events import Event
from echocal.watch.reference import Models, Reference, refuse_columns
from echocal.watch.rows import Reader, Row, refused_names
from echocal.watch.sensor import Done, Sensor, results
from echocal.watch.settings import WatchSettings
from echocal.watch.signatures import unwatchable
from echocal.watch.state import State

_NO_KEY = "no key"

Told = list[tuple[int, Event]]
Units = Mapping[str, str] | None


@dataclass
class Fleet:
    """The sensors that are watched.

    Attributes
    ----------
    models : callable
        Model of a sensor.
    by : str or None
        Column with the id of the sensor; None for one sensor.
    reference : Reference
    settings : WatchSettings
    state : State
    options : dict
        Arguments of `echocal.read_observations`.
    interval : float or None
        Time between rows of a sensor [s].
    own_models : bool
        Each sensor has a model of its own: one that cannot be watched stops its sensor, not the others.
    mark_rows : bool
        Whether rows that are as those which the diagnosis of the model left out get no corrected distance.
    uncertainties : sequence of str, or mapping of str to float
        See `echocal.correct.correct_table`.
    decimal : str or None
        Decimal separator of texts; None: as each source of rows has it.
    mixed : bool
        Rows of many kinds come, as messages do: the first ones do not show what the others have.

    Examples
    --------
    >>> import numpy as np
    >>> import echocal
    >>> from echocal.watch import Fleet, Reference, State, WatchSettings
    >>> device = echocal.Model("linear")
    >>> one_meter = Reference(reference_distance=1.0)
    >>> fleet = Fleet(lambda id_: device, None, one_meter, WatchSettings(), State(None))
    >>> rows = [{"time_s": 600 * i, "reading_m": 1.001, "temperature_C": 20.0 + i % 2} for i in range(600)]
    >>> corrected, events = fleet.take(rows)
    >>> corrected[1]["corrected_distance_m"], [event.kind for event in events]
    (1.001, ['learned', 'verdict'])
    """

    models: Models
    by: str | None
    reference: Reference
    settings: WatchSettings
    state: State
    options: dict[str, Any] = field(default_factory=dict)
    interval: float | None = None
    own_models: bool = False
    mark_rows: bool = True
    uncertainties: Sequence[str] | Mapping[str, float] = ()
    decimal: str | None = None
    mixed: bool = False
    rows: int = 0
    corrected: int = 0
    ignored: int = 0
    _sensors: dict[str, Sensor | None] = field(default_factory=dict)
    _checked: bool = False

    def __post_init__(self) -> None:
        ignored = [name for name in (self.by, self.reference.same_target, "topic") if name]
        own = Reading.of(self.options, self.uncertainties, self.mark_rows)
        self._time_format = own.time_format
        self._reading = replace(own, time_format=None)  # of times that are read
        self._reader = Reader(
            own.requests, ignored=ignored, missing=own.missing, mount_height=own.mount_height
        )
        codes = own.missing if isinstance(own.missing, Mapping) else ()
        self._named = {"columns": own.requests, "trust": own.trust, "missing": codes}
        self._comparison = Comparison(self.reference, self.state)

    def results(self, row: Row) -> tuple[str, str, str]:
        """Names of the columns that are appended to a row."""
        return results(first_of(row, self._reading))

    def refusal(self, row: Row) -> str:
        """Why a row alone, of many kinds, is none of an echo; empty if it is one."""
        if why := refused_names(row, self.results(row)):
            return why
        if self.by is not None and not _id_of(row.get(self.by)):
            held = f"holds {row[self.by]!r}" if self.by in row else f"is not there; it has {', '.join(row)}"
            return f"no sensor id: the field '{self.by}' of {keyword('by')} {held:.200}"
        try:
            columns = self._reader.columns(list(row))
        except EchocalError as error:
            return str(error)
        return "" if columns.has_echo else f"{NO_ECHO}; it has {', '.join(row):.200}"

    def meet(self, rows: Sequence[Row], whys: Sequence[str] = ()) -> list[Event]:
        """Know the sensors of rows: with the state of a former watch, or anew.

        Raises
        ------
        DataError
            If the state is of another model, or the model of all sensors cannot be watched.
        """
        ids = (self._id(row, why) for row, why in zip(rows, whys or [""] * len(rows), strict=True))
        return [event for id_ in dict.fromkeys(ids) if id_ is not None for event in self._known(id_)]

    def take(
        self, rows: Sequence[Row], decimal: str = ".", units: Units = None, whys: Sequence[str] = ()
    ) -> tuple[list[Row], list[Event]]:
        """Correct rows, and test them: rows with three columns more, and what there is to tell.

        Rows whose marks look at rows after them come when these have come; see `finish`.

        Their log says the `decimal` separator of texts and `units` by column; `whys` are reasons why rows
        cannot be read, empty where they can.

        Raises
        ------
        DataError
            If the first rows lack what every row needs: a sensor's id, a time, something to be compared with.
        """
        if not rows:
            return [], []
        told: Told = [(-1, event) for event in (*self._check(rows, units), *self.meet(rows, whys))]
        place = int(self.state.fact("place") or 0)
        self.state.set_fact("place", place + len(rows))
        lost: list[Done] = []
        own: dict[str, list[Entry]] = {}
        for row, why in zip(rows, whys or [""] * len(rows), strict=True):
            place, id_ = place + 1, self._id(row, why)
            sensor = None if id_ is None else self._sensors[id_]
            if id_ is None or sensor is None:
                why = why or (_NO_KEY if id_ is None else f"no model for sensor {id_}")
                lost.append(Done(Entry(row, 0, place), None, why, released=place))
                continue
            sensor.rows += 1
            entry = Entry(row, sensor.rows, place, self.decimal or decimal, units=units or {}, why=why)
            own.setdefault(id_, []).append(entry.read(self._reader, sensor.model))
        sensors = [sensor for id_ in own if (sensor := self._sensors[id_])]
        for sensor in sensors:
            sensor.arrive(own[sensor.id], self._reading.time_zone, self._time_format)
        done, notes = self._corrected([(sensor, sensor.released()) for sensor in sensors])
        for sensor in sensors:
            sensor.release(sensor.released())
        self.rows += len(rows)
        return self._finished([*done, *lost], told + notes, sensors)

    def finish(self) -> tuple[list[Row], list[Event]]:
        """Correct and test the rows that still wait for later ones, which do not come any more."""
        waiting = [(sensor, sensor.released(all_of_them=True)) for sensor in self._waiting()]
        done, notes = self._corrected(waiting)
        for sensor, rows in waiting:
            sensor.release(rows)
        return self._finished(done, notes, [sensor for sensor, _ in waiting])

    def so_far(self) -> list[Row]:
        """The rows that still wait, corrected as if no row came any more; nothing changes."""
        waiting = [(sensor, sensor.released(all_of_them=True)) for sensor in self._waiting()]
        done, _ = self._corrected(waiting, tell=False)
        return [row.output(self.results(row.entry.row)) for row in sorted(done, key=Done.order)]

    def forget(self) -> None:
        """Forget what the state does not know."""
        self._sensors, self._comparison = {}, Comparison(self.reference, self.state)

    def _waiting(self) -> list[Sensor]:
        """Sensors with rows that wait for later ones."""
        ids = self.state.fact("waiting") or []
        for id_ in ids:
            self._known(id_)
        return [sensor for id_ in ids if (sensor := self._sensors[id_])]

    def _corrected(
        self, released: Sequence[tuple[Sensor, range]], *, tell: bool = True
    ) -> tuple[list[Done], Told]:
        """Correct rows of windows: sensors of one model together, unless marks look at the rows around."""
        alone = [(sensor, rows) for sensor, rows in released if sensor.context]
        together: dict[int, list[tuple[Sensor, range]]] = {}
        for sensor, rows in released:
            if not sensor.context:
                together.setdefault(id(sensor.model), []).append((sensor, rows))
        done: list[Done] = []
        told: Told = []
        for parts in [*([one] for one in alone), *together.values()]:
            entries = [(sensor, entry) for sensor, _ in parts for entry in sensor.window]
            model = parts[0][0].model
            results = correct([entry for _, entry in entries], model, self._reader, self._reading)
            at = 0
            for sensor, rows in parts:
                done += [_done(sensor, place, results, at + place) for place in rows]
                at += len(sensor.window)
            told += self._news(model, entries, results) if tell else []
        return done, told

    def _news(self, model: Model, entries: Sequence[tuple[Sensor, Entry]], results: Results) -> Told:
        """Notes on a correction, each once for a model."""
        known = self.state.fact("notes") or []
        found = []
        for text, first in results.notes.items():
            if [model.hash, text] not in known:
                sensor, entry = entries[first]
                known.append([model.hash, text])
                found.append((entry.place, Event("note", sensor.id, None, 0, text)))
        if found:
            self.state.set_fact("notes", known)
        return found

    def _finished(
        self, done: list[Done], told: Told, sensors: Sequence[Sensor]
    ) -> tuple[list[Row], list[Event]]:
        """Test corrected rows, and keep everything."""
        done.sort(key=Done.order)
        self._comparison.give(done)
        own: dict[str, list[Done]] = {sensor.id: [] for sensor in sensors}
        for row in done:
            if row.sensor is not None:
                own[row.sensor.id].append(row)
        for sensor in sensors:
            before = sensor.ignored
            told += sensor.test(own[sensor.id], self)
            self.ignored += sensor.ignored - before
            self.state.forget_rows(sensor.id, sensor.rows - self.settings.kept)
        self._comparison.keep(done)
        self.corrected += sum(math.isfinite(row.distance) for row in done)
        self._keep(sensors)
        told.sort(key=lambda one: one[0])
        return [row.output(self.results(row.entry.row)) for row in done], [event for _, event in told]

    def _keep(self, sensors: Sequence[Sensor]) -> None:
        before = self.state.fact("waiting") or []
        ids = dict.fromkeys(before)
        for sensor in sensors:
            self.state.keep(sensor.id, sensor.to_dict())
            ids.pop(sensor.id, None)
            if len(sensor.window) > sensor.done:
                ids[sensor.id] = None
        if list(ids) != before:
            self.state.set_fact("waiting", list(ids))

    def keep(self, sensor: Sensor, row: Waiting, time: float) -> None:
        """Keep a row that is tested, by the time of the test [s]; see `Host`."""
        kept = dict(row.row)
        if sensor.dated:
            kept["time"] = str(np.datetime64(round(time * 1e9), "ns")) + "Z"
        elif self.interval is None:
            kept["time_s"] = time
        self.state.add_rows(sensor.id, [(row.number, time, kept)])

    def farthest(self, row: Waiting, since: float) -> str | None:
        """The sensor of a target that has moved farthest until a row of one of them; see `Host`."""
        return self._comparison.farthest(row, since)

    def diagnosed(self, sensor: Sensor, row: Waiting) -> Event | None:
        """Run the diagnosis on the rows up to this one; see `Host`."""
        assert sensor.follow is not None
        after = row.number - self.settings.kept
        rows = self.state.rows_between(sensor.id, sensor.follow["from"], after, row.number)
        names = {name for one in rows for name in one}
        options = self._reading.given()
        options.pop("missing", None)
        asked = {**self._reading.requests, **sensor.requests, "time": "time", "time_s": "time_s"}
        away = [name for name in (self.by, self.reference.same_target, "topic") if name]
        columns = {**asked, **dict.fromkeys(away, "ignore")}
        held = {name: said for name, said in columns.items() if name in names}
        options["columns"] = mounted_as(held, sensor.model)
        options["trust"] = [name for name in self._reading.trust if name in names]
        if self.reference.kind == "distance":
            options["reference_distance"] = self.reference.reference_distance
        options["constant_distance"] = self.reference.kind == "constant"
        return verdict.told(sensor, rows, row, options)

    def _id(self, row: Row, why: str) -> str | None:
        """Id of the sensor of a row; None where it has none, or its fields cannot be told apart."""
        return "" if self.by is None else (not why and _id_of(row.get(self.by))) or None

    def _known(self, id_: str) -> list[Event]:
        """A sensor's state, on its first row: that of a former watch, or a new one."""
        if id_ in self._sensors:
            return []
        self._sensors[id_] = None
        try:
            model = self.models(id_)
            why = "" if model is None or not self.own_models else unwatchable(model)
        except EchocalError as error:
            if not self.own_models:
                raise
            model, why = None, str(error)
        if why:
            return [Event("note", id_, None, 0, f"{why}; its rows are passed on without correction")]
        if model is None:
            needed = f"{keyword('models')} needs a file NAME.json"
            sentence = f"no model: its rows are passed on without correction; {needed}"
            return [Event("note", id_, None, 0, sentence)]
        notes = []
        if model.campaign_effects:
            named = ", ".join(model.campaign_effects)
            sentence = f"the model has {named}, of the campaign that it was found in; the watch leaves it out"
            notes.append(Event("note", id_, None, 0, sentence))
            model = model.transferable()
        sensor = Sensor(id_, model, self.settings, self.reference.kind, self.interval, self.mark_rows)
        if sensor.context:
            notes.append(Event("note", id_, None, 0, _waits(sensor.context)))
        kept = self.state.sensor(id_)
        if kept is not None:
            sensor.restore(kept)
            for entry in sensor.window:
                entry.read(self._reader, model)
            notes = []
        self._sensors[id_] = sensor
        return notes

    def _check(self, rows: Sequence[Row], units: Units) -> list[Event]:
        """Refuse, on the first rows, what no test is possible with; tell it where rows are of many kinds."""
        if self._checked:
            return []
        self._checked = True
        if self.state.fact("begun"):
            return []
        names = list(dict.fromkeys(name for row in rows for name in row))
        try:
            if self.by is not None and not any(_id_of(row.get(self.by)) for row in rows):
                where = f"in the column '{self.by}' of {keyword('by')}{among(self.by, names)}"
                raise DataError(f"a row has no sensor id {where}")
            known = {name for row in rows for name in self._reader.columns(list(row), units).plan.assignments}
            asked = [(name, column) for name, own in self._named.items() for column in own if column]
            refuse_columns(names, asked, known, self.results(rows[0]), self.reference, self.interval)
            self._refuse_no_echo(rows[0], units)
        except (DataError, UsageError) as error:
            if not self.mixed:
                raise
            return [Event("note", "", None, 0, str(error))]
        self.state.set_fact("begun", True)
        return []

    def _refuse_no_echo(self, row: Row, units: Units) -> None:
        columns = self._reader.columns(list(row), units)
        if not columns.has_echo:
            from echocal.observations import read_observations

            requests = columns.requests
            read_observations({name: [1.0] for name in row}, requests)  # it says what could be one
            raise DataError(NO_ECHO)


def _done(sensor: Sensor, place: int, found: Results, at: int) -> Done:
    entry = sensor.window[place]
    last = sensor.window[min(place + sensor.context, len(sensor.window) - 1)]
    distance, uncertainty, level = (
        float(own[at]) for own in (found.distance, found.uncertainty, found.level)
    )
    return Done(entry, sensor, found.status[at], distance, uncertainty, level, last.place)


def _id_of(field: Any) -> str:
    """Id of a sensor as text; empty for what is none."""
    known = isinstance(field, str | int | float | np.generic) and not isinstance(field, bool | np.bool_)
    return label(field) if known else ""


def _waits(context: int) -> str:
    return (
        f"the marks of its model look at {context} rows before and after a row: a row comes out when "
        f"{context} rows have come after it, or when the watch ends; {keyword('mark_rows', False)}: at once, "
        "without marks"
    )
