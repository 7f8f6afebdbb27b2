"""Delimited text: CSV, TSV and their kin, gzipped or not."""

import csv
import gzip
import io
import re
import warnings
import zlib
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from itertools import islice
from pathlib import Path
from typing import Any, TextIO

import numpy as np
import pandas as pd

from echocal.errors import DataError, UsageError
from echocal.keywords import keyword
from echocal.observations.found import CORRUPT, CUT, Found, keep, pointed, said_of
from echocal.observations.heading import SEPARATORS, fields_of, find_head
from echocal.observations.layout import CUT_SIGN, Head, Layout, is_zipped, no_encoding, settled
from echocal.observations.limits import Guarded
from echocal.observations.numbers import EXACT
from echocal.observations.quotes import Marks
from echocal.observations.records import Records

__all__ = ["FIRST", "Head", "Layout", "below", "head_in", "head_of", "is_zipped", "no_text", "read"]
__all__ += ["resolved", "said_no_text", "settled"]

_PART = 1 << 20  # characters that are searched at a time
_TAIL = 1 << 14  # bytes at the end that are looked at
FIRST = 200  # lines that are looked at for the header
_LINE_END = re.compile(r"\r\n|\r|\n")  # of no other sign, unlike for str.splitlines


def head_of(path: Path, layout: Layout) -> Head:
    """Find the header of a text file; the separator is the one that it has most of.

    Raises
    ------
    DataError
        If the file is not delimited text.
    """
    with below(path, layout, layout.skip_lines) as file:
        return head_in(list(islice(file, FIRST)), layout, str(path))


def head_in(lines: list[str], layout: Layout, path: str) -> Head:
    """Find the header in the first lines below those that are skipped.

    Raises
    ------
    DataError
        If there is none.
    """
    skip, before, lines = _first_lines(lines, layout.skip_lines, path)
    head = find_head(lines, skip, before)
    if layout.decimal is not None:
        head = replace(head, decimal=layout.decimal)
    first = lines[0]
    if (
        not head.nameless
        and head.separator not in first
        and head.above == skip + 1
        and any(s in "".join(lines[1:2]) for s in SEPARATORS)
    ):
        message = (
            f"{path}: line {skip + 1} ('{first[:40]}') is one field and the next line has more; "
            f"if it is a logger's own line, skip it: {keyword('skip_lines', skip + 1)}"
        )
        raise DataError(message)
    if not head.nameless and head.above > skip:
        header = lines[head.above - skip - 1]
        Marks(path, head.separator, len(head.names)).rows([header], head.above)
    return head


def resolved(path: Path, layout: Layout) -> tuple[Head, Layout]:
    """The header of a text file, and the layout with what was seen in it."""
    layout = settled(path, layout)
    head = head_of(path, layout)
    return head, replace(layout, decimal=head.decimal)


def read(path: Path, layout: Layout, verbatim: bool) -> pd.DataFrame:
    """Read a text file.

    Raises
    ------
    DataError
        If the file is not delimited text.
    """
    layout = settled(path, layout)
    head = head_of(path, layout)
    names = head.names
    body = _Body(path, layout, head)
    count = body.rows()
    table = body.texts() if verbatim else body.values()
    if count not in {None, len(table)}:
        message = (
            f"{path} has {count} lines of fields below its header and was read as {len(table)} rows: "
            "a quotation mark may be the cause; remove those that are not needed"
        )
        raise DataError(message)
    if len(table) and body.is_cut():
        body.corrupt.setdefault(len(table) - 1, CUT)
    table.columns = pd.Index(names)
    # a separator at the end of each line makes a column without name and values
    ends = [n for n in names if n.startswith("Unnamed") and table[n].isin(["", float("nan")]).all()]
    found = Found(head.kind, dict(head.units), said_of(layout, head), body.corrupt)
    return keep(table if verbatim else table.drop(columns=ends), found)


