"""One file: what it begins with is seen once, and handed on to all that read it."""

import codecs
import gzip
import io
import zlib
from collections.abc import Iterator
from contextlib import contextmanager
from functools import cached_property
from itertools import islice
from pathlib import Path
from typing import IO, Any, TextIO

from echocal.errors import DataError, reading
from echocal.observations.heading import FIRST, head_in
from echocal.observations.layout import CUT_SIGN, Head, Layout, said_no_text, seen_in
from echocal.observations.limits import Guarded

_SAMPLE = 1 << 20  # bytes that show the encoding
_ZIPPED = b"\x1f\x8b"
_PARQUET = b"PAR1"
_SPREADSHEETS = (b"PK\x03\x04", b"\xd0\xcf\x11\xe0\xa1\xb1\x1a\xe1")
_NO_TABLE = {
    b"ARRO": "an Arrow (Feather) file; save it as Parquet, or read it with pyarrow and pass the table",
    b"\x89HDF": "an HDF5 or NetCDF file; read it with xarray or pandas and pass the table",
    b"CDF": "a NetCDF file; read it with xarray and pass the dataset",
    b'"TOB': "binary data of a Campbell logger; convert it to TOA5 with CardConvert (LoggerNet, PC400)",
    b"SQLi": "an SQLite database; save the table as CSV",
}
"""What files begin with that are no table of text."""

ULOG, BAG = "a ULog of PX4", "a bag of ROS"
_RECORDINGS = {b"ULog\x01\x12\x35": ULOG, b"#ROSBAG ": BAG, b"\x89MCAP0\r\n": BAG}
_DATABASE = ".db3"  # of ROS 2: SQLite, which other programs use, too


class TextFile:
    """A file of a table: text, gzipped or not, unless its first bytes say otherwise.

    Its layout has the encoding that was seen. Raises `DataError` if it cannot be opened, is of a kind that is
    not read, or does not begin as text does.
    """

    def __init__(self, path: Path, layout: Layout) -> None:
        self.path, self.layout = path, layout
        self.above: list[str] = []  # lines that the layout skips
        self.first: list[str] = []  # the lines below, as far as a format or a header is looked for
        with _opened(path) as file:
            begins = self._begins = file.read(8)
            self.is_zipped = begins.startswith(_ZIPPED)
            self.is_parquet, self.is_spreadsheet = begins[:4] == _PARQUET, begins.startswith(_SPREADSHEETS)
            # what a person calls it where it is a recording of messages; else empty
            self.recording = _recording(path, begins)
            if self.recording:
                return
            for start, told in _NO_TABLE.items():
                if begins.startswith(start):
                    raise DataError(f"{path} is {told}")
            if not (self.is_parquet or self.is_spreadsheet):
                with self._unpacked(file) as data:
                    self._look(data)

    def _look(self, data: IO[bytes]) -> None:
        sample = data.read(_SAMPLE)
        self._begins, self.layout = sample[:3], seen_in(sample, self.layout)
        with self.below(data, 0) as text:
            self.above = list(islice(text, self.layout.skip_lines))
            self.first = list(islice(text, FIRST))

    @cached_property
    def head(self) -> Head:
        """The header of delimited text; the separator is the one that it has most of.

        Raises `DataError` if the file is not delimited text.
        """
        return head_in(list(self.first), self.layout, str(self.path))

    @property
    def mark(self) -> bytes:
        """The mark of UTF-8 that it begins with and that is no part of its text; empty without one."""
        is_apart = codecs.lookup(self.layout.encoding).name == "utf-8-sig"
        return self._begins if is_apart and self._begins == codecs.BOM_UTF8 else b""

    @cached_property
    def prelude(self) -> list[str]:
        """The lines above the rows of delimited text, with their ends."""
        return [*self.above, *self.first][: self.head.start]

    @contextmanager
    def opened(self) -> Iterator[IO[bytes]]:
        """Open it for its bytes, unpacked.

        Raises `DataError` if they cannot be unpacked, or are decoded meanwhile and are no text.
        """
        with _opened(self.path) as file, self._unpacked(file) as data:
            yield data

    @contextmanager
    def _unpacked(self, file: IO[bytes]) -> Iterator[IO[bytes]]:
        if not file.seekable():
            raise DataError(f"{self.path} gives its bytes once (a pipe): write them to a file, and give that")
        file.seek(0)
        try:
            yield gzip.GzipFile(fileobj=file) if self.is_zipped else file  # type: ignore[misc]
        except UnicodeError:
            raise self.no_text() from None
        except (OSError, EOFError, zlib.error) as error:
            raise DataError(f"{self.path} cannot be unpacked: {error}") from None

    @contextmanager
    def below(self, data: IO[bytes], lines: int) -> Iterator[TextIO]:
        """The text of its bytes below so many lines."""
        data.seek(0)
        guarded: Any = Guarded(data, self.path)
        text = io.TextIOWrapper(guarded, self.layout.encoding, CUT_SIGN, newline="")
        try:
            for _ in islice(text, lines):
                pass
            yield text
        finally:
            text.detach().detach()  # or the bytes would be closed with it

    def no_text(self) -> DataError:
        """An error that says that it is not text in its encoding."""
        return DataError(said_no_text(str(self.path), self.layout.encoding, self._begins))


def _recording(path: Path, begins: bytes) -> str:
    """What a person calls a recording of messages, by its first bytes; empty for another file."""
    found = next((kind for start, kind in _RECORDINGS.items() if begins.startswith(start)), "")
    return BAG if begins.startswith(b"SQLite") and path.suffix == _DATABASE else found


def is_parquet(path: Path) -> bool:
    """Whether a file begins as Parquet does. Raises `DataError` if it cannot be opened."""
    with _opened(path) as file:
        return file.read(4) == _PARQUET


def _opened(path: Path) -> IO[bytes]:
    """A file that is not empty."""
    with reading(path):
        file = path.open("rb")
        is_empty = not file.peek(1)
    if is_empty:
        file.close()
        raise DataError(f"{path} is empty")
    return file
