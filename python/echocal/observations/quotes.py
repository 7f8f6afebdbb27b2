"""Quotation marks of delimited text: a stray one must not swallow the rows that follow.

Within quotation marks a field may legally span lines: a spreadsheet writes remarks so. A stray mark
opens a field in the same way, and the field ends at whichever mark comes next. The text of the lines
shows which of the two it is: swallowed lines are rows of the table.
"""

import re
from collections.abc import Callable, Iterable, Iterator
from functools import cached_property

from echocal.errors import DataError
from echocal.observations.limits import refuse_record

__all__ = ["Marks"]

_NUMBER = re.compile(r'[\s"]*[-+]?[\d.,]*\d[\d.,]*(?:[eE][-+]?\d+)?[\s"]*')
_MEND = 'remove it, or within a quoted field write it twice ("")'


class Marks:
    """Marks of a text whose lines have so many fields.

    Parameters
    ----------
    path : str
        How messages name the text.
    separator : str
        The separator of fields.
    fields : int
        Fields of the header.
    is_no_row : callable, optional
        Whether a line is a comment, which is no row.
    """

    def __init__(
        self,
        path: str,
        separator: str,
        fields: int,
        is_no_row: Callable[[str], bool] = lambda line: False,
    ) -> None:
        self._path, self._separator, self._fields = path, separator, fields
        self._is_no_row = is_no_row
        self.is_cut = False
        """Whether the text ends within the quoted field of its last row."""

    @cached_property
    def _whole(self) -> re.Pattern[str]:
        """What closes all the fields that it opens."""
        return re.compile(f"{self._field}(?:{self._cut}{self._field})*")

    @cached_property
    def _open(self) -> re.Pattern[str]:
        """What ends within a quoted field."""
        return re.compile(f'(?:{self._field}{self._cut})* *"(?:[^"]|"")*')

    @cached_property
    def _field(self) -> str:
        return f'(?: *"(?:[^"]|"")*" *|(?! *")[^{self._cut}]*)'

    @property
    def _cut(self) -> str:
        return re.escape(self._separator)

    def rows(self, lines: Iterable[str], first: int) -> int:
        """Count rows: lines that are not blank, and quoted fields over several lines as one.

        Raises `DataError` if a quotation mark is not closed, is closed within a field, or swallows rows.

        Parameters
        ----------
        lines : iterable of str
            Lines below the header.
        first : int
            Number of the first of them in the file.
        """
        return sum(bool(record) for record, _ in self.records(lines, first))

    def records(
        self, lines: Iterable[str], first: int, *, cut: bool = False
    ) -> Iterator[tuple[list[str], list[str]]]:
        """Lines of each row, without and with what ends them; a blank line is no row.

        Parameters
        ----------
        lines, first
            As for `rows`.
        cut : bool
            Whether a text may end within a quoted field, if no line of the field looks like a row.

        Raises
        ------
        DataError
            As `rows`.
        """
        record: list[str] = []
        held: list[str] = []
        size = 0
        usual = ""  # the last line that is a whole row
        whole, blanks = self._whole.fullmatch, " \t".replace(self._separator, "")
        for number, ended in enumerate(lines, first):
            line = ended.rstrip("\r\n")
            if not record and self._is_no_row(line):
                yield [], [ended]
                continue
            if not record and '"' not in line:
                yield [line] if line.strip(blanks) != "" else [], [ended]
                usual = line
                continue
            if not record and whole(line):
                yield [line], [ended]
                continue
            record.append(line)
            held.append(ended)
            size += len(ended)
            refuse_record(size, number - len(record) + 1, self._path)
            if not self._closed(record, number):
                continue
            self._refuse_swallowed(record, number - len(record) + 1, usual)
            yield record, held
            record, held, size = [], [], 0
        if record:
            self.is_cut = cut and self._swallowed(record, usual, closed=False) is None
            if self.is_cut:
                yield record, held
                return
            message = (
                f"{self._path}: nothing closes the quotation mark of line {number - len(record) + 1} "
                f"({record[0]:.60}); {_MEND}"
            )
            raise DataError(message)

    def _closed(self, record: list[str], number: int) -> bool:
        """Whether a record ends with the line that was added last."""
        # inside a quoted field a line goes on as after an opening mark
        last = record[-1] if len(record) == 1 else f'"{record[-1]}'
        if self._whole.fullmatch(last):
            return True
        if self._open.fullmatch(last):
            return False
        begun = "" if len(record) == 1 else f", as if it closed the one of line {number - len(record) + 1}"
        message = (
            f"{self._path}: line {number} has a quotation mark within a field{begun} ({record[-1]:.60}); "
            f"{_MEND}"
        )
        raise DataError(message)

    def _refuse_swallowed(self, record: list[str], first: int, usual: str) -> None:
        """Refuse a field over several lines if one of them looks like a row of its own."""
        place = self._swallowed(record, usual, closed=True)
        if place is not None:
            message = (
                f"{self._path}: the quotation mark of line {first} would make one field of lines {first} "
                f"to {first + len(record) - 1}, and line {first + place} looks like a row "
                f"({record[place]:.60}); {_MEND}; if the field is meant to have several lines, write it "
                "on one"
            )
            raise DataError(message)

    def _swallowed(self, record: list[str], usual: str, *, closed: bool) -> int | None:
        """Place of the first line of a record that looks like a row of its own.

        A row has a number wherever the record's first line has one; if that has none, wherever the usual
        row has one. The last line of a closed record is not compared with the usual row: it ends with the
        record's own fields. Where no row tells, the number of fields makes a row of a line of an open record.
        """
        own, others = self._numeric(record[0]), self._numeric(usual)
        for place, line in enumerate(record[1:], 1):
            numeric = own or (others if place < len(record) - 1 or not closed else [])
            texts = self._split(line)
            fits = all(_NUMBER.fullmatch(texts[n]) or not texts[n].strip() for n in numeric if n < len(texts))
            if (numeric or not (closed or usual)) and len(texts) == self._fields and fits:
                return place
        return None

    def _numeric(self, line: str) -> list[int]:
        """Places of the fields that are numbers."""
        return [place for place, text in enumerate(self._split(line)) if _NUMBER.fullmatch(text)]

    def _split(self, line: str) -> list[str]:
        return line.split(self._separator)
