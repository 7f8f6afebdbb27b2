"""The one scanner of delimited text: which lines are rows, and what their fields are."""

import codecs
from collections.abc import Collection, Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import pandas as pd

from echocal import _core
from echocal.errors import DataError
from echocal.observations.arrow import arrow, has_arrow, to_pandas
from echocal.observations.found import CORRUPT, CUT
from echocal.observations.layout import CUT_SIGN, Head
from echocal.observations.limits import LINE, too_long

_MEND = 'remove it, or within a quoted field write it twice ("")'
_SHOWN = 60  # characters of a line that a message shows


@dataclass(frozen=True)
class Block:
    """Whole lines of a text, one behind the other."""

    lines: _core.Lines
    first: int
    """Number of the first of them in the file."""

    @property
    def is_text(self) -> bool:
        """Whether the lines are UTF-8."""
        data = self.lines.data
        try:
            return data.isascii() or bool(codecs.utf_8_decode(memoryview(data)[: self.lines.taken]))
        except UnicodeError:
            return False

    @property
    def unread(self) -> dict[int, str]:
        """Why rows are not read, by their place among the rows."""
        return {row: CUT if is_cut else CORRUPT for row, *_, is_cut in self.lines.unread()}


class Scanner:
    """Cuts what comes below a header into rows.

    Within quotation marks a field may span lines. A stray mark must not swallow the rows that follow. Where
    the text has JSON, too, a line that begins with a brace is no row. Messages name the text by `name`.
    """

    def __init__(self, name: str, head: Head, *, with_json: bool = False) -> None:
        self._name = name
        repeated = [line.encode(errors="surrogateescape") for line in head.repeated]
        self._core = _core.Scanner(ord(head.separator), len(head.names), head.comments, with_json, repeated)

    def scan(self, data: bytes, first: int, *, last: bool) -> tuple[Block, str]:
        """The whole lines at the beginning of some bytes, and what is wrong behind them.

        `first` is the number of the first line. Where the bytes are the last, a line without an end is whole.
        """
        lines = self._core.scan(data, last)
        return Block(lines, first), "" if lines.wrong is None else self._said(first, *lines.wrong)

    def refuse_open(self, line: str, number: int) -> None:
        """Refuse a line whose quotation marks do not close what they open. Raises `DataError`."""
        text = line.encode() + b"\n"
        block, wrong = self.scan(text, number, last=False)
        if not block.lines.taken:
            raise DataError(wrong or self._said(number, "open", 0, 0, 0, text[:-1]))

    def blocks(self, parts: Iterator[bytes], first: int) -> Iterator[Block]:
        """Whole lines of each part of a text; a part ends anywhere.

        Raises `DataError` if a quotation mark is wrong, or a line is too long.
        """
        rest = b""
        while True:
            part = next(parts, b"")
            rest = rest + part if part else _whole_signs(rest)
            block, wrong = self.scan(rest, first, last=not part)
            if wrong:
                raise DataError(wrong)
            if block.lines.taken:
                yield block
            if not part:
                return
            first += block.lines.count
            rest = rest[block.lines.taken :]
            if len(rest) > LINE:
                raise too_long(self._name, first)

    def _said(self, number: int, fault: str, first: int, line: int, last: int, text: bytes) -> str:
        begin, own, end = number + first, number + line, number + last
        shown = text.decode(errors="replace")[:_SHOWN]
        match fault:
            case "open":
                said = f"nothing closes the quotation mark of line {begin} ({shown}); {_MEND}"
            case "within":
                begun = "" if own == begin else f", as if it closed the one of line {begin}"
                said = f"line {own} has a quotation mark within a field{begun} ({shown}); {_MEND}"
            case "swallows":
                said = (
                    f"the quotation mark of line {begin} would make one field of lines {begin} to {end}, and "
                    f"line {own} looks like a row ({shown}); {_MEND}; if the field is meant to have several "
                    "lines, write it on one"
                )
            case "long field":
                said = (
                    f"the quotation mark of line {begin} opens a field of more than {LINE:,} bytes, which no "
                    "table of measurements has; remove the mark, or close the field"
                )
            case _:
                return str(too_long(self._name, begin))
        return f"{self._name}: {said}"


def _whole_signs(data: bytes) -> bytes:
    """The end of a file that may be cut within a sign of UTF-8."""
    try:
        return data if data.isascii() else data.decode(errors=CUT_SIGN).encode()
    except UnicodeError:
        return data  # it is no text elsewhere


def strings(data: bytes, bounds: Any) -> Any:
    """A column of Arrow over the bytes of its fields."""
    pa = arrow("reading text")
    return pa.StringArray.from_buffers(len(bounds) - 1, pa.py_buffer(bounds), pa.py_buffer(data))


def texts_of(
    pieces: Sequence[tuple[bytes, Any]], empty: Collection[str] = (), *, are_times: bool = False
) -> "pd.Series[Any]":
    """A column of texts, from the bytes of its fields in each block; null where they mean "no value".

    Instants where they are times, and each is one for Arrow.
    """
    if not has_arrow():
        texts = [
            data[begin:end].decode() for data, bounds in pieces for begin, end in pairwise(bounds.tolist())
        ]
        return pd.Series([None if text in empty else text for text in texts], dtype=object)
    pa = arrow("reading text")
    column = pa.chunked_array([strings(*own) for own in pieces], pa.string())
    if empty:
        column = pa.compute.if_else(pa.compute.is_in(column, pa.array(sorted(empty))), None, column)
    if are_times:
        with suppress(pa.ArrowInvalid):
            column = column.cast(pa.timestamp("ns"))
    return to_pandas(pa.table({"": column}))[""]
