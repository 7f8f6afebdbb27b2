"""The lines of a text file, some megabytes at a time."""

import codecs
import gzip
import io
import zlib
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import islice
from pathlib import Path
from typing import IO, Any

import numpy as np

from echocal.errors import DataError
from echocal.observations.layout import CUT_SIGN
from echocal.observations.limits import LINE, too_long
from echocal.observations.quotes import Marks
from echocal.observations.text import Head, Layout, below, is_zipped, no_text

__all__ = ["Block", "begins_with_mark", "blocks_of", "prelude"]

_RECORDS = 20_000
"""Rows of a block where quotation marks may span lines."""

_QUOTE, _LINE_FEED = 34, 10


@dataclass(frozen=True)
class Block:
    """Whole rows of a file.

    Attributes
    ----------
    data : bytes
        In UTF-8, with the ends of lines.
    first : int
        Number of the first line in the file.
    """

    data: bytes
    first: int

    def __len__(self) -> int:
        return len(self.data)


def prelude(path: Path, layout: Layout, head: Head) -> tuple[str, str, str, list[str]]:
    """The lines above the header, the header, what ends it, and the lines between it and the rows."""
    with below(path, layout, 0) as file:
        lines = list(islice(file, head.start))
    lines, under = lines[: head.above], lines[head.above :]
    header = lines[-1].rstrip("\r\n")
    return "".join(lines[:-1]), header, lines[-1][len(header) :] or "\n", under


def begins_with_mark(path: Path) -> bool:
    """Whether a file begins with the mark of UTF-8."""
    with path.open("rb") as file:
        return file.read(3) == codecs.BOM_UTF8


def blocks_of(path: Path, layout: Layout, head: Head, size: int) -> Iterator[Block]:
    """Blocks of the rows below the header.

    Raises
    ------
    DataError
        If the file cannot be unpacked or is not text, or a quotation mark is wrong.
    """
    above, header, end, under = prelude(path, layout, head)
    skipped = len((above + header + end + "".join(under)).encode())
    first = head.start + 1
    rest = b""
    for part in _parts(path, layout, skipped, size):
        if (_is_marked(rest) or _is_marked(part)) and _opens(rest + part):
            yield from _records(path, layout, head, first)
            return
        cut = part.rfind(b"\n") + 1
        data, rest = (b"".join((rest, memoryview(part)[:cut])), part[cut:]) if cut else (b"", rest + part)
        if len(rest) > max(LINE, size):
            raise too_long(path, first + data.count(b"\n"))
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


def _parts(path: Path, layout: Layout, skipped: int, size: int) -> Iterator[bytes]:
    """Bytes below the header, in UTF-8."""
    try:
        with _opened(path, layout) as file:
            mark = file.read(3)
            rest = b"" if mark == codecs.BOM_UTF8 and _name(layout) == "utf-8-sig" else mark
            while len(rest) < skipped and (more := file.read(skipped - len(rest))):
                rest += more
            if len(rest) > skipped:
                yield rest[skipped:]
            while part := file.read(size):
                yield part
    except UnicodeError:
        raise DataError(no_text(path, layout)) from None
    except (OSError, EOFError, zlib.error) as error:
        message = f"{path} cannot be unpacked: {error}"
        raise DataError(message) from None


def _opened(path: Path, layout: Layout) -> IO[bytes]:
    opened: Any = gzip.open if is_zipped(path) else open
    file: IO[bytes] = opened(path, "rb")
    if _name(layout) in ("utf-8", "utf-8-sig"):
        return file
    return _Recoded(file, layout.encoding)  # type: ignore[return-value]


def _name(layout: Layout) -> str:
    return codecs.lookup(layout.encoding).name


class _Recoded:
    """A file in another encoding, read as UTF-8."""

    def __init__(self, file: IO[bytes], encoding: str) -> None:
        self._text = io.TextIOWrapper(file, encoding=encoding, errors=CUT_SIGN, newline="")
        self._rest = b""

    def __enter__(self) -> "_Recoded":
        return self

    def __exit__(self, *_: object) -> None:
        self._text.close()

    def read(self, count: int) -> bytes:
        """So many bytes; fewer at the end."""
        while len(self._rest) < count and (more := self._text.read(count)):
            self._rest += more.encode()
        taken, self._rest = self._rest[:count], self._rest[count:]
        return taken


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


def _records(path: Path, layout: Layout, head: Head, first: int) -> Iterator[Block]:
    """The same, by the rules of quotation marks; slower."""
    marks = Marks(str(path), head.separator, len(head.names), head.is_no_row)
    with below(path, layout, first - 1) as file:
        lines: list[str] = []
        count, at = 0, first
        for _, held in marks.records(file, first, cut=True):
            if count == _RECORDS and not marks.is_cut:  # what is cut is judged by the row before it
                yield Block("".join(lines).encode(), at)
                at += len(lines)
                lines, count = [], 0
            lines += held
            count += 1
        if lines:
            yield Block("".join(lines).encode(), at)
