"""Correct the rows of one file, part by part, by one model or by that of each row's key."""

from collections.abc import Collection, Mapping
from dataclasses import dataclass, field, replace

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from echocal.correct.job import Job
from echocal.correct.needed import Needed, needed, refuse_repeated
from echocal.correct.rows import Rows, correct_rows, no_distance, whole_log
from echocal.correct.tables import counts, refuse_corrected
from echocal.domain import counting
from echocal.errors import DataError, among
from echocal.keywords import keyword
from echocal.model import Model
from echocal.model.folder import label
from echocal.model.indicated_speed import speed_of
from echocal.observations.found import NOT_READ
from echocal.observations.hints import completed
from echocal.observations.marks import MARKS
from echocal.observations.misspelled import naming
from echocal.observations.numbers import Missing
from echocal.observations.part import Part, Seen
from echocal.observations.plan import make
from echocal.quantities import QUANTITIES

NO_MODEL = "no model for this key"
_NO_KEY = "no key"


@dataclass(frozen=True)
class Context:
    """What the rows of a part depend on beyond it; see `Part`."""

    start: np.datetime64 | float | None = None
    derived: Mapping[str, NDArray[np.float64]] = field(default_factory=dict)

    def rows(self, begin: int, end: int) -> "Context":
        """That of some rows."""
        return Context(self.start, {name: values[begin:end] for name, values in self.derived.items()})


@dataclass
class Tally:
    """What was counted in the parts of a file."""

    rows: int = 0
    columns: list[str] = field(default_factory=list)
    types: list[str] = field(default_factory=list)
    """Types of the columns; empty for a text, which has none."""
    unusable: dict[str, int] = field(default_factory=dict)
    marked: dict[str, int] = field(default_factory=dict)
    first: dict[str, int] = field(default_factory=dict)
    notes: dict[str, None] = field(default_factory=dict)
    outside: dict[str, tuple[int, int, float]] = field(default_factory=dict)
    seen: dict[str, Seen] = field(default_factory=dict)
    disagreeing: list[int] = field(default_factory=lambda: [0, 0])

    def add(self, rows: Rows, parts: Collection[Part]) -> None:
        """Add a part; the parts come in the order of the rows."""
        for kind, found in zip((self.unusable, self.marked), counts(rows), strict=True):
            for reason, (count, first) in found.items():
                kind[reason] = kind.get(reason, 0) + count
                self.first.setdefault(reason, self.rows + first + 1)
        self.notes |= dict.fromkeys(rows.notes)
        for domain, (count, first, value) in rows.outside.items():
            before, place, shown = self.outside.get(domain, (0, self.rows + first + 1, value))
            self.outside[domain] = before + count, place, shown
        for part in parts:
            for column, seen in part.seen.items():
                self.seen.setdefault(column, Seen()).__iadd__(seen)
            for place, count in enumerate(part.disagreeing):
                self.disagreeing[place] += count
        self.rows += len(rows.codes)

    def doubtful(self, job: Job) -> bool:
        """Whether the whole columns must be looked at: one may have no value, or be in another unit."""
        apart, known = self.disagreeing
        looked_at = (
            seen for seen in self.seen.values() if seen.finite or seen.damage.count or not job.several
        )
        return any(seen.doubtful for seen in looked_at) or 2 * apart > known


