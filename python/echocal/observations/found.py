"""What a reader found beside the values of a table, kept with it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass, field
from typing import Any, Literal

import pandas as pd

from echocal.keywords import keyword
from echocal.observations.fields import rows, span
from echocal.observations.layout import Head, Layout

CORRUPT = "corrupt line"
"""Reason of a row with more fields than its header."""

CUT = "cut line"
"""Reason of the last row of a text that ends within a line: its last number may be cut."""

_KEY = "echocal"

NOT_READ = "\0not read"
"""Column beside those of a text: why a row is not read."""


@dataclass(frozen=True)
class Join:
    """How a column came to the rows of a table: its values were recorded at other times."""

    how: Literal["interpolated", "nearest", "ordered"]
    """``ordered``: as the values follow each other in a log without a clock."""
    interval_s: float
    """Usual time between two of its values [s]: half of the record lies in shorter ones."""
    limit_s: float
    """Longest time between two values that it was joined over [s]."""
    without: int
    """Rows that have no value, because no value is near enough."""

    def __str__(self) -> str:
        if self.how == "ordered":
            return "in the order of the log, which has no clock"
        way = "interpolated in time" if self.how == "interpolated" else "the nearest in time"
        apart = (
            f" (values {span(self.interval_s)} apart, up to {span(self.limit_s)})" if self.interval_s else ""
        )
        none = f", no value near enough for {rows(self.without)}" if self.without else ""
        return f"{way}{apart}{none}"


def told(joined: Mapping[str, Join]) -> list[str]:
    """A sentence for each way in which columns were joined."""
    ways: dict[str, list[str]] = {}
    for column, join in joined.items():
        ways.setdefault(str(join), []).append(f"'{column}'")
    return [
        f"{', '.join(names)} {'has' if len(names) == 1 else 'have'} other times than the rows: {way}"
        for way, names in ways.items()
    ]


@dataclass(frozen=True)
class Found:
    """What stands in a log beside its values."""

    kind: str = ""  # what a person calls the format
    units: Mapping[str, str] = field(default_factory=dict)
    """Units of columns that the log gives beside their names."""
    notes: tuple[str, ...] = ()  # what a person should know, one sentence each
    corrupt: Mapping[int, str] = field(default_factory=dict)  # reason of each row that could not be read
    streams: bool = True  # whether `echocal correct` can keep the file line by line
    requests: Mapping[str, str] = field(default_factory=dict)
    """What columns hold by their values or by how the log is written: times, the values of known programs."""
    sure: tuple[str, ...] = ()
    """Those of them that are right, however unusual: the log writes the unit beside each value."""
    joined: Mapping[str, Join] = field(default_factory=dict)
    """Columns whose values were recorded at other times than those of the rows."""


def keep(table: pd.DataFrame, found: Found) -> pd.DataFrame:
    """The table with what was found."""
    # what JSON keeps, as which Parquet writes it
    corrupt = [[row, why] for row, why in found.corrupt.items()]
    table.attrs[_KEY] = {**asdict(found), "corrupt": corrupt}
    return table


def found_in(table: pd.DataFrame) -> Found:
    """What a reader found; nothing for a table that is no log."""
    plain: dict[str, Any] = table.attrs.get(_KEY) or {}
    if not plain:
        return Found()
    corrupt = {int(row): str(why) for row, why in plain["corrupt"] if row < len(table)}
    joined = {column: Join(**join) for column, join in plain["joined"].items()}
    lists = {name: tuple(plain[name]) for name in ("notes", "sure")}
    return Found(**{**plain, **lists, "corrupt": corrupt, "joined": joined})


def pointed(texts: pd.Series[Any]) -> pd.Series[Any]:
    """Texts of which those that are numbers with a comma have a point."""
    number = r"^(\s*[-+]?\d*),(\d+(?:[eE][-+]?\d+)?\s*)$"
    return texts.astype(object).where(
        texts.isna(), texts.astype(str).str.replace(number, r"\1.\2", regex=True)
    )


def said_of(layout: Layout, head: Head) -> tuple[str, ...]:
    """What a person should know of how a text was read."""
    said = []
    if head.kind == "text without a header":
        said.append(
            f"the file has no names of columns: they are called {', '.join(head.names[:3])}"
            f"{', ...' if len(head.names) > 3 else ''}"
        )
    if layout.decimal is None and head.decimal == ",":
        said.append(f"numbers are read with a decimal comma; if that is wrong: {keyword('decimal', '.')}")
    return tuple(said)
