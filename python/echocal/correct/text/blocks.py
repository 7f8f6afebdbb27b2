"""The lines of a text file, some megabytes at a time."""

import codecs
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from echocal.observations.file import TextFile
from echocal.observations.layout import CUT_SIGN
from echocal.observations.limits import LINE, too_long
from echocal.observations.quotes import Marks

__all__ = ["Block", "blocks_of"]

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
