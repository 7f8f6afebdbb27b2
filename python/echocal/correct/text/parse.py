"""The columns that are needed, from the lines of a block: fast where the text is plain, else with care.

Both ways give the same numbers to the last bit: each is the double next to its decimal digits.
"""

import codecs
import io
import re
from collections.abc import Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field, replace
from functools import cached_property
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from echocal import _core
from echocal.observations.arrow import arrow, has_arrow, to_pandas
from echocal.observations.file import TextFile
from echocal.observations.found import NOT_READ
from echocal.observations.heading import SEPARATORS
from echocal.observations.layout import CUT_SIGN, NO_SIGN, Head
from echocal.observations.limits import LINE, too_long
from echocal.observations.numbers import EMPTY, NO_NUMBER, NUMBER, number_of
from echocal.observations.quotes import Marks
from echocal.observations.text import Records
from echocal.outputs import spreadsheet_safe

__all__ = ["Block", "Lines", "Parser", "blocks_of"]

_NO_SIGN = NO_SIGN.encode()
_RECORDS = 20_000
"""Rows of a block where quotation marks may span lines."""

_QUOTE, _LINE_FEED = 34, 10


@dataclass(frozen=True)
class Block:
    """Whole rows of a file."""

    data: bytes  # in UTF-8, with the ends of lines
    first: int  # number of the first line in the file

    def __len__(self) -> int:
        return len(self.data)


def blocks_of(file: TextFile, size: int) -> Iterator[Block]:
    """Blocks of the rows below the header, of so many bytes.

    Raises `DataError` if the file cannot be unpacked or is not text, or a quotation mark is wrong.
    """
    first = file.head.start + 1
    rest = b""
    for part in _parts(file, size):
        if (_is_marked(rest) or _is_marked(part)) and _opens(rest + part):
            yield from _records(file, first)
            return
        cut = part.rfind(b"\n") + 1
        data, rest = (b"".join((rest, memoryview(part)[:cut])), part[cut:]) if cut else (b"", rest + part)
        if len(rest) > max(LINE, size):
            raise too_long(file.path, first + data.count(b"\n"))
        if data:
            yield Block(data, first)
            first += int(np.count_nonzero(np.frombuffer(data, np.uint8) == _LINE_FEED))
    if rest:
        yield Block(_whole_signs(rest), first)


def _whole_signs(data: bytes) -> bytes:
    """The end of a file that may be cut within a sign of UTF-8."""
    try:
        return data if data.isascii() else data.decode(errors=CUT_SIGN).encode()
    except UnicodeError:
        return data  # it is no text elsewhere


def _parts(file: TextFile, size: int) -> Iterator[bytes]:
    """Bytes below the header, in UTF-8."""
    with file.opened() as data:
        if codecs.lookup(file.layout.encoding).name not in ("utf-8", "utf-8-sig"):
            with file.below(data, file.head.start) as text:
                yield from (part.encode() for part in iter(lambda: text.read(size), ""))
            return
        data.seek(len(file.mark) + len("".join(file.prelude).encode()))
        yield from iter(lambda: data.read(size), b"")


def _is_marked(data: bytes) -> bool:
    """Whether a line may go on in the next one, or end otherwise than with a line feed."""
    return b'"' in data or b"\r" in data


def _opens(data: bytes) -> bool:
    """Whether a line has a quotation mark without its counterpart: a field may go on in the next line."""
    array = np.frombuffer(data, np.uint8)
    ends = np.flatnonzero(array == _LINE_FEED)
    if b"\r" in data:
        returns = data.count(b"\r")
        if returns != data.count(b"\r\n") + (1 if data.endswith(b"\r") else 0):
            return True  # lines that end otherwise
    marks = np.flatnonzero(array == _QUOTE)
    marks = marks[marks < (ends[-1] if len(ends) else 0)]
    return bool((np.bincount(np.searchsorted(ends, marks)) % 2).any()) if len(marks) else False


def _records(file: TextFile, first: int) -> Iterator[Block]:
    """The same, by the rules of quotation marks; slower."""
    marks = Marks(str(file.path), file.head.separator, len(file.head.names), file.head.is_no_row)
    with file.opened() as data, file.below(data, first - 1) as text:
        lines: list[str] = []
        count, at = 0, first
        for _, held in marks.records(text, first, cut=True):
            if count == _RECORDS and not marks.is_cut:  # what is cut is judged by the row before it
                yield Block("".join(lines).encode(), at)
                at += len(lines)
                lines, count = [], 0
            lines += held
            count += 1
        if lines:
            yield Block("".join(lines).encode(), at)


