"""Correct and test the rows of many sensors as they come."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from echocal.errors import DataError
from echocal.model.indicated_speed import speed_of
from echocal.observations import Observations
from echocal.watch import verdict
from echocal.watch.events import Event
from echocal.watch.reference import Models, Reference, refuse_columns
from echocal.watch.rows import Block, Reader, Row
from echocal.watch.sensor import Sensor
from echocal.watch.settings import WatchSettings
from echocal.watch.signatures import unwatchable
from echocal.watch.state import State
from echocal.watch.target import Target

__all__ = ["RESULTS", "Fleet"]

RESULTS = ("corrected_distance_m", "status")
"""Names of the two columns that are appended."""

Column = NDArray[np.float64]


@dataclass
class _Found:
    """Results of a batch, by row: reason code, distance, time, reference; and by sensor, what was read."""

    status: list[str]
    distance: Column
    times: Column
    reference: Column
    parts: dict[str, list[tuple[NDArray[np.intp], Observations]]] = field(default_factory=dict)


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

    Examples
    --------
    >>> import numpy as np
    >>> import echocal
    >>> from echocal.watch import Fleet, Reference, State, WatchSettings
    >>> device = echocal.Model("linear")
    >>> fleet = Fleet(lambda id_: device, None, Reference(distance=1.0), WatchSettings(), State(None))
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
    rows: int = 0
    corrected: int = 0
    _sensors: dict[str, Sensor | None] = field(default_factory=dict)
    _readers: dict[str, Reader] = field(default_factory=dict)
    _targets: dict[str, Target] = field(default_factory=dict)
    _seen: dict[tuple[str, int], tuple[Target, int]] = field(default_factory=dict)
    _checked: bool = False

    def take(self, rows: Sequence[Row]) -> tuple[list[Row], list[Event]]:
        """Correct rows, and test them: the same rows with two columns more, and what there is to tell.

        Raises
        ------
        DataError
            If the rows lack what every row needs: a sensor's id, a time, something to be compared with.
        """
        if not rows:
            return [], []
        self._check(rows)
        ids = [self._id(row) for row in rows]
        events = [event for id_ in dict.fromkeys(ids) for event in self._known(id_)]
        unread = ["" if self._sensors[id_] else f"no model for sensor {id_}" for id_ in ids]
        blank = np.full(len(rows), np.nan)
        found = _Found(unread, blank, blank.copy(), blank.copy())
        numbers = self._numbers(ids)
        speeds = [speed_of(s.model) if (s := self._sensors[id_]) else None for id_ in ids]
        for speed in dict.fromkeys(one for one in speeds if one is not None):
            places = [p for p, own in enumerate(speeds) if own == speed]
            blocks, reasons = self._reader(speed).read([rows[p] for p in places])
            for place, why in zip(places, reasons, strict=True):
                found.status[place] = why
            for block in blocks:
                of_all = np.array(places, dtype=np.intp)[block.index]
                events += self._correct(replace(block, index=of_all), ids, numbers, found)
        distance, times = found.distance, found.times
        reference = self._references(rows, ids, numbers, distance, times, found.reference)
        events += self._tests(rows, found.parts, distance, reference, times, numbers)
        self._keep_targets(rows)
        self.rows += len(rows)
        self.corrected += int(np.isfinite(distance).sum())
        for id_ in dict.fromkeys(ids):
            if sensor := self._sensors[id_]:
                self.state.keep(id_, sensor.to_dict())
        done: list[Row] = [
            {**row, RESULTS[0]: None if math.isnan(d) else round(d, 9), RESULTS[1]: why}
            for row, d, why in zip(rows, distance.tolist(), found.status, strict=True)
        ]
        return done, sorted(events, key=lambda event: -math.inf if event.time is None else event.time)

    def _correct(self, block: Block, ids: list[str], numbers: list[int], found: "_Found") -> list[Event]:
        """Correct the rows of a block, sensor by sensor; notes on domains that they leave."""
        events = []
        for id_, where, at in _runs(block.index, ids):
            sensor = self._sensors[id_]
            assert sensor is not None
            times = block.time[where]
            if self.interval is not None and np.isnan(times).all():
                times = self.interval * np.array([numbers[p] for p in at.tolist()], dtype=float)
            outside = len(sensor.outside)
            own = replace(block, time=_put(block.time, where, times))
            found.distance[at], reasons, seen = sensor.correct(own, where)
            found.times[at], found.reference[at] = times, block.reference[where]
            for place, reason in zip(at.tolist(), reasons, strict=True):
                found.status[place] = reason
            found.parts.setdefault(id_, []).append((at, seen))
            left = sensor.outside[outside:]
            events += [Event("note", id_, None, 0, f"outside of a domain: {text}") for text in left]
        return events

    def _tests(
        self,
        rows: Sequence[Row],
        parts: Mapping[str, list[tuple[NDArray[np.intp], Observations]]],
        distance: Column,
        reference: Column,
        times: Column,
        numbers: list[int],
    ) -> list[Event]:
        events: list[Event] = []
        for id_, own in parts.items():
            sensor = self._sensors[id_]
            assert sensor is not None
            for at, seen in sorted(own, key=lambda part: int(part[0][0])):
                places = at.tolist()
                kept = [
                    (numbers[p], times[p], self._with_reference(rows[p], reference[p]))
                    for p in places
                    if np.isfinite(distance[p]) and np.isfinite(reference[p]) and np.isfinite(times[p])
                ]
                self.state.add_rows(id_, kept)
                of_rows = [numbers[p] for p in places]
                events += sensor.test(
                    distance[at],
                    reference[at],
                    times[at],
                    seen,
                    of_rows,
                    self._diagnosed,
                    self._farthest,
                )
            self.state.forget_rows(id_, sensor.rows - self.settings.kept)
        return events

    def _with_reference(self, row: Row, reference: float) -> Row:
        return {**row, "distance_m": reference} if self.reference.kind == "others" else row

    def _references(
        self,
        rows: Sequence[Row],
        ids: list[str],
        numbers: list[int],
        distance: Column,
        times: Column,
        given: Column,
    ) -> Column:
        """Reference distance of each row [m]; NaN where there is none."""
        if self.reference.kind == "distance":
            return np.full(len(rows), float(self.reference.distance or 0.0))
        if self.reference.kind == "constant":
            return distance
        if self.reference.kind != "others":
            return given
        found = np.full(len(rows), np.nan)
        for place, row in enumerate(rows):
            now, name = float(times[place]), self._target(row)
            if math.isnan(distance[place]) or math.isnan(now) or not name:
                continue
            if name not in self._targets:
                kept = self.state.fact(f"target {name}")
                self._targets[name] = Target() if kept is None else Target.restored(kept)
            target = self._targets[name]
            found[place] = target.add(ids[place], now, float(distance[place]), self.reference.within)
            self._seen[ids[place], numbers[place]] = target, target.rows
        return found

    def _target(self, row: Row) -> str:
        return str(row.get(str(self.reference.target), ""))

    def _farthest(self, id_: str, number: int, since: float) -> str | None:
        """The sensor of a target that has moved farthest until a row of one of them."""
        if (id_, number) not in self._seen:
            return None
        target, row = self._seen[id_, number]
        return target.moved_most(since, row)

    def _keep_targets(self, rows: Sequence[Row]) -> None:
        self._seen = {}
        for name in dict.fromkeys(self._target(row) for row in rows):
            if name in self._targets:
                self._targets[name].forget()
                self.state.set_fact(f"target {name}", self._targets[name].to_dict())

    def _diagnosed(self, sensor: Sensor, time: float, number: int) -> Event | None:
        assert sensor.follow is not None
        after = number - self.settings.kept
        rows = self.state.rows_between(sensor.id, sensor.follow["from"], after, number)
        names = {name for row in rows for name in row}
        options = dict(self.options)
        asked = options.get("columns") or {}
        columns = {name: said for name, said in asked.items() if name in names}
        away = [name for name in (self.by, self.reference.target, "topic") if name in names and name]
        options["columns"] = columns | dict.fromkeys(away, "ignore")
        if self.reference.kind == "distance":
            options["reference_distance"] = self.reference.distance
        options["constant_distance"] = self.reference.kind == "constant"
        return verdict.told(sensor, rows, time, number, options)

    def _id(self, row: Row) -> str:
        if self.by is None:
            return ""
        if self.by not in row or row[self.by] in {None, ""}:
            message = f"a row has no sensor id in the column '{self.by}' of --by; it has {', '.join(row)}"
            raise DataError(message)
        return str(row[self.by])

    def _known(self, id_: str) -> list[Event]:
        """A sensor's state, on its first row: that of a former watch, or a new one."""
        if id_ in self._sensors:
            return []
        model = self.models(id_)
        if model is None:
            self._sensors[id_] = None
            sentence = "no model: its rows are passed on without correction; --models needs a file NAME.json"
            return [Event("note", id_, None, 0, sentence)]
        notes = []
        if model.campaign_effects:
            named = ", ".join(model.campaign_effects)
            sentence = f"the model has {named}, of the campaign that it was found in; the watch leaves it out"
            notes.append(Event("note", id_, None, 0, sentence))
            model = model.transferable()
        if self.own_models and (why := unwatchable(model)):
            self._sensors[id_] = None
            return [Event("note", id_, None, 0, f"{why}; its rows are passed on without correction")]
        sensor = Sensor(id_, model, self.settings, self.reference.kind, self.interval)
        kept = self.state.sensor(id_)
        if kept is not None:
            sensor.restore(kept)
            notes = []
        self._sensors[id_] = sensor
        return notes

    def _numbers(self, ids: list[str]) -> list[int]:
        found = []
        for id_ in ids:
            sensor = self._sensors[id_]
            if sensor is not None:
                sensor.rows += 1
            found.append(0 if sensor is None else sensor.rows)
        return found

    def _reader(self, speed: str) -> Reader:
        if speed not in self._readers:
            ignored = [name for name in (self.by, self.reference.target, "topic") if name]
            own = {name: value for name, value in self.options.items() if value not in (None, "")}
            own["reading_speed"] = own.get("reading_speed") or speed
            self._readers[speed] = Reader(own.pop("columns", None), ignored=ignored, **own)
        return self._readers[speed]

    def _check(self, rows: Sequence[Row]) -> None:
        """Refuse, on the first rows, what no test is possible with."""
        if self._checked:
            return
        self._checked = True
        if self.state.fact("begun"):
            return
        names = list(dict.fromkeys(name for row in rows for name in row))
        asked = dict(self.options.get("columns") or {})
        refuse_columns(names, asked, RESULTS, self.reference, self.interval)
        self.state.set_fact("begun", True)


def _runs(index: NDArray[np.intp], ids: list[str]) -> list[tuple[str, NDArray[np.intp], NDArray[np.intp]]]:
    """Rows of a block by sensor: id, places in the block, places among all rows."""
    own: dict[str, list[int]] = {}
    for where, place in enumerate(index.tolist()):
        own.setdefault(ids[place], []).append(where)
    return [(id_, np.array(where, dtype=np.intp), index[where]) for id_, where in own.items()]


def _put(values: Column, where: NDArray[np.intp], new: Column) -> Column:
    changed = values.copy()
    changed[where] = new
    return changed
