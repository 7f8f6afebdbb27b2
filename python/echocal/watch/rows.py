"""The fields of rows as they come, each read by itself: the rows around it change nothing."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import pandas as pd

from echocal.model import Model
from echocal.observations.found import Found
from echocal.observations.hints import completed
from echocal.observations.mount import kept_height, mounted_as, with_named_levels
from echocal.observations.names import EXTRA, IGNORE, by_request
from echocal.observations.numbers import NO_NUMBER, Missing, number_of
from echocal.observations.plan import Assignment, Plan, make, read_columns
from echocal.quantities import QUANTITIES

Row = Mapping[str, Any]

_ECHOES = ("echo_time", "reading")
_PLANS = 256  # sets of columns that are remembered
_LONGEST = 1000  # letters of a name, and fields of a row: what reads names takes the square of that


@dataclass(frozen=True)
class Columns:
    """What the columns of a row are."""

    names: tuple[str, ...]
    requests: dict[str, str]  # meaning of columns, with what names and units say
    plan: Plan

    @property
    def has_echo(self) -> bool:
        """Whether a row with these columns can have a distance."""
        return self.echo != ""

    @property
    def echo(self) -> str:
        """The column of the echo time or the reading; nothing without one."""
        return next(
            (self.plan.assignments[name].column for name in _ECHOES if name in self.plan.assignments), ""
        )

    @property
    def clock(self) -> Assignment | None:
        """The column of the time."""
        return self.plan.assignments.get("elapsed_time")

    @property
    def measured(self) -> dict[str, Assignment]:
        """Columns of numbers that are quantities, by name of the column; without the time."""
        own = [*self.plan.assignments.values(), *self.plan.several.values()]
        return {a.column: a for a in own if not a.form.label and a.name != "time"}


class Reader:
    """Read the fields of rows by the names of their columns.

    Raises `UsageError` if a meaning names no quantity. `columns`, `missing` and `mount_height` [m] are as in
    `echocal.read_observations`; `ignored` columns hold no quantity, such as the sensor's id.
    """

    def __init__(
        self,
        columns: Mapping[str, str] | None = None,
        *,
        ignored: Sequence[str] = (),
        missing: Any = (),
        mount_height: float | None = None,
    ) -> None:
        self.requests = read_columns(columns)
        for name, request in self.requests.items():
            if request.strip() not in {EXTRA, IGNORE}:
                by_request(name, request)
        self.ignored = tuple(ignored)
        self.missing = Missing(missing)
        self.mount_height = mount_height
        self._known: dict[tuple[Any, ...], Columns] = {}
        self._codes: dict[str, tuple[frozenset[str], frozenset[float]]] = {}

    def columns(
        self, names: Sequence[str], units: Mapping[str, str] | None = None, model: Model | None = None
    ) -> Columns:
        """What columns are, by their names, by units that a log gives beside them, and by a model's height.

        Raises `DataError` if a name has no known unit, or two hold the same quantity, and `UsageError` if no
        column is a level and a height is given, or the model's is another one.
        """
        said = units or {}
        key = frozenset(names), tuple(said.items()), None if model is None else kept_height(model)
        if key not in self._known:
            if len(self._known) >= _PLANS:
                self._known.pop(next(iter(self._known)))
            requests = {name: own for name, own in self.requests.items() if name in key[0]}
            requests |= dict.fromkeys((name for name in self.ignored if name in key[0]), IGNORE)
            requests = with_named_levels(names, requests, self.mount_height)
            requests, _ = completed(names, requests, Found(units=said))
            requests = requests if model is None else dict(mounted_as(requests, model))
            self._known[key] = Columns(tuple(names), requests, make(names, requests))
        return self._known[key]

    def read(self, row: Row, columns: Columns, decimal: str = ".") -> tuple[dict[str, float], list[str]]:
        """Numbers of the columns that hold some, NaN where a field has none; and columns of other texts."""
        numbers: dict[str, float] = {}
        damaged = []
        for column in columns.measured:
            value = self._number(row[column], column, decimal)
            numbers[column] = np.nan if value is None else value
            if value is None:
                damaged.append(column)
        for column in columns.plan.others:
            value = self._number(row[column], column, decimal)
            if value is not None:
                numbers[column] = value
        return numbers, damaged

    def _number(self, field: Any, column: str, decimal: str) -> float | None:
        """A number, NaN for no value, None for what is neither."""
        if column not in self._codes:
            texts, numbers = self.missing.texts(column), self.missing.numbers(column)
            self._codes[column] = NO_NUMBER | texts, frozenset(numbers)
        texts, codes = self._codes[column]
        if isinstance(field, str):
            number = number_of(field, texts, decimal)
        elif field is None or field is pd.NA or field is pd.NaT:
            return np.nan
        elif isinstance(field, bool | np.bool_) or not hasattr(field, "__float__"):
            return None
        else:
            try:
                number = float(field)
            except OverflowError:  # an integer beyond all floats
                number = np.inf if field > 0 else -np.inf
            except (TypeError, ValueError):
                return None
        return np.nan if number in codes else number


def refused_names(row: Row, results: Sequence[str]) -> str:
    """Why the names of a row cannot be read, or written with results beside them; empty if they can."""
    if len(row) > _LONGEST:
        return f"it has {len(row)} fields; at most {_LONGEST} are read"
    for name in row:
        if len(name) > _LONGEST:
            return f"a name has {len(name)} letters, '{name[:40]}...'; at most {_LONGEST} are read"
    taken = [name for name in results if name in row]
    if taken:
        return f"it already has a field '{taken[0]}', which a correction adds; rename it"
    return ""


def in_range(value: float, source: Assignment) -> float:
    """A number in SI units; NaN where the quantity cannot have it."""
    low, high = source.form.physical
    si = float(source.unit.to_si(value))
    return si if low <= si <= high and not (source.form.positive and si == low) else np.nan


def conditions_of(numbers: Mapping[str, float], columns: Columns) -> dict[str, float]:
    """Recorded influence quantities of a row by name [SI]; without the time."""
    return {
        quantity: in_range(numbers[a.column], a)
        for quantity, a in columns.plan.assignments.items()
        if quantity in QUANTITIES and quantity != "elapsed_time"
    }


def row_to_keep(row: Row, numbers: Mapping[str, float], columns: Columns | None) -> dict[str, Any]:
    """A row as a diagnosis reads it later, when the rows around are others: numbers, and no time yet."""
    clock = None if columns is None else columns.clock
    kept: dict[str, Any] = {}
    for name, field in row.items():
        if name in numbers:
            kept[name] = None if np.isnan(numbers[name]) else numbers[name]
        elif field is None or isinstance(field, str | int | float):
            kept[name] = field
    if clock is not None:
        kept.pop(clock.column, None)
    return kept