@dataclass(frozen=True)
class Lines:
    """The lines of a block, as they are written again."""

    texts: _core.Lines | None = None
    """Lines that all are rows, and end alike; None where they are in `records`."""
    end: str = "\n"
    """What ends each line."""
    last: str = "\n"
    """What ends the last one."""
    records: list[tuple[str, str]] | None = None
    """Each row, or blank line, as it is written, and its end; where the lines are not plain."""
    rows: Any = None
    """Places of the rows among them; None where all are rows."""
    corrupt: dict[int, str] = field(default_factory=dict)
    """Reasons by the numbers of rows that are not read. One with more fields than the header is written as
    one quoted field, with the other fields empty."""


class Parser:
    """Parses blocks of one file.

    Parameters
    ----------
    kinds : mapping of str to str
        ``"number"``, ``"time"`` or ``"text"`` by column.
    absent : frozenset of str, or None
        Texts that mean "no value" in each column, besides the usual ones; None: they differ by column.
    """

    def __init__(
        self,
        path: Path,
        head: Head,
        kinds: Mapping[str, str],
        absent: frozenset[str] | None,
    ) -> None:
        self._head, self._kinds = head, kinds
        self._absent = absent
        self._by_record = Records(str(path), head)
        self._empty = EMPTY | (absent or frozenset())
        self._is_plain = _is_plain(head, absent)
        self._repeated = [line.encode() for line in head.repeated]
        self._place = {name: place for place, name in enumerate(head.names)}

    def lines(self, block: Block) -> Lines:
        """The lines of a block, without a look into them."""
        plain = self._plain(block.data)
        return self._records(block) if plain is None else plain

    def table(self, block: Block, lines: Lines, columns: Sequence[str]) -> tuple[Lines, pd.DataFrame]:
        """Some columns of the rows, and the lines with what was found in them.

        Where rows are not read, the column `NOT_READ` has the reasons.
        """
        if lines.texts is not None:
            found = self._fast(lines.texts, columns)
            if found is not None:
                return lines, found
            lines = self._records(block)
        return lines, self._careful(lines, columns)

    def without_formulas(self, block: Block, lines: Lines) -> Lines:
        """The same lines, with an apostrophe before texts that a spreadsheet would take for formulas."""
        if not self._formula.search(block.data):
            return lines
        lines = lines if lines.records is not None else self._records(block)
        assert lines.records is not None
        rows = set(lines.rows)
        records = [
            (self.line_without_formulas(line), end) if place in rows else (line, end)
            for place, (line, end) in enumerate(lines.records)
        ]
        return replace(lines, records=records)

    def line_without_formulas(self, line: str) -> str:
        """The same of one line; all other fields stay letter for letter."""
        values = self._by_record.fields(line) if line else []
        texts = self._written.findall(line)[: len(values)]
        for place, value in enumerate(values):
            if spreadsheet_safe(value) != value:
                text = texts[place]
                blanks = text[: len(text) - len(text.lstrip(" "))]
                if text.startswith('"', len(blanks)):
                    texts[place] = blanks + "\"'" + value.replace('"', '""') + '"'
                else:
                    texts[place] = "\"'" + text.replace('"', '""') + '"'
        return self._head.separator.join(texts)

    @cached_property
    def _written(self) -> re.Pattern[str]:
        """A field as it is written."""
        cut = re.escape(self._head.separator)
        return re.compile(f'(?:^|(?<={cut}))( *"(?:[^"]|"")*"[^{cut}]*|[^{cut}]*)(?={cut}|$)', re.DOTALL)

    @cached_property
    def _formula(self) -> re.Pattern[bytes]:
        """What every block has in which a field begins as a formula."""
        cut = re.escape(self._head.separator.encode())
        return re.compile(rb'(?:^|["\r\n]|%b)[\s\x00-\x1f"]*(?:[=+\-@]|\xef\xbc[\x8b\x8d\x9d\xa0])' % cut)

    def fields(self, block: Block, lines: Lines) -> Any:
        """Every field of the rows as the text that it is, an Arrow table; null where a row has too few.

        A corrupt row has none.
        """
        pa = arrow("Parquet")
        names = list(self._head.names)
        found = self._texts(lines.texts, names)
        if found is not None:
            return pa.table([_strings(*own) for own in found], names=names)
        lines = lines if lines.records is not None else self._records(block)
        width = len(names)
        columns: list[list[str | None]] = [[] for _ in names]
        for row in self._rows(lines):
            for column, text in zip(columns, [*row, *[None] * (width - len(row))], strict=True):
                column.append(text)
        return pa.table([pa.array(column, pa.string()) for column in columns], names=names)

    def _plain(self, data: bytes) -> Lines | None:
        """The lines, if each is a row, all end alike, and marks enclose whole fields."""
        # one byte is found many times faster than two
        if self._head.comments and b"#" in data and (data.startswith(b"#") or b"\n#" in data):
            return None
        if any(line in data for line in self._repeated) or data.endswith(_NO_SIGN):
            return None
        end = b"\r\n" if b"\r" in data else b"\n"
        ended = data.endswith(b"\n")
        if not ended:
            data += end
        texts = _core.Lines.of(data, len(end) == 2)
        if texts is None or (b'"' in data and self._texts(texts, []) is None):
            return None
        return Lines(texts, end.decode(), end.decode() if ended else "")

    def _fast(self, lines: _core.Lines, columns: Sequence[str]) -> pd.DataFrame | None:
        """By the core; None where it does not take the text for what it is."""
        if self._absent is None or not self._is_plain:
            return None
        numbers = [name for name in columns if self._kinds.get(name, "number") == "number"]
        others = [name for name in columns if name not in numbers]
        read = self._numbers(lines, numbers) if numbers or not others else []
        texts = self._texts(lines, others) if others else []
        if read is None or texts is None:
            return None
        found = dict(zip(numbers, read, strict=True))
        found |= {name: self._of(own, name) for name, own in zip(others, texts, strict=True)}
        return pd.DataFrame({name: found[name] for name in columns}, index=range(len(lines)), copy=False)

    def _numbers(self, lines: _core.Lines, names: Sequence[str]) -> list[Any] | None:
        """Columns of numbers; none of them where a field is no number and is not empty."""
        head, empty = self._head, [text.encode() for text in self._empty]
        places = [self._place[name] for name in names]
        return lines.numbers(places, len(head.names), ord(head.separator), ord(head.decimal), empty)

    def _texts(self, lines: _core.Lines | None, names: Sequence[str]) -> list[tuple[bytes, Any]] | None:
        """Bytes of the fields of columns, and where each begins."""
        separator = self._head.separator
        if lines is None or not separator.isascii():
            return None
        return lines.texts([self._place[name] for name in names], len(self._head.names), ord(separator))

    def _of(self, own: tuple[bytes, Any], name: str) -> Any:
        """A column of times or of texts; of texts, too, where a time is none for Arrow."""
        if not has_arrow():
            data, bounds = own
            texts = [data[begin:end].decode() for begin, end in pairwise(bounds.tolist())]
            return self._column(texts, name)
        pa = arrow("reading text")
        column = _strings(*own)
        column = pa.compute.if_else(pa.compute.is_in(column, pa.array(sorted(self._empty))), None, column)
        if self._kinds[name] == "time":
            with suppress(pa.ArrowInvalid):
                column = column.cast(pa.timestamp("ns"))
        return to_pandas(pa.table({name: column}))[name]

    def _records(self, block: Block) -> Lines:
        text = io.StringIO(block.data.decode(), newline="")
        found = list(self._by_record.of(text, block.first))
        rows = [place for place, record in enumerate(found) if record.is_row]
        corrupt = {number: found[place].why for number, place in enumerate(rows) if found[place].why}
        return Lines(records=[(own.text, own.end) for own in found], rows=rows, corrupt=corrupt)

    def _careful(self, lines: Lines, columns: Sequence[str]) -> pd.DataFrame:
        places = [self._place[name] for name in columns]
        fields: list[list[str]] = [[] for _ in columns]
        for row in self._rows(lines):
            for column, place in zip(fields, places, strict=True):
                column.append(row[place] if place < len(row) else "")
        found = {name: self._column(own, name) for name, own in zip(columns, fields, strict=True)}
        if lines.corrupt:
            found[NOT_READ] = [lines.corrupt.get(number) for number in range(len(lines.rows))]
        return pd.DataFrame(found, index=range(len(lines.rows)))

    def _rows(self, lines: Lines) -> Iterator[list[str]]:
        """Fields of each row; fewer than in the header where a row is short, none where it is corrupt."""
        assert lines.records is not None
        for number, place in enumerate(lines.rows):
            yield [] if number in lines.corrupt else self._by_record.fields(lines.records[place][0])

    def _column(self, texts: list[str], name: str) -> Any:
        """Numbers where all are such, as Arrow reads them; else texts, for others to refuse or to read."""
        if self._kinds.get(name, "number") != "number":
            return pd.Series([None if text in self._empty else text for text in texts], dtype=object)
        absent = NO_NUMBER | (self._absent or frozenset())
        numbers = [number_of(text, absent, self._head.decimal) for text in texts]
        if None in numbers:
            return pd.Series([own.replace(self._head.decimal, ".") for own in texts], dtype=object)
        return pd.Series(numbers, dtype=np.float64)


def _strings(data: bytes, bounds: Any) -> Any:
    """A column of Arrow over the bytes of its fields."""
    pa = arrow("reading text")
    return pa.StringArray.from_buffers(len(bounds) - 1, pa.py_buffer(bounds), pa.py_buffer(data))


def _is_plain(head: Head, absent: frozenset[str] | None) -> bool:
    """Whether the core can read numbers: no sign has two meanings, and no number means that there is none."""
    if head.separator not in SEPARATORS or head.separator == head.decimal:
        return False
    return not any(NUMBER.fullmatch(text.strip().replace(head.decimal, ".")) for text in absent or ())