class Corrector:
    """Corrects the rows of a table that comes in parts.

    Raises `DataError` if the table was corrected before, or lacks the column of the key. `key` is that of
    all rows; None: each row has its own, in the column `Models.by`.
    """

    def __init__(self, names: Collection[str], job: Job, key: str | None = None) -> None:
        refuse_repeated(names)
        refuse_corrected(names)
        Missing(job.reading.missing).refuse_unknown(names)
        requests = completed(names, job.reading.requests_of(names))[0]
        job = replace(job, reading=replace(job.reading, columns=requests, mount_height=None))
        self._names, self._job = list(names), job
        self.key = "" if job.models.folder is None else key
        self.by = job.models.by if self.key is None else ""
        if self.by and self.by not in self._names:
            message = f"there is no column '{self.by}' with the key of a row{among(self.by, self._names)}"
            raise DataError(message)
        self._needed: dict[str, Needed] = {}
        if self.key is not None:
            self.prepare([self.key])

    def prepare(self, keys: Collection[str]) -> None:
        """Find what the models of some keys read."""
        for key in keys:
            model = self._job.models.model(key)
            if key not in self._needed and model is not None:
                reading = self._job.reading
                requests = {name: own for name, own in self._job.reading.requests.items() if name != self.by}
                self._needed[key] = needed(
                    [name for name in self._names if name != self.by],
                    model,
                    requests,
                    reading_speed=reading.reading_speed,
                    trust=reading.trust,
                    mark_rows=reading.mark_rows,
                    ordered=self._job.several and self._job.logs != "file",
                )

    @property
    def columns(self) -> tuple[str, ...]:
        """Columns to read, for the keys that are prepared."""
        wanted = {name for own in self._needed.values() for name in own.columns}
        return tuple(name for name in self._names if name in wanted or name == self.by)

    @property
    def reads(self) -> tuple[object, ...]:
        """What is read of a log, and how: the same for correctors that find the same in it."""
        models = (self._job.models.model(key) for key in self._needed)
        hashes = tuple(model.hash for model in models if model is not None)
        return self.columns, hashes, repr(self._job.reading)

    @property
    def remembers(self) -> tuple[str, ...]:
        """What of the models depends on other rows of the log."""
        return tuple(dict.fromkeys(name for own in self._needed.values() for name in own.remembers))

    @property
    def rows_around(self) -> int:
        """Rows before and after a row that its marks depend on."""
        return max((own.rows_around for own in self._needed.values()), default=0)

    def whole_log(self, table: pd.DataFrame) -> tuple[Context, NDArray[np.float64]]:
        """What the parts of a log need to know of it, and the time of each row since its start [s]."""
        keys = [str(self.key)] if not self.by else list(self._needed)
        model = self._job.models.model(keys[0])
        assert model is not None  # a log of one key, whose model depends on other rows
        part, elapsed = whole_log(table, model, self._needed[keys[0]], self._job.reading)
        return Context(part.start, part.derived), elapsed

    def correct(
        self, table: pd.DataFrame, context: Context, own: tuple[int, int], whole: bool = False
    ) -> tuple[Rows, list[Part]]:
        """Correct a part of a table, and return its own rows, without those of its neighbors."""
        rows, parts = self._all(table, context, whole, slice(*own))
        for reason in table[NOT_READ].dropna().unique() if NOT_READ in table else ():
            rows = rows.lost(table[NOT_READ].eq(reason).to_numpy(), reason)
        return rows.cut(*own), parts

    def _all(
        self, table: pd.DataFrame, context: Context, whole: bool, counted: slice
    ) -> tuple[Rows, list[Part]]:
        if not self.by:
            return self._of_models([(str(self.key), len(table))], table, context, whole, counted)
        places, keys = pd.factorize(table[self.by])
        named = np.array([*(label(key) for key in keys.tolist()), ""], dtype=object)
        places, distinct = pd.factorize(named[places])
        labels = [str(key) for key in distinct]
        self.prepare(labels)
        if self.remembers and self._job.several and self._job.logs != "file":
            raise DataError(
                f"the model of this sensor has {', '.join(self.remembers)}, which depends on the other rows "
                f"of a log, and a log may have several files: write one folder for each sensor "
                f"({self.by}=...), or say that each file is a whole log: {keyword('logs', 'file')}"
            )
        if (self.remembers or self.rows_around) and len(labels) > 1:
            raise DataError(
                f"several sensors are in this file, and their models have "
                f"{', '.join(self.remembers) or 'marks'}, which depends on the other rows of a log; "
                f"write one file for each {self.by}"
            )
        rows_of = np.split(np.argsort(places, kind="stable"), np.cumsum(np.bincount(places))[:-1])
        alike: dict[object, list[int]] = {}
        for place, key in enumerate(labels):
            alike.setdefault(self._reads_as(key), []).append(place)
        found, orders, parts = [], [], []
        for group in alike.values():
            rows = np.concatenate([rows_of[place] for place in group])
            sizes = [(labels[place], len(rows_of[place])) for place in group]
            some = table.iloc[rows].reset_index(drop=True)
            own, part = self._of_models(sizes, some, context, whole, counted)
            found.append(own)
            orders.append(rows)
            parts += part
        return _scattered(found, orders), parts

    def _reads_as(self, key: str) -> object:
        """Keys for which this is the same are read together."""
        model = self._job.models.model(key)
        if model is None:
            return bool(key)
        if model.shape is not None or MARKS in model.provenance:
            return key
        own = self._needed[key]
        bare = bool(model.effects)
        return (
            model.law,
            speed_of(model),
            own.columns,
            own.assumed,
            own.remembers,
            tuple(model.columns.items()),
            bare,
        )

    def _of_models(
        self, sizes: list[tuple[str, int]], table: pd.DataFrame, context: Context, whole: bool, counted: slice
    ) -> tuple[Rows, list[Part]]:
        """Correct rows of some keys, one after the other, whose models read the same."""
        key = sizes[0][0]
        model = self._job.models.model(key)
        if model is None:
            reason = NO_MODEL if key else _NO_KEY
            return no_distance(len(table), reason, self._job.reading.first), []
        groups: list[tuple[Model, slice]] = []
        at = 0
        for own, count in sizes if len(sizes) > 1 else []:
            groups.append((self._job.models.model(own) or model, slice(at, at + count)))
            at += count
        part = None if whole else Part(context.start, context.derived, counted)
        with naming(self._names), counting() as outside:
            rows = correct_rows(table, model, self._needed[key], self._job.reading, part, groups)
        if self._job.round_m is not None:
            step = self._job.round_m
            rows = replace(rows, distance=np.round(rows.distance / step) * step)
        notes = (*rows.notes, *self._assumptions(key, model))
        return replace(rows, notes=notes, outside=outside), [] if part is None else [part]

    def _assumptions(self, key: str, model: Model) -> list[str]:
        """What is assumed of the air where the table does not say it."""
        said = [
            f"{name.replace('_', ' ')} is not recorded: {QUANTITIES[name].default:g} "
            f"{QUANTITIES[name].unit} is assumed".replace(" 1 is", " is")
            + (" (dry air)" if name == "relative_humidity" else "")
            for name in self._needed[key].assumed
            if name != "co2_mole_fraction"  # 0.04 % in any air outdoors
        ]
        readings = {"reading"} & {*self._read(key)} and "echo_time" not in self._read(key)
        if readings and self._job.reading.reading_speed is None:
            if (speed := speed_of(model)) != model.law:
                said.append(
                    f"the readings are taken to be made with the speed '{speed}', as in the diagnosis of the "
                    f"model; if the firmware used another: {keyword('reading_speed', 343)}"
                )
            elif not model.effects and model.shape is None:
                said.append(
                    f"the readings are taken to be made with the law '{model.law}' itself, and the model "
                    "has no effect: the distances are the readings again; if the firmware used a fixed "
                    f"speed, say so: {keyword('reading_speed', 343)}"
                )
            else:
                said.append(
                    f"the readings are taken to be made with the speed '{model.law}' of the model; "
                    f"if the firmware used another: {keyword('reading_speed', 343)}"
                )
        return said

    def _read(self, key: str) -> Collection[str]:
        own = self._needed[key]
        return make(list(own.columns), own.requests).assignments


