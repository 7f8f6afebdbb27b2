"""Correct rows: the one place where a correction is computed, for a table and for a part of one."""

import warnings
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from echocal.arrays import Column
from echocal.budget.entries import some_rows
from echocal.budget.stated import Uncertainties
from echocal.correct.needed import Needed, is_derived, reference_of, trusted, with_marks
from echocal.correct.results import DISTANCE, LEVEL
from echocal.correct.uncertainty import included, standard_uncertainty
from echocal.errors import DataWarning
from echocal.model import Model
from echocal.model.indicated_speed import speed_of
from echocal.observations import Observations
from echocal.observations.assembly import Assembly
from echocal.observations.at import conditions_at, sentences, uncertainties_of
from echocal.observations.correction import base_indication, corrected_distance, outside_smooth
from echocal.observations.marks import MARKS
from echocal.observations.mount import holds_level, level_zero
from echocal.observations.numbers import Missing, to_numbers
from echocal.observations.options import ReadOptions
from echocal.observations.part import Part
from echocal.observations.plan import make

_NONE = "no distance fits"


@dataclass(frozen=True, kw_only=True)
class Reading(ReadOptions):
    """How the rows of a table are read and corrected."""

    mark_rows: bool = True
    uncertainties: Uncertainties = field(default_factory=Uncertainties)

    @property
    def first(self) -> str:
        """Name of the first result."""
        return LEVEL if any(holds_level(name, own) for name, own in self.requests.items()) else DISTANCE

    @classmethod
    def of(
        cls, options: Mapping[str, Any], uncertainties: Sequence[str] | Mapping[str, float], mark_rows: bool
    ) -> "Reading":
        """With the uncertainties that a user states of values and of conditions that nobody recorded."""
        own = cls(**options, mark_rows=mark_rows)
        given = Uncertainties.of(uncertainties)
        stated = {**uncertainties_of(own.at or {}), **given.stated}
        return replace(own, uncertainties=replace(given, stated=stated))


@dataclass(frozen=True)
class Rows:
    """Corrected rows."""

    distance: NDArray[np.float64]  # [m]; NaN where there is none; shape (n,)
    uncertainty: NDArray[np.float32]
    """Its standard uncertainty [m]; NaN where there is none, or none was stated; shape (n,)."""
    codes: NDArray[np.int16]  # position of the reason in `reasons`; 0 is none; shape (n,)
    reasons: tuple[str, ...]  # the first one is empty
    unusable: tuple[bool, ...]  # whether rows with that reason have no distance
    notes: tuple[str, ...]  # what a person should know
    first: str = DISTANCE
    """Name of the first result: a level is corrected to a level."""
    outside: Mapping[str, tuple[int, int, float]] = field(default_factory=dict)
    """Rows outside of the domain of a law; see `echocal.domain.counting`."""
    zero: float = 0.0
    """Height above the zero of a level [m] from which a distance counts down; 0 where there is no level."""

    def lost(self, where: NDArray[np.bool_], reason: str) -> "Rows":
        """The same without some rows, for a reason that comes before all others."""
        return replace(
            self,
            distance=np.where(where, np.nan, self.distance),
            uncertainty=np.where(where, np.float32(np.nan), self.uncertainty),
            codes=np.where(where, np.int16(len(self.reasons)), self.codes),
            reasons=(*self.reasons, reason),
            unusable=(*self.unusable, True),
        )

    def cut(self, begin: int, end: int) -> "Rows":
        """Some of the rows."""
        if (begin, end) == (0, len(self.codes)):
            return self
        part = slice(begin, end)
        return replace(
            self, distance=self.distance[part], uncertainty=self.uncertainty[part], codes=self.codes[part]
        )


