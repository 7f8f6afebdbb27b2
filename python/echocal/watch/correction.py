"""Correct rows as they come, by the function that corrects tables: the same numbers and the same reasons."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from echocal.correct.needed import Needed, needed
from echocal.correct.results import LEVEL
from echocal.correct.rows import Reading, correct_rows
from echocal.domain import counting
from echocal.errors import DataError
from echocal.model import Model
from echocal.observations.misspelled import naming
from echocal.observations.mount import holds_level, is_level
from echocal.observations.names import is_level_name
from echocal.observations.part import Part
from echocal.watch.rows import Columns, Reader, Row

RATES = {"temperature_rate": "temperature", "radiation_rate": "radiation"}
"""Rates of change that an effect may read, and what each is the rate of."""

NO_ECHO = "no echo time and no reading"


@dataclass
class Entry:
    """A row of a sensor on its way."""

    row: Row
    # number, place: among the rows of the sensor, and among all rows of the watch
    """As it came."""
    number: int
    place: int
    decimal: str = "."
    """Decimal separator of its texts."""
    time: float = np.nan
    """By its clock [s]; NaN where it has none."""
    rates: list[float] = field(default_factory=lambda: [np.nan] * len(RATES))
    """Those of `RATES`, NaN where one is not known."""
    untimed: str = ""
    """Why it has no time."""
    units: Mapping[str, str] = field(default_factory=dict)
    """Units that its log gives beside the names of columns."""
    why: str = ""
    """Why it cannot be read."""
    columns: Columns | None = None
    numbers: dict[str, float] = field(default_factory=dict)
    """By column."""
    damaged: list[str] = field(default_factory=list)
    """Columns whose text is no number."""
    problem: str = ""
    """Why its columns cannot be understood."""

    def read(self, reader: Reader, model: Model) -> "Entry":
        """Read its fields; levels have the height of the model's diagnosis, where the user states none."""
        try:
            self.columns = reader.columns(list(self.row), self.units, model)
        except DataError as error:
            self.problem = str(error)
            return self
        self.problem = self.why or ("" if self.columns.has_echo else NO_ECHO)
        self.numbers, self.damaged = reader.read(self.row, self.columns, self.decimal)
        return self

    def to_list(self) -> list[Any]:
        """As plain data, without what `read` finds."""
        plain = [self.number, self.place, self.decimal, self.time, self.rates, self.untimed]
        return [dict(self.row), *plain, dict(self.units), self.why]


@dataclass
class Results:
    """Results of rows."""

    distance: NDArray[np.float64]
    """Corrected distance [m]; NaN where there is none; shape (n,)."""
    level: NDArray[np.float64]
    """What is written in its place where the table holds a level [m]; else NaN; shape (n,)."""
    uncertainty: NDArray[np.float32]
    """Its standard uncertainty [m]; NaN where none is known; shape (n,)."""
    status: list[str]
    """Reason codes."""
    notes: dict[str, int] = field(default_factory=dict)
    """What a person should know, and the first row that it is about."""


def correct(entries: Sequence[Entry], model: Model, reader: Reader, reading: Reading) -> Results:
    """Correct rows in their order; marks look at the rows around in the sequence."""
    blank = np.full(len(entries), np.nan)
    found = Results(blank, blank.copy(), blank.astype(np.float32), [entry.problem for entry in entries])
    groups: dict[int, tuple[Columns, list[int]]] = {}
    for place, entry in enumerate(entries):
        if entry.columns is not None and not entry.problem:
            groups.setdefault(id(entry.columns), (entry.columns, []))[1].append(place)
    for columns, places in groups.values():
        _correct(entries, columns, places, model, reader, reading, found)
    return found


def first_of(row: Row, reading: Reading) -> str:
    """Name of the first result of a row: a mount height makes a level of what is called as a level."""
    held = reading.mount_height is not None and not any(is_level(*one) for one in reading.requests.items())
    if held and any(holds_level(name, name) for name in row if is_level_name(name)):
        return LEVEL
    return reading.first


def _correct(
    entries: Sequence[Entry],
    columns: Columns,
    places: list[int],
    model: Model,
    reader: Reader,
    reading: Reading,
    found: Results,
) -> None:
    """Correct the rows that have some columns; the others stand between them for the marks."""
    if reading.mount_height is not None:  # what is called as a level has it, too
        reading = replace(reading, columns=columns.requests, mount_height=None)
    try:
        own = _needed(columns, model, reading)
        table = _table(entries, columns, own)
        with counting() as outside, naming(columns.names):
            rows = correct_rows(table, model, own, reading, Part(derived=_rates(entries, columns)))
    except DataError as error:
        for place in places:
            found.status[place] = str(error)
        return
    found.distance[places] = rows.distance[places]
    if rows.first == LEVEL:
        found.level[places] = rows.distance[places]
        found.distance[places] = rows.zero - rows.distance[places]
    found.uncertainty[places] = rows.uncertainty[places]
    for place in places:
        status, damaged = rows.reasons[rows.codes[place]], entries[place].damaged
        column = status.removesuffix(" missing")
        found.status[place] = f"{column} is no number" if column in damaged else status
    said = {f"outside of a domain: {text}": first for text, (_, first, _) in outside.items()}
    found.notes |= dict.fromkeys(rows.notes, places[0]) | said


def _needed(columns: Columns, model: Model, reading: Reading) -> Needed:
    return needed(
        columns.names,
        model,
        columns.requests,
        reading_speed=reading.reading_speed,
        trust=[name for name in reading.trust if name in columns.names],
        mark_rows=reading.mark_rows,
    )


def _table(entries: Sequence[Entry], columns: Columns, own: Needed) -> pd.DataFrame:
    """The needed columns, in numbers and instants: no field is read by the looks of its neighbors."""
    clock = columns.clock
    values: dict[str, pd.Series[Any]] = {}
    for name in own.columns:
        if clock is not None and clock.name == "time" and name == clock.column:
            seconds = pd.Series([entry.time for entry in entries], dtype=np.float64)
            values[name] = pd.to_datetime(seconds, unit="s", utc=True)
        else:
            values[name] = pd.Series([entry.numbers.get(name, np.nan) for entry in entries], dtype=np.float64)
    return pd.DataFrame(values, columns=list(own.columns), index=range(len(entries)))


def _rates(entries: Sequence[Entry], columns: Columns) -> Mapping[str, NDArray[np.float64]]:
    held = columns.plan.assignments
    return {
        rate: np.array([entry.rates[place] for entry in entries])
        for place, (rate, of) in enumerate(RATES.items())
        if of in held and "elapsed_time" in held
    }