def _scattered(found: list[Rows], orders: list[NDArray[np.intp]]) -> Rows:
    """Rows of several keys in the order of the table."""
    if not found:
        return no_distance(0)
    reasons: dict[str, bool] = {"": False}
    for rows in found:
        for reason, lost in zip(rows.reasons, rows.unusable, strict=True):
            reasons.setdefault(reason, lost)
    places = {reason: place for place, reason in enumerate(reasons)}
    codes = [np.array([places[r] for r in rows.reasons], np.int16)[rows.codes] for rows in found]
    back = np.argsort(np.concatenate(orders), kind="stable")
    outside: dict[str, tuple[int, int, float]] = {}
    for rows, order in zip(found, orders, strict=True):
        for domain, (count, first, value) in rows.outside.items():
            seen = outside.get(domain, (0, len(back), value))
            here = min((seen[1], seen[2]), (int(order[first]), value))
            outside[domain] = (seen[0] + count, *here)
    return Rows(
        np.concatenate([rows.distance for rows in found])[back],
        np.concatenate([rows.uncertainty for rows in found])[back],
        np.concatenate(codes)[back],
        tuple(reasons),
        tuple(reasons.values()),
        tuple(dict.fromkeys(note for rows in found for note in rows.notes)),
        found[0].first,
        outside,
    )
