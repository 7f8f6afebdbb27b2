"""Delimited text: CSV, TSV and their kin, gzipped or not."""

import csv
import io
import re
import warnings
from collections.abc import Callable, Iterable, Iterator
from contextlib import AbstractContextManager, contextmanager
from typing import IO, Any, NamedTuple, TextIO

import numpy as np
import pandas as pd

from echocal.errors import DataError
from echocal.observations.file import TextFile
from echocal.observations.found import CORRUPT, CUT, Found, keep, pointed, said_of
from echocal.observations.heading import fields_of, too_long
from echocal.observations.layout import NO_SIGN, Head
from echocal.observations.numbers import EXACT
from echocal.observations.quotes import Marks

__all__ = ["Record", "Records", "read"]

_PART = 1 << 20  # characters that are searched at a time
_TAIL = 1 << 14  # bytes at the end that are looked at
_LINE_END = re.compile(r"\r\n|\r|\n")  # of no other sign, unlike for str.splitlines


def read(file: TextFile) -> pd.DataFrame:
    """Read a text file. Raises `DataError` if the file is not delimited text."""
    head = file.head
    names = head.names
    with file.opened() as data:
        body = _Body(file, data)
        count = body.rows()
        table = body.values()
        if count not in {None, len(table)}:
            message = (
                f"{file.path} has {count} lines of fields below its header and was read as {len(table)} "
                "rows: a quotation mark may be the cause; remove those that are not needed"
            )
            raise DataError(message)
        if len(table) and body.is_cut():
            body.corrupt.setdefault(len(table) - 1, CUT)
    table.columns = pd.Index(names)
    # a separator at the end of each line makes a column without name and values
    ends = [n for n in names if n.startswith("Unnamed") and table[n].isin(["", float("nan")]).all()]
    found = Found(head.kind, dict(head.units), said_of(file.layout, head), body.corrupt)
    return keep(table.drop(columns=ends), found)


class _Body:
    """The rows below a file's header."""

    def __init__(self, file: TextFile, data: IO[bytes]) -> None:
        self.file, self.data, self.path, self.head = file, data, file.path, file.head
        self.width = len(file.head.names)
        self.corrupt: dict[int, str] = {}
        """Rows that have more fields than the header."""
        self._mixed = False

    def _below(self) -> AbstractContextManager[TextIO]:
        return self.file.below(self.data, self.head.start)

    def rows(self) -> int | None:
        """Number of rows that quotation marks leave; None where there are no such marks."""
        head, quoted, last = self.head, False, ""
        repeated = [line[:40] for line in head.repeated]
        with self._below() as text:
            for part in iter(lambda: text.read(_PART), ""):
                both = last + part
                quoted = quoted or '"' in part
                self._mixed = self._mixed or (head.comments and ("\n#" in both or both.startswith("#")))
                self._mixed = self._mixed or any(line in both for line in repeated)
                last = both[-41:]
        if not quoted:
            return None
        with self._below() as text:
            marks = Marks(str(self.path), head.separator, self.width, head.is_no_row)
            return marks.rows(text, head.start + 1)

    def is_cut(self) -> bool:
        """Whether the last line lacks its end and fields that the line before has."""
        if self.file.is_zipped:
            return False  # a cut archive cannot be unpacked
        self.data.seek(max(self.data.seek(0, io.SEEK_END) - _TAIL, 0))
        text = self.data.read().decode(self.file.layout.encoding, errors="ignore")
        *_, before, last = ["", "", *_LINE_END.split(text)]
        counts = [len(fields_of(line, self.head.separator)) for line in (before, last)]
        return bool(last.strip()) and counts[0] == self.width > counts[1]

    def values(self) -> pd.DataFrame:
        """Numbers where all fields of a column are, else text."""
        decimal = self.head.decimal
        kept = self.file.layout.text_column
        labels = {n: str for n, name in enumerate(self.head.names) if kept and name.strip() == kept}
        table = self._parsed(decimal=decimal, dtype=labels)
        # integers in a column with empty fields became floats, and the long ones were rounded
        wide = [
            n for n in range(self.width) if table[n].dtype == np.float64 and (table[n].abs() >= EXACT).any()
        ]
        texts = self._parsed(dtype={**labels, **dict.fromkeys(wide, str)}) if wide else table
        for n in wide:
            table[n] = texts[n].str.replace(decimal, ".", regex=False)
        if decimal == ",":
            for n in range(self.width):
                if table[n].dtype.kind not in "fiub":
                    table[n] = pointed(table[n])
        return table

    def _parsed(self, **options: Any) -> pd.DataFrame:
        try:
            with self._lines() as lines:
                return self._frame(lines, **options)
        except pd.errors.EmptyDataError:
            return pd.DataFrame(columns=range(self.width))
        except (pd.errors.ParserError, pd.errors.ParserWarning) as error:
            sound = self._sound()
            if sound is None:
                raise DataError(self._too_many(str(error))) from None
            return self._frame(sound, **options)

    def _too_many(self, error: str) -> str:
        """Say that rows have more fields than the header."""
        of_header = f"{self.path} cannot be read as rows of {self.width} fields like its header"
        with self._below() as text:
            for number, line in enumerate(text, self.head.start + 1):
                if self.head.is_no_row(line.rstrip("\r\n")):
                    continue
                fields = fields_of(line, self.head.separator)
                if len(fields) > self.width:
                    decimal = (
                        "; if its commas are decimal signs, quote such numbers, or write points"
                        if self.head.separator == "," and len(fields) <= 2 * self.width
                        else ""
                    )
                    saw = f"Expected {self.width} fields in line {number}, saw {len(fields)}"
                    return f"{of_header}: {saw}{decimal}"
        return f"{of_header}: {error.strip().splitlines()[-1]}"

    def _frame(self, lines: TextIO, **options: Any) -> pd.DataFrame:
        with warnings.catch_warnings():
            warnings.simplefilter("error", pd.errors.ParserWarning)  # fields would be lost
            table: pd.DataFrame = pd.read_csv(
                lines, sep=self.head.separator, header=None, names=range(self.width), index_col=False,
                skipinitialspace=True, low_memory=False, **options,
            )  # fmt: skip
            return table

    @contextmanager
    def _lines(self) -> Iterator[TextIO]:
        """Lines of rows: without comments, and without the header where it comes again."""
        with self._below() as text:
            if not self._mixed:
                yield text
                return
            marks = Marks(str(self.path), self.head.separator, self.width, self.head.is_no_row)
            rows = marks.records(text, self.head.start + 1)
            yield io.StringIO("".join(line for row, lines in rows if row for line in lines), newline="")

    def _sound(self) -> TextIO | None:
        """The rows, where those with too many fields are few; these are empty and `corrupt`."""
        sound = io.StringIO(newline="")
        writer = csv.writer(sound, delimiter=self.head.separator, lineterminator="\n")
        count = 0
        with self._below() as text:
            records = Records(str(self.path), self.head)
            for record in records.of(text, self.head.start + 1):
                if not record.is_row:
                    continue
                if record.why == CORRUPT:
                    self.corrupt[count] = CORRUPT
                writer.writerow([""] * self.width if record.why == CORRUPT else records.fields(record.text))
                count += 1
        if 2 * len(self.corrupt) >= count:
            return None
        sound.seek(0)
        return sound


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