def correct_rows(
    table: pd.DataFrame,
    model: Model,
    needed: Needed,
    reading: Reading,
    part: Part | None = None,
    groups: Sequence[tuple[Model, slice]] = (),
) -> Rows:
    """Correct every row of a table, or of a part of one, that has the needed columns.

    Raises `DataError` if the columns cannot be read, or the model needs another one. What a `part` counts is
    added to it. The models of `groups` are of some rows each; they read the same columns in the same way as
    `model`, and have neither terms without a cause nor rules for rows.
    """
    observations, assembly = _observed(table, model, needed, reading, part)
    if groups:
        base_indication(observations, model.law)  # counts rows outside of the domain of the law
    each = [(own, rows, some_rows(observations, rows)) for own, rows in groups]
    each = each or [(model, slice(None), observations)]
    distance, uncertainty = np.empty(len(observations)), np.empty(len(observations), np.float32)
    for own, rows, some in each:
        distance[rows] = corrected_distance(some, own)
    distance[distance < 0.0] = np.nan  # a number that solves the equation, and no distance
    status = _Status(assembly)
    status.give(np.isnan(distance), _NONE)
    for column in model.columns.values():
        status.give(np.isnan(observations.thermometers[column]), f"{column} missing", over=_NONE)
    notes = (*observations.notes, *filter(None, [included(model, reading.uncertainties)]))
    if reading.mark_rows and MARKS in model.provenance:
        asked = {**needed.requests, **needed.reference}
        asked = {name: own for name, own in asked.items() if own}
        missing = _of(reading.missing, needed.columns)
        read = table[list(needed.columns)]
        reference = reference_of(read, asked, missing, model) if needed.reference else None
        distance, faults, more = with_marks(observations, distance, reference, model)
        for fault in dict.fromkeys(faults[faults != ""].tolist()):
            status.give(faults == fault, fault)
        notes = (*notes, *more)
    unusable = len(status.reasons)
    outside = outside_smooth(observations, model) if model.shape is not None else None
    for mark in [] if outside is None else dict.fromkeys(outside[outside != ""].tolist()):
        status.give(outside == mark, mark)
    usable = [place == 0 or place >= unusable for place in range(len(status.reasons))]
    for own, rows, some in each:
        uncertainty[rows] = standard_uncertainty(some, own, distance[rows], reading.uncertainties)
    zero = level_zero(assembly.plan, model) if reading.first == LEVEL else 0.0
    if reading.first == LEVEL:
        distance = zero - distance
    return Rows(
        distance,
        uncertainty,
        status.codes,
        tuple(status.reasons),
        tuple(not it for it in usable),
        notes,
        reading.first,
        zero=zero,
    )


def whole_log(table: pd.DataFrame, model: Model, needed: Needed, reading: Reading) -> tuple[Part, Column]:
    """What the parts of a table need to know of the whole: its start and its derived quantities.

    Returns also the seconds since the start, shape (n,), NaN where a row has no time or the table has none.
    Raises `DataError` if the table cannot be read as a whole.
    """
    observations, assembly = _observed(table, model, needed, reading, None)
    derived = {name: values for name, values in observations.conditions.items() if is_derived(name)}
    elapsed = observations.conditions.get("elapsed_time", np.full(len(table), np.nan))
    start: np.datetime64 | float | None = None
    if assembly.time is not None and not np.isnat(assembly.time).all():
        start = assembly.time[~np.isnat(assembly.time)].min()
    elif "elapsed_time" in assembly.plan.assignments:
        source = assembly.plan.assignments["elapsed_time"]
        values = source.unit.to_si(to_numbers(table[source.column], source.column, assembly.missing))
        start = float(np.min(values, where=np.isfinite(values), initial=np.inf))
    return Part(start, derived), elapsed


def no_distance(count: int, reason: str = "", first: str = DISTANCE) -> Rows:
    """Rows without a result, for a reason or none."""
    nothing = np.full(count, np.nan)
    codes = np.full(count, bool(reason), dtype=np.int16)
    reasons = ("", reason) if reason else ("",)
    lost = tuple(map(bool, reasons))
    return Rows(nothing, nothing.astype(np.float32), codes, reasons, lost, (), first)


def _observed(
    table: pd.DataFrame, model: Model, needed: Needed, reading: Reading, part: Part | None
) -> tuple[Observations, Assembly]:
    trust = trusted(reading.trust, needed.columns)
    missing = Missing(_of(reading.missing, needed.columns))
    columns = list(needed.columns)
    read = table if table.columns.tolist() == columns else table[columns]  # looking names up takes a while
    if reading.at:
        read = read.copy()
        stated = conditions_at(reading.at, read)
    plan = make(list(read.columns), needed.requests, trust)
    assembly = Assembly(read, plan, missing, trust, reading.time_zone, part, reading.time_format)
    if reading.at:
        assembly.notes += sentences(stated)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", DataWarning)  # the notes say the same
        return assembly.observations(speed_of(model, reading.reading_speed)), assembly


class _Status:
    """Reason codes of rows; the first reason stays."""

    def __init__(self, assembly: Assembly) -> None:
        self.reasons = list(dict.fromkeys(assembly.reasons))
        places = np.array([self.reasons.index(reason) for reason in assembly.reasons], dtype=np.int16)
        self.codes: NDArray[np.int16] = places[assembly.reason] if len(places) > 1 else assembly.reason.copy()

    def give(self, where: NDArray[np.bool_], reason: str, over: str | None = None) -> None:
        if not where.any():
            return
        free = self.codes == 0
        if over in self.reasons:
            free |= self.codes == self.reasons.index(str(over))
        rows = where & free
        if rows.any():
            if reason not in self.reasons:
                self.reasons.append(reason)
            self.codes[rows] = self.reasons.index(reason)


def _of(missing: Any, columns: Collection[str]) -> Any:
    """Error codes of columns that are read."""
    if not isinstance(missing, Mapping):
        return missing
    return {name: codes for name, codes in missing.items() if name in ("", *columns)}
