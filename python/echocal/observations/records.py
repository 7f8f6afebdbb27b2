"""The rows of a text one by one: with quotation marks, comments, a field too many or too few."""

import csv
from collections.abc import Callable, Iterable, Iterator
from typing import NamedTuple

from echocal.observations.found import CORRUPT, CUT
from echocal.observations.heading import too_long
from echocal.observations.layout import NO_SIGN, Head
from echocal.observations.quotes import Marks

__all__ = ["Record", "Records"]


class Record(NamedTuple):
    """A row, or a line that is none.

    Attributes
    ----------
    text : str
        As it is written again: a row has as many fields as the header.
    end : str
        What ends it.
    held : list of str
        The lines as they are.
    is_row : bool
    why : str
        Why the row is not read. One with more fields than the header is one quoted field, the others empty.
    """

    text: str
    end: str
    held: list[str]
    is_row: bool
    why: str


class Records:
    """Cuts lines below a header into rows, and rows into fields.

    Parameters
    ----------
    name : str
        How messages name the text.
    is_no_row : callable, optional
        Whether a line is none; default: that of the header.
    """

    def __init__(self, name: str, head: Head, is_no_row: Callable[[str], bool] | None = None) -> None:
        self._name, self._separator, self._width = name, head.separator, len(head.names)
        self._is_no_row = is_no_row or head.is_no_row

    def of(self, lines: Iterable[str], first: int) -> Iterator[Record]:
        """Rows, and lines that are none, of lines with their ends, of which the first has a number.

        Raises `DataError` if a quotation mark is wrong.
        """
        marks = Marks(self._name, self._separator, self._width, self._is_no_row)
        complete = True
        for record, held in marks.records(lines, first, cut=True):
            ended = held[0] if len(held) == 1 else "".join(held)
            line = ended.rstrip("\r\n")
            end = ended[len(line) :]
            why = CUT if marks.is_cut or line.endswith(NO_SIGN) else ""
            if marks.is_cut:
                line += '"'  # the results stand behind the field, not in it
            if record:
                fitted = self._fitted(line)
                if not end and complete and fitted is not None and len(fitted) > len(line):
                    why = CUT
                complete = fitted == line
                if fitted is None:
                    why = CORRUPT
                    fitted = '"' + line.replace('"', '""') + '"' + self._separator * (self._width - 1)
                line = fitted
            yield Record(line, end, held, bool(record), why)

    def _fitted(self, line: str) -> str | None:
        """A row's line with as many fields as the header; None where one beyond these has a value."""
        width, separator = self._width, self._separator
        if line.count(separator) == width - 1 and '"' not in line:
            return line
        fields = self.fields(line)
        if len(fields) < width:
            return line + separator * (width - len(fields))
        if any(text.strip() for text in fields[width:]):
            return None
        for _ in fields[width:]:
            line = line[: line.rindex(separator)]
        return line

    def fields(self, line: str) -> list[str]:
        """Fields of a row as texts."""
        try:
            return next(csv.reader([line], delimiter=self._separator, skipinitialspace=True))
        except csv.Error:
            raise too_long(line) from None
