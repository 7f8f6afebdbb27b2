"""The lines of a placement as rows, by the readers of logs."""

import re
import tempfile
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import pandas as pd

from echocal.errors import DataError
from echocal.observations.at import parsed
from echocal.observations.inspection import ColumnFacts, Inspection, inspect_log
from echocal.observations.names import IGNORE
from echocal.observations.numbers import says_no_echo
from echocal.observations.options import ReadOptions
from echocal.time_outs import is_echo

_NAMED = "delimited text"
_NAMELESS = re.compile(r"column \d+")
_REFERENCE, _READING = "distance_", "reading_"  # what names begin with
_STRAY = 3  # lines of a board that is starting
_OF_LINES = {"columns", "missing", "skip_lines", "decimal", "encoding"}
PLACED = ("distance_m", "stand")
"""Columns that the ruler gives."""


@dataclass(frozen=True)
class Placement:
    """Rows at one distance."""

    rows: pd.DataFrame  # columns with echocal's names
    lines: int  # lines that came
    usable: int  # rows with an echo


@dataclass
class Ruler:
    """What is known of the lines, and the placements so far."""

    options: ReadOptions  # how lines are read
    heading: str = ""  # names of the columns, where lines have none
    codes: dict[str, list[str]] = field(default_factory=dict)
    """Error codes that mean "no value", by column of the table."""
    table: pd.DataFrame = field(default_factory=pd.DataFrame)  # all placements

    def looked_at(self, lines: Sequence[str]) -> Inspection | None:
        """What lines hold; None where each says that no echo came.

        Raises `DataError` if they cannot be read.
        """
        if all(map(says_no_echo, lines)):
            return None
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "lines.txt"
            path.write_text("\n".join([*([self.heading] if self.heading else []), *lines]) + "\n", "utf-8")
            found = inspect_log(path, self.options)
        own = {c.name: c.proposal.request for c in found.columns if _tells_distance(c)}
        for name, request in own.items():
            self.say_of(name, request.replace(_REFERENCE, _READING, 1))
        return self.looked_at(lines) if own else found

    def first_looked_at(self, lines: Sequence[str]) -> Inspection | None:
        """What the first lines hold; of a port, the first may be the end of a line, or a board's own."""
        found = self.looked_at(lines)
        for start in range(1, min(_STRAY, len(lines) - 1) + 1):
            if found is None or not self.has_no_names(found):
                break
            later = self.looked_at(lines[start:])
            found = found if later is None or self.has_no_names(later) else later
        return found

    def knows(self, quantity: str, found: Inspection) -> bool:
        """Whether lines, or the user, say a condition."""
        return quantity in parsed(self.options.at or {}) or any(
            column.proposal.quantity == quantity for column in found.columns
        )

    def say_of(self, column: str, request: str) -> None:
        """Take what the user says that a column holds."""
        self.options = replace(self.options, columns={**self.options.requests, column: request})

    def has_no_names(self, found: Inspection) -> bool:
        """Whether the lines are numbers alone."""
        return all(_NAMELESS.fullmatch(str(name)) for name in found.table.columns)

    def keep_heading(self, found: Inspection, lines: Sequence[str]) -> None:
        """Keep the line with the names: a program tells them once."""
        names = [str(name) for name in found.table.columns]
        if found.kind == _NAMED and not self.heading:
            self.heading = next((line for line in lines if all(name in line for name in names)), "")

    def state(self, name: str, value: str) -> None:
        """Take a condition that lines do not tell, as ``at`` of `echocal.read_observations`."""
        self.options = replace(self.options, at={**(self.options.at or {}), name: value})

    def placement(self, lines: Sequence[str], distance: float) -> Placement:
        """The rows of a placement, where the target is so far away [m].

        Raises `DataError` if lines cannot be read as those before.
        """
        found = self.looked_at(lines)
        if found is None:
            return Placement(pd.DataFrame(index=range(len(lines))), len(lines), 0)
        data, usable = found.observations, 0
        if data is not None:
            usable = int((data.usable & is_echo(data.echo_time, distance)).sum())
        elif not _is_silent(found):
            raise DataError(found.refusal)
        names = {column.name: _name(column) for column in found.columns}
        for name, codes in found.missing.items():
            own = self.codes.setdefault(names.get(name, name), [])
            own += [code for code in codes if code not in own]
        ignored = [name for name, request in names.items() if request == IGNORE]
        rows = found.table.drop(columns=ignored).rename(columns=names)
        return Placement(rows, len(lines), usable)

    def add(self, placement: Placement, distance: float) -> None:
        """Add the rows of a placement, with the distance that the ruler gives [m]."""
        stand = 1 + (0 if self.table.empty else int(self.table["stand"].max()))
        own = placement.rows.assign(**dict(zip(PLACED, (distance, stand), strict=True)))
        whole = own if self.table.empty else pd.concat([self.table, own], ignore_index=True)
        self.table = whole[[*PLACED, *(name for name in whole if name not in PLACED)]]

    def reading(self) -> dict[str, Any]:
        """How the table is read: as the lines, but that its columns have names."""
        given = {name: own for name, own in self.options.given().items() if name not in _OF_LINES}
        return given | ({"missing": self.codes} if self.codes else {})


def _tells_distance(column: ColumnFacts) -> bool:
    """Whether a device calls its reading a distance: the ruler gives the reference."""
    request, guess = column.proposal.request, column.proposal.guess
    return request.startswith(_REFERENCE) or (guess and request.startswith(_READING) and bool(column.unit))


def _is_silent(found: Inspection) -> bool:
    """Whether no line has an echo: a device without one tells 0, a negative number, or nothing."""
    echoes = [c.name for c in found.columns if c.proposal.quantity in ("echo_time", "reading")]
    numbers = found.table[echoes].apply(pd.to_numeric, errors="coerce")
    return bool(echoes) and not bool((numbers > 0).to_numpy().any())


def _name(column: ColumnFacts) -> str:
    """What a column holds, as a name; else its own name."""
    request = column.proposal.request
    return request if "_" in request or request in ("time", IGNORE) else column.name
