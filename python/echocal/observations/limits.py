"""What a file may be at most: each limit is held where bytes enter, before anything looks for a meaning."""

import codecs
import io
import json
from collections.abc import Iterable
from typing import IO, Any

from echocal.errors import DataError

LINE = 1 << 22
"""Bytes of a line, or of a quoted field with the lines in it: 16,384 columns of 256 bytes; judgement."""

WHOLE = 1 << 26
"""Bytes of a line of JSON, which may be a whole document: that of 600,000 records; judgement."""

LOG_LINE = 1 << 12
"""Characters of a line of a log without separators, beyond which it holds no value. The longest known has
365. Words are searched in it, in a time that grows with its square: 0.3 s for 16,000 characters, measured.
The limit is a judgement."""

NAME = 1000
"""Characters of a column's name: units are searched in it, in a time that grows with its square: 6.5 s for
4000 brackets, over 60 s for 60,000, measured; the limit is a judgement."""

COLUMNS = 1 << 14
"""Columns of a table: as many as a spreadsheet has."""

DEPTH = 100
"""Lists and objects in each other in JSON: what writes them again stands on a stack of its own."""

CELLS = 20_000_000
"""Cells of a table, with or without a value, where most have none: a judgement, not measured."""


def too_long(path: object, number: int, most: int = LINE) -> DataError:
    """An error for a line that is none."""
    message = (
        f"{path}: line {number} has more than {most:,} bytes, which no line of a table of measurements "
        "has: the file is damaged, or another kind of file"
    )
    if most == WHOLE:
        message = f"{path}: line {number} has more than {most:,} bytes: write one record of JSON a line"
    return DataError(message)


class Guarded(io.BufferedIOBase):
    """A binary file that refuses a line that is too long when it is met, not when it is in memory.

    A document of JSON may be one line, so that its lines may be longer. Raises `DataError` with the path and
    the number of the line.
    """

    def __init__(self, file: IO[bytes], path: object) -> None:
        self._file: Any = file
        self._path, self._most, self._run = path, 0, 0
        self._ends = {b"\n": 0, b"\r": 0}

    def readable(self) -> bool:
        """It is read."""
        return True

    def seekable(self) -> bool:
        """It can begin anew."""
        return True

    def seek(self, place: int, whence: int = 0, /) -> int:
        """Begin anew."""
        if place or whence:
            raise io.UnsupportedOperation("only to the begin")
        self._run, self._ends = 0, dict.fromkeys(self._ends, 0)
        self._file.seek(0)
        return 0

    def read1(self, size: int = -1, /) -> bytes:
        """Some bytes."""
        return self._seen(self._file.read1(size))

    def read(self, size: int | None = -1, /) -> bytes:
        """So many bytes; fewer at the end."""
        if size is not None and size >= 0:
            return self._seen(self._file.read(size))
        return b"".join(iter(lambda: self.read1(1 << 20), b""))

    def detach(self) -> Any:
        """The file, which is no longer closed with this one."""
        file, self._file = self._file, io.BytesIO()
        return file

    def close(self) -> None:
        """Close the file."""
        self._file.close()
        super().close()

    def _seen(self, data: bytes) -> bytes:
        if not self._most:
            begins = data.lstrip(codecs.BOM_UTF8 + codecs.BOM_UTF16_LE + b"\0 \t\r\n")[:1]
            self._most = WHOLE if begins in (b"[", b"{") else LINE
        end = b"\n" if b"\n" in data else b"\r"
        first = data.find(end)
        if self._run + (len(data) if first < 0 else first) > self._most:
            raise too_long(self._path, 1 + (self._ends[b"\n"] or self._ends[b"\r"]), self._most)
        self._ends[end] += data.count(end)
        self._run = self._run + len(data) if first < 0 else len(data) - data.rfind(end) - 1
        return data


def refuse_names(names: Iterable[object], where: object) -> None:
    """Refuse too many columns, or a name that is too long to be one.

    Raises `DataError` with the place of the column.
    """
    held = list(names)
    if len(held) > COLUMNS:
        raise DataError(
            f"{where} has {len(held):,} columns, and {COLUMNS:,} are the most; keep those that are needed"
        )
    for place, name in enumerate(held, 1):
        if isinstance(name, str) and len(name) > NAME:
            raise DataError(
                f"{where}: the name of column {place} has {len(name):,} characters ('{name[:40]}...'), and "
                f"{NAME:,} are the most; shorten it"
            )


def refuse_cells(rows: int, columns: int, filled: int, where: object) -> None:
    """Refuse a table that is almost empty, and so large that it would fill the memory.

    Raises `DataError` with its size.
    """
    if rows * columns > max(CELLS, 10 * filled):
        raise DataError(
            f"{where} has {rows:,} rows and {columns:,} columns, so {rows * columns:,} cells, of which "
            f"{filled:,} have a value; {CELLS:,} are the most where so few have one: remove what is far from "
            "the table, or save the table alone as CSV"
        )


def from_json(text: str, **options: Any) -> Any:
    """What a JSON text holds.

    Raises `ValueError` if it is no JSON, or has lists and objects in each other beyond the limit.

    Examples
    --------
    >>> from_json('{"echo_us": 11660}')
    {'echo_us': 11660}
    """
    deep = f"nested more than {DEPTH} deep"
    try:
        found = json.loads(text, **options)
    except RecursionError:
        raise ValueError(deep) from None
    level, depth = [found], 0
    while level and depth <= DEPTH:
        inner = [one for one in level if isinstance(one, dict | list)]
        level = [item for one in inner for item in (one.values() if isinstance(one, dict) else one)]
        depth += bool(inner)
    if depth > DEPTH:
        raise ValueError(deep)
    return found
