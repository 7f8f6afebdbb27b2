"""Assemble observations from the columns of a table."""

from collections import Counter
from collections.abc import Callable, Collection, Mapping
from dataclasses import dataclass, field

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from echocal.arrays import Column, Labels, Mask
from echocal.errors import DataError
from echocal.keywords import keyword
from echocal.model import Model
from echocal.observations import checks, clock, labels
from echocal.observations.advice import no_echo, which_temperature
from echocal.observations.alike import line_between
from echocal.observations.derived import derived
from echocal.observations.echoes import FirmwareSpeed, disagreeing
from echocal.observations.fields import row, rows, shown
from echocal.observations.level import BESIDE, refuse_level, refuse_unit
from echocal.observations.mount import mount_height, refuse_unmounted
from echocal.observations.numbers import Missing, to_numbers
from echocal.observations.part import Part
from echocal.observations.plan import EVERYTHING, Assignment, Plan
from echocal.observations.table import Observations
from echocal.observations.units import FORMS
from echocal.quantities import QUANTITIES


@dataclass
class Assembly:
    """Columns on their way to observations."""

    table: pd.DataFrame
    plan: Plan
    missing: Missing
    trusted: Collection[str]
    time_zone: str
    part: Part | None = None
    time_format: str | None = None
    reasons: list[str] = field(init=False, default_factory=lambda: [""])
    reason: NDArray[np.int16] = field(init=False)
    notes: list[str] = field(init=False, default_factory=list)
    time: clock.Instants | None = field(init=False, default=None)
    reading_speed: str = field(init=False, default="")
    refused: dict[str, str] = field(init=False, default_factory=dict)

    def __post_init__(self) -> None:
        self.reason = np.zeros(len(self.table), dtype=np.int16)

    def observations(self, reading_speed: str | float | None) -> Observations:
        """Put everything together; `reading_speed` as in `echocal.read_observations`."""
        held = self.plan.assignments
        refuse_unmounted(self.plan)
        if not {"echo_time", "reading"} & set(held):
            raise DataError(no_echo(self.table, self.plan))
        order = dict.fromkeys(form.quantity for form in FORMS if not form.label)
        values = {quantity: self._values(quantity) for quantity in order if quantity in held}
        conditions = {name: values[name] for name in QUANTITIES if name in values}
        echo_time = self._echo_time(values, conditions, reading_speed)
        self._note_lookalikes()
        self._refuse_level(values, echo_time)
        self._summarize()
        named = {name: self._labels(name) for name in ("stand", "group", "order") if name in held}
        extra, texts = self._extra()
        extra = self._without_copies(extra, {**values, "echo_time": echo_time})
        more = derived(conditions, named) if self.part is None else self.part.derived
        hour = {} if self.time is None else {"hour_angle": clock.hour_angle(self.time, self.time_zone)}
        return Observations(
            echo_time=echo_time,
            conditions={**conditions, **more, **hour},
            reference_distance=values.get("reference_distance"),
            unusable=self._unusable(),
            reading=values.get("reading"),
            time=self.time,
            labels={**texts, **named},
            extra=extra,
            thermometers=self._thermometers(),
            reading_speed=self.reading_speed,
            source_names={name: source.column for name, source in held.items()},
            notes=tuple(self.notes),
            refused=self.refused,
            mount_height=mount_height(self.plan),
        )

    def _refuse_unit_of_level(self, values: Mapping[str, Column], echo_time: Column) -> None:
        """Refuse a level, of a given height, in another unit than the distance beside it."""
        held = self.plan.assignments
        for name, names in BESIDE.items():
            own, other = held.get(name), next((held[one] for one in names if one in held), None)
            if own is None or other is None or not own.form.level or self.part is not None:
                continue
            if own.column not in self.trusted:
                beside = values.get(other.form.quantity, echo_time)
                refuse_unit(values[name], beside, self.reason == 0, own, other)

    def _refuse_level(self, values: Mapping[str, Column], echo_time: Column) -> None:
        """Refuse a level in place of the reference distance, which only a whole table shows."""
        self._refuse_unit_of_level(values, echo_time)
        source = self.plan.assignments.get("reference_distance")
        if source is None or source.form.level or self.part is not None or source.column in self.trusted:
            return  # no fault of a column explains a level: it is refused where all others are trusted
        usable = self.reason == 0
        refuse_level(
            values["reference_distance"], values.get("reading"), echo_time, usable, source.column, source.name
        )

    def _values(self, quantity: str) -> Column:
        """Values of a quantity [SI]; rows without one, or with an impossible one, are marked."""
        source = self.plan.assignments[quantity]
        if source.name == "time":
            given = self.table[source.column]
            zone = clock.zone_of(source.column, self.time_zone)
            if zone != self.time_zone:
                self.notes.append(f"the times are those of UTC{zone}, as the name '{source.column}' says")
                self.time_zone = zone
            self.time, outside = clock.instants(given, source.column, self.time_zone, self.time_format)
            unset = np.zeros(len(outside), dtype=np.bool_) if self.part else clock.not_set(self.time)
            self.time = np.where(unset, np.datetime64("NaT"), self.time)
            values = clock.elapsed(self.time, None if self.part is None else self.part.start)
            self._mark(outside, f"{source.column} out of range", source)
            self._mark(unset, f"{source.column} before 1990", source)
            self._check_filled(np.where(outside | unset, np.inf, values), source)
            if self.part is None:
                for first in np.flatnonzero(outside)[:1]:
                    self.notes.append(
                        f"{source.column} has no time of the years {clock.YEARS[0]} to {clock.YEARS[1]} in "
                        f"{rows(outside.sum())}, first at {row(first)}: {given.iloc[first]}"
                    )
                self.notes += self._order(values, source)
            return values
        checks.refuse_truth(self.table[source.column], source)
        values = self._numbers(source.column, source)
        self._check_filled(values, source)
        seen = checks.ends(values)
        wrong, notes = checks.impossible(values, seen, source)
        if self.part is None:
            trusted = [name for name in self.trusted if name != EVERYTHING]
            self._refuse_or_keep(source, checks.refuse_other_unit, values, seen, source, trusted)
            self.notes += [*checks.suspected_codes(values, seen, source), *notes]
        else:
            self.part.count(source, values, seen)
        self._mark(wrong, f"{source.column} out of range", source)
        values = source.unit.to_si(values)
        if quantity == "elapsed_time":
            if self.part is None and source.column not in self.trusted:
                self._refuse_or_keep(source, clock.refuse_other_clock, values, source)
            values = self._since_start(values)
            if self.part is None:
                self.notes += self._order(values, source)
        return values

    def _order(self, values: Column, source: Assignment) -> list[str]:
        bursts = bool({"group", "order"} & set(self.plan.assignments))
        return clock.said_of_order(values, source, bursts=bursts)

    def _numbers(self, column: str, source: Assignment | None = None) -> Column:
        """Numbers of a column; a few texts in it make their rows unusable."""
        corrupt: list[int] = []
        values = to_numbers(
            self.table[column], column, self.missing, corrupt, part=bool(self.part and source)
        )
        if corrupt and source is not None:
            where = np.zeros(len(values), dtype=np.bool_)
            where[corrupt] = True
            self._mark(where, f"{column} is no number", source)
        if self.part is not None:
            self.part.count_damage(column, self.table[column], corrupt)
        elif corrupt:
            text = shown(str(self.table[column].iloc[corrupt[0]]))
            self.notes.append(
                f"{column} has text in place of a number in {rows(len(corrupt))}, "
                f"first at {row(corrupt[0])}: '{text}'"
            )
        return values

    def mark_corrupt(self, corrupt: Mapping[int, str]) -> None:
        """Give rows that a reader could not read their reason."""
        for reason in dict.fromkeys(corrupt.values()):
            where = np.zeros(len(self.table), dtype=np.bool_)
            where[[place for place, why in corrupt.items() if why == reason]] = True
            self._give(where, reason)

    def _since_start(self, values: Column) -> Column:
        if self.part is not None and isinstance(self.part.start, float):
            return values - self.part.start
        return values - np.min(values, where=np.isfinite(values), initial=np.inf)

    def _refuse_or_keep(self, source: Assignment, check: Callable[..., None], *given: object) -> None:
        """Refuse a column; where everything is trusted, keep the sentence."""
        try:
            check(*given)
        except DataError as refusal:
            if EVERYTHING not in self.trusted:
                raise
            self.refused[source.form.quantity] = str(refusal)

    def _unusable(self) -> NDArray[np.str_]:
        reasons = np.array(self.reasons)
        return reasons[self.reason] if len(reasons) > 1 else np.full(len(self.reason), reasons[0])

    def _check_filled(self, values: Column, source: Assignment) -> None:
        if self.part is None:
            checks.refuse_without_values(values, source, self.trusted)
        empty = np.isnan(values)
        self._mark(empty, f"{source.column} missing", source)
        if self.part is None and empty.any():
            first = row(np.flatnonzero(empty)[0])
            self.notes.append(f"{source.column} has no value in {rows(empty.sum())}, first at {first}")

    def _mark(self, where: Mask, reason: str, source: Assignment) -> None:
        """Give rows a reason code; the first reason stays."""
        if source.form.quantity == "reading" and "echo_time" in self.plan.assignments:
            return  # the echo time is there without it
        self._give(where, reason)

    def _give(self, where: Mask, reason: str) -> None:
        rows = np.flatnonzero(where)
        if len(rows):
            self.reasons.append(reason)
            self.reason[rows[self.reason[rows] == 0]] = len(self.reasons) - 1

    def _echo_time(
        self, values: dict[str, Column], conditions: dict[str, Column], reading_speed: str | float | None
    ) -> Column:
        echo_time, reading = values.get("echo_time"), values.get("reading")
        if reading is None and echo_time is not None:
            if reading_speed is not None:
                Model(str(reading_speed))  # of no use here, but what is no speed is a mistake
            return echo_time
        assert reading is not None  # one of both is there
        if echo_time is None:
            speed = FirmwareSpeed(reading_speed, conditions, self._thermometer)
            if not speed.stated:
                self.notes.append(
                    f"readings are taken to be made with the speed {speed.law}; "
                    f"if the firmware used another: {keyword('reading_speed', 343)}"
                )
            self.reading_speed = speed.law if speed.stated else ""
            return speed.echo_time(reading, self.reason == 0)
        if reading_speed is not None or "temperature" in conditions:
            sources = (self.plan.assignments["echo_time"], self.plan.assignments["reading"])
            speed = FirmwareSpeed(reading_speed, conditions, self._thermometer)
            apart = disagreeing(reading, echo_time, speed, sources, self.part)
            reason = f"{sources[0].column} and {sources[1].column} disagree"
            self._give(apart, reason)
        return echo_time

    def _thermometer(self) -> dict[str, str]:
        """How to say which column is the temperature."""
        return which_temperature(self.table, self.plan)

    def _labels(self, name: str) -> Labels:
        column = self.plan.assignments[name].column
        values = self.table[column]
        return labels.positions(values, column) if name == "order" else labels.codes(values, column)

    def _extra(self) -> tuple[dict[str, Column], dict[str, Labels]]:
        """Other columns that hold numbers, and the codes of those that hold few different texts."""
        found, texts = {}, {}
        for column in (*self.plan.others, *self.plan.several):
            try:
                values = self._numbers(column)
            except DataError:  # text: a name, a remark
                codes = labels.few_codes(self.table[column])
                if codes is not None:
                    texts[column] = codes
                continue
            if np.isfinite(values).any():
                found[column] = values
        return found, texts

    def _without_copies(self, extra: dict[str, Column], values: Mapping[str, Column]) -> dict[str, Column]:
        """Further columns that are no quantity again times a factor, shifted, or rounded."""
        if self.part is not None:
            return extra
        away = {"elapsed_time", "reference_distance"}  # what is tried against these is told in their words
        quantities = [(name, own) for name, own in self.plan.assignments.items() if name not in away]
        copies: dict[str, str] = {}
        for column in set(extra) - set(self.trusted):
            for name, source in quantities:
                line = (
                    line_between(extra[column], source.unit.from_si(values[name])) if name in values else None
                )
                if line is not None:
                    copies[column] = f"'{column}' is {line.of(source.column)}"
                    break
        for column in [name for name in extra if name in copies]:
            self.notes.append(
                f"{copies[column]} in every row, within their rounding: a copy, which is left aside; "
                f"if it is not: {keyword('trust', [column])}"
            )
        return {name: own for name, own in extra.items() if name not in copies}

    def _thermometers(self) -> dict[str, Column]:
        """Further thermometers [degC], NaN where one has no possible value; no row is unusable by them."""
        found = {}
        for column, source in self.plan.several.items():
            values = to_numbers(self.table[column], column, self.missing)
            low, high = source.form.physical
            values = source.unit.to_si(values)
            wrong = np.isfinite(values) & ~((low <= values) & (values <= high))
            if self.part is None and wrong.any():
                first = row(np.flatnonzero(wrong)[0])
                self.notes.append(
                    f"{column} is outside {low:g} to {high:g} degC in {rows(wrong.sum())}, first at {first}; "
                    "it counts as missing there"
                )
            found[column] = np.where(wrong, np.nan, values) if wrong.any() else values
        return found

    def _note_lookalikes(self) -> None:
        """A quantity's bare name in another case is no claim about its unit: ask."""
        for form in FORMS:
            alike = [name for name in self.plan.others if name.lower() == form.role]
            if alike and not form.label and form.quantity not in self.plan.assignments:
                self.notes.append(
                    f"column '{alike[0]}' is not used as {form.role}, for it has no unit; "
                    f"to use it: {keyword('columns', {alike[0]: '...'})} with one of {', '.join(form.names)}"
                )

    def _summarize(self) -> None:
        if self.part is not None:
            return
        counts = np.bincount(self.reason, minlength=len(self.reasons)).tolist()
        given: Counter[str] = Counter()
        for reason, count in zip(self.reasons[1:], counts[1:], strict=True):
            given[reason] += count
        total = given.total()
        if not total:
            return
        listed = ", ".join(f"{count} {reason}" for reason, count in sorted(given.items()) if count)
        if total == len(self.table) and EVERYTHING not in self.trusted:
            raise DataError(f"no row can be used: {listed}. {'; '.join(self.notes)}")
        self.notes.append(f"{total} of {rows(len(self.table))} cannot be used: {listed}")
