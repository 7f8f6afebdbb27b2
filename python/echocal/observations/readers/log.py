"""What the reader of a format gives: records, and what stands beside them."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import pandas as pd

from echocal.errors import DataError
from echocal.observations.fields import shown
from echocal.observations.found import Join
from echocal.observations.limits import refuse_cells, refuse_names
from echocal.observations.numbers import NO_ECHO, NO_NUMBER, says_no_echo

_WITHOUT = "line without values"


@dataclass
class Log:
    """Rows of a log."""

    records: list[dict[str, Any]] = field(default_factory=list)
    """Values of each row, by column; an empty one where the row could not be read."""
    units: dict[str, str] = field(default_factory=dict)
    notes: list[str] = field(default_factory=list)
    corrupt: dict[int, str] = field(default_factory=dict)
    """The line of each row that has no values."""
    requests: dict[str, str] = field(default_factory=dict)
    """What columns hold for sure, by how the log is written."""
    joined: dict[str, Join] = field(default_factory=dict)
    """Columns whose values were recorded at other times than those of the rows."""

    def lose(self, line: str, clock: Mapping[str, str] | None = None) -> None:
        """Add a row for a line that has no values."""
        self.corrupt[len(self.records)] = line
        self.records.append(dict(clock or {}))

    def table(self, path: str) -> pd.DataFrame:
        """Columns in the order in which they appear; numbers where all values are such.

        Raises `DataError` if no row has a value, or there are more columns than a table can have.
        """
        names = dict.fromkeys(name for record in self.records for name in record)
        if not names:
            raise DataError("the log has no values")
        refuse_names(names, path)
        refuse_cells(len(self.records), len(names), sum(map(len, self.records)), path)
        self._give_reasons()
        try:
            return _frame(self.records, names)
        except UnicodeEncodeError:
            self.records = [{_text(k): _text(v) for k, v in record.items()} for record in self.records]
            return _frame(self.records, map(_text, names))

    def _give_reasons(self) -> None:
        """Turn the lines of rows without values into reasons, and say how many there are."""
        reasons = {row: NO_ECHO if says_no_echo(line) else _WITHOUT for row, line in self.corrupt.items()}
        told = {NO_ECHO: "say that no echo came", _WITHOUT: "have no values"}
        for reason, what in told.items():
            rows = [row for row, own in reasons.items() if own == reason]
            if rows:
                line = shown(self.corrupt[min(rows)].strip())
                self.notes.append(
                    f"{len(rows)} of {len(self.records)} lines {what}, first row {min(rows) + 1}: '{line}'"
                )
        self.corrupt = reasons


def _frame(records: Sequence[Mapping[str, Any]], names: Iterable[str]) -> pd.DataFrame:
    columns = {name: pd.Series([record.get(name) for record in records], dtype=object) for name in names}
    return pd.DataFrame({name: numeric(values) for name, values in columns.items()})


def _text(value: Any) -> Any:
    """A value; half of a pair of surrogates, which JSON can write and is no character, becomes U+FFFD."""
    if not isinstance(value, str):
        return value
    return value.encode("utf-16", "surrogatepass").decode("utf-16", "replace")


def numeric(values: pd.Series[Any]) -> pd.Series[Any]:
    """Numbers, if all values are such or say that there is none; else the values."""
    plain = values.map(lambda v: None if v is None or (isinstance(v, str) and v.strip() in NO_NUMBER) else v)
    if any(isinstance(v, bool) for v in plain):
        return values
    numbers = pd.to_numeric(plain, errors="coerce")
    return numbers if numbers.notna().sum() == plain.notna().sum() and plain.notna().any() else values