class _Body:
    """The rows below a file's header."""

    def __init__(self, path: Path, layout: Layout, head: Head) -> None:
        self.path, self.layout, self.head = path, layout, head
        self.width = len(head.names)
        self.corrupt: dict[int, str] = {}
        """Rows that have more fields than the header."""
        self._mixed = False

    def rows(self) -> int | None:
        """Number of rows that quotation marks leave; None where there are no such marks."""
        head, quoted, last = self.head, False, ""
        repeated = [line[:40] for line in head.repeated]
        with below(self.path, self.layout, head.start) as file:
            for part in iter(lambda: file.read(_PART), ""):
                text = last + part
                quoted = quoted or '"' in part
                self._mixed = self._mixed or (head.comments and ("\n#" in text or text.startswith("#")))
                self._mixed = self._mixed or any(line in text for line in repeated)
                last = text[-41:]
        if not quoted:
            return None
        with below(self.path, self.layout, head.start) as file:
            marks = Marks(str(self.path), head.separator, self.width, head.is_no_row)
            return marks.rows(file, head.start + 1)

    def is_cut(self) -> bool:
        """Whether the last line lacks its end and fields that the line before has."""
        if is_zipped(self.path):
            return False  # a cut archive cannot be unpacked
        with self.path.open("rb") as file:
            file.seek(0, io.SEEK_END)
            file.seek(max(file.tell() - _TAIL, 0))
            data = file.read()
        try:
            text = data.decode(self.layout.encoding, errors="ignore")
        except LookupError:
            return False
        *_, before, last = ["", "", *_LINE_END.split(text)]
        counts = [len(fields_of(line, self.head.separator)) for line in (before, last)]
        return bool(last.strip()) and counts[0] == self.width > counts[1]

    def texts(self) -> pd.DataFrame:
        """Every field as the text that it is."""
        return self._parsed(dtype=str, keep_default_na=False)

    def values(self) -> pd.DataFrame:
        """Numbers where all fields of a column are, else text."""
        decimal = self.head.decimal
        kept = self.layout.text_column
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
        with below(self.path, self.layout, self.head.start) as file:
            for number, line in enumerate(file, self.head.start + 1):
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
        with below(self.path, self.layout, self.head.start) as file:
            if not self._mixed:
                yield file
                return
            marks = Marks(str(self.path), self.head.separator, self.width, self.head.is_no_row)
            rows = marks.records(file, self.head.start + 1)
            yield io.StringIO("".join(line for row, lines in rows if row for line in lines), newline="")

    def _sound(self) -> TextIO | None:
        """The rows, where those with too many fields are few; these are empty and `corrupt`."""
        sound = io.StringIO(newline="")
        writer = csv.writer(sound, delimiter=self.head.separator, lineterminator="\n")
        count = 0
        with below(self.path, self.layout, self.head.start) as file:
            records = Records(str(self.path), self.head)
            for record in records.of(file, self.head.start + 1):
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


def _first_lines(lines: list[str], skip: int, path: str) -> tuple[int, str, list[str]]:
    """Lines above the first that is no comment, the last of those, and that line with some after it."""
    before = ""
    while lines and (lines[0].startswith("#") or not lines[0].strip()):
        skip += 1
        before = lines.pop(0).strip()
    if not lines:
        message = f"{path} has no header" + (f" after {skip} skipped lines" if skip else "")
        raise DataError(message)
    if "\0" in lines[0]:
        wide = {0: "utf-16-be", 1: "utf-16-le"}.get(lines[0].find("\0"), "utf-16")
        message = (
            f"{path} is not text: its first line has NUL bytes; a binary file, or name the encoding: "
            f"{keyword('encoding', wide)}"
        )
        raise DataError(message)
    return skip, before, [line.rstrip("\r\n") for line in lines]


def no_text(path: Path, layout: Layout) -> str:
    """Say that a file is not text in its encoding."""
    with path.open("rb") as file:
        return said_no_text(str(path), layout.encoding, file.read(2))


def said_no_text(name: str, encoding: str, begins: bytes) -> str:
    """The same of a text by its name and what it begins with."""
    encoding = encoding.removesuffix("-sig")
    wide = begins[:2] in {b"\xff\xfe", b"\xfe\xff"}
    likely = keyword("encoding", "utf-16" if wide else "latin-1") + (
        "" if wide else " (or cp1252, utf-16, ...)"
    )
    return f"{name} is not text in {encoding}: a binary file, or name the encoding: {likely}"


@contextmanager
def below(path: Path, layout: Layout, lines: int) -> Iterator[TextIO]:
    """Open a file below its first lines."""
    try:
        with _open(path, layout.encoding) as file:
            for _ in islice(file, lines):
                pass
            yield file
    except UnicodeError:
        raise DataError(no_text(path, layout)) from None
    except LookupError:  # one for bytes, such as zip
        raise UsageError(no_encoding(layout.encoding)) from None
    except (OSError, EOFError, zlib.error) as error:
        message = f"{path} cannot be unpacked: {error}"
        raise DataError(message) from None


def _open(path: Path, encoding: str) -> TextIO:
    opened: Any = gzip.open if is_zipped(path) else open
    guarded: Any = Guarded(opened(path, "rb"), path)
    return io.TextIOWrapper(guarded, encoding=encoding, errors=CUT_SIGN, newline="")
