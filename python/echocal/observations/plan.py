"""Which column of a table holds which quantity."""

import tomllib
from collections.abc import Collection, Iterable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from echocal.errors import DataError, UsageError, among
from echocal.keywords import keyword
from echocal.observations.names import EXTRA, IGNORE, by_name, by_request
from echocal.quantities import Form, Unit

EVERYTHING = "*"
"""Trusted in place of a column: no column is refused, however strange, for a diagnosis to explain."""


@dataclass(frozen=True)
class Assignment:
    """A column and the quantity that it holds."""

    column: str
    form: Form
    unit_name: str

    @property
    def name(self) -> str:
        """The column's name in echocal's way."""
        return f"{self.form.role}_{self.unit_name}" if self.unit_name else self.form.role

    @property
    def unit(self) -> Unit:
        """The unit of the column."""
        return self.form.units[self.unit_name]


@dataclass(frozen=True)
class Plan:
    """What every column of a table is."""

    assignments: Mapping[str, Assignment]
    """By quantity."""
    others: tuple[str, ...]
    """Columns that hold none of the quantities and are not ignored."""
    several: Mapping[str, Assignment] = field(default_factory=dict)
    """Columns of a kind that a table may have several of, by column."""


def read_columns(columns: Mapping[str, str] | str | Path | None) -> dict[str, str]:
    """Requests by column, from a mapping or from a TOML file of the same pairs.

    Raises `UsageError` if the file cannot be read or holds anything but pairs of texts.
    """
    if columns is None:
        return {}
    if isinstance(columns, Mapping):
        return {str(column).strip(): str(request) for column, request in columns.items()}
    if not isinstance(columns, str | Path):
        raise UsageError(f'columns map names to what they hold, {{"SR_U": "reading_m"}}; got {columns!r}')
    path = Path(columns)
    pairs = toml_of(path, "column file", '; a line is "SR_U" = "reading_m"')
    wrong = [column for column, request in pairs.items() if not isinstance(request, str)]
    if wrong:
        raise UsageError(f'column file {path}: "{wrong[0]}" is no text; a line is "SR_U" = "reading_m"')
    return {column.strip(): request for column, request in pairs.items()}


def toml_of(path: Path, what: str, way_out: str = "") -> dict[str, Any]:
    """What a TOML file holds. Raises `UsageError` if it cannot be read."""
    try:
        return tomllib.loads(path.read_text(encoding="utf-8"))
    except OSError as error:
        raise UsageError(f"{what} {path} cannot be read: {error.strerror}") from None
    except ValueError as error:  # not TOML, not UTF-8
        raise UsageError(f"{what} {path} is not TOML: {error}{way_out}") from None


def refuse_absent(names: Iterable[str], columns: Collection[str]) -> None:
    """Raise `UsageError` where a name is none of a column."""
    for name in names:
        if name not in columns and name != EVERYTHING:
            raise UsageError(f"no column '{name}'{among(name, columns, 'the table has:')}")


def make(columns: Collection[str], requests: Mapping[str, str], trusted: Collection[str] = ()) -> Plan:
    """Assign columns to quantities: what the user says goes first, then echocal's names.

    Raises `UsageError` if a request names a column that is not there, or no quantity, and `DataError` if a
    name has no known unit, or two columns hold the same quantity.
    """
    refuse_absent((*requests, *trusted), columns)
    assignments: dict[str, Assignment] = {}
    others, several = [], {}
    for column in columns:
        request = requests.get(column)
        if request is not None and request.strip() == IGNORE:
            continue
        found = by_name(column) if request is None else by_request(column, request)
        if found is None:
            others.append(column)
            continue
        form, unit = found
        if form.several:
            several[column] = Assignment(column, form, unit)
            continue
        earlier = assignments.get(form.quantity)
        if earlier and form.stand_in and not earlier.form.stand_in:
            others.append(column)
            continue
        if earlier and earlier.form.stand_in and not form.stand_in:
            others.append(earlier.column)
        elif earlier:
            _refuse_second(earlier.column, column, form.quantity)
        assignments[form.quantity] = Assignment(column, form, unit)
    return Plan(assignments, tuple(others), several)


def _refuse_second(first: str, second: str, quantity: str) -> None:
    raise DataError(
        f"columns '{first}' and '{second}' both hold {quantity.replace('_', ' ')}; "
        f"say which not to use: {keyword('columns', {second: IGNORE})} (or "
        f"{keyword('columns', {second: EXTRA})})"
    )
