"""Files that grow with a watch: what a stop by force left beyond the last commit is cut off again."""

import csv
import json
import os
from collections.abc import Iterable, Sequence
from pathlib import Path
from types import SimpleNamespace
from typing import Any, TextIO

from echocal.errors import DataError, writing
from echocal.watch.events import finite
from echocal.watch.rows import Row
from echocal.watch.state import State


class Growing:
    """A text file to which lines are appended.

    The state knows its committed length; with `append` lines of another watch stay.
    """

    def __init__(self, path: Path, state: State, *, append: bool = False) -> None:
        self.path, self._key = path, f"output {path.resolve()}"
        kept = state.position(self._key)
        with writing(path):
            old = (append or kept is not None) and path.exists()
            self._file = path.open("r+b" if old else "wb")
            size = os.fstat(self._file.fileno()).st_size
            if kept is not None and size < kept["byte"]:
                message = f"{path} has {size} bytes; the state says that {kept['byte']} were written to it"
                raise DataError(message)
            self._whole = size if append and kept is None else 0 if kept is None else kept["byte"]
            self.back()
        self.kept = kept

    def write(self, text: str) -> None:
        """Append a text."""
        with writing(self.path):
            self._file.write(text.encode("utf-8"))

    def done(self, state: State, **more: Any) -> None:
        """Make it lasting, and keep its length for the next commit."""
        if self._file.tell() != self._whole:
            self.flush()
        self._whole = self._file.tell()
        state.set_position(self._key, {"byte": self._whole, **more})

    def flush(self) -> None:
        """Make it lasting; the next start takes it back."""
        with writing(self.path):
            self._file.flush()
            os.fsync(self._file.fileno())

    def back(self) -> None:
        """Take back what is not done."""
        with writing(self.path):
            self._file.flush()
            self._file.truncate(self._whole)
            self._file.seek(0, os.SEEK_END)

    def close(self) -> None:
        """Close the file."""
        self._file.close()


class Table:
    """Corrected rows: CSV, or JSON lines where the name ends in .jsonl or .ndjson."""

    def __init__(self, path: Path, state: State) -> None:
        self._lines = path.suffix.lower() in {".jsonl", ".ndjson"}
        self._file = Growing(path, state)
        self.path = path
        self._header: list[str] | None = (self._file.kept or {}).get("header")
        self._done = self._header

    def write(self, rows: list[Row]) -> None:
        """Append rows. Raises `DataError` if a row has a column that the header of a CSV file has not."""
        if self._lines:
            self._file.write(_json_lines(rows))
            return
        for row in rows:
            if why := self.refusal(list(row)):
                raise DataError(why)
        header = self._header or []
        fields = (["" if row.get(name) is None else row[name] for name in header] for row in rows)
        self._file.write(_csv(fields))

    def refusal(self, names: list[str]) -> str:
        """Why a row with such columns cannot be written; empty if it can. The first one makes the header."""
        if self._lines:
            return ""
        if self._header is None:
            self._header = names
            self._file.write(_csv([names]))
        new = [name for name in names if name not in self._header]
        if not new:
            return ""
        return (
            f"a row has a column '{new[0]}' that the header of {self.path} has not; rows with "
            "different columns need JSON lines: -o NAME.jsonl"
        )

    def done(self, state: State) -> None:
        """Make it lasting."""
        self._file.done(state, header=self._header)
        self._done = self._header

    def flush(self) -> None:
        """Make it lasting; the next start takes it back."""
        self._file.flush()

    def back(self) -> None:
        """Take back what is not done."""
        self._file.back()
        self._header = self._done

    def close(self) -> None:
        """Close the file."""
        self._file.close()


class Stream:
    """Corrected rows as JSON lines on a stream, which keeps no position."""

    def __init__(self, stream: TextIO) -> None:
        self._stream, self._rows = stream, ""

    def write(self, rows: list[Row]) -> None:
        """Take rows."""
        self._rows += _json_lines(rows)

    def done(self, state: State) -> None:
        """Pass them on; there is nothing to keep."""
        self._stream.write(self._rows)
        self._stream.flush()
        self._rows = ""

    def back(self) -> None:
        """Take back what is not done."""
        self._rows = ""


def _csv(rows: Iterable[Sequence[Any]]) -> str:
    lines: list[str] = []
    writer = csv.writer(
        SimpleNamespace(write=lines.append), lineterminator="\r\n"
    )  # it quotes what has one of both
    writer.writerows(rows)
    return "".join(f"{line[:-2]}\n" for line in lines)


def _json_lines(rows: list[Row]) -> str:
    """Rows as JSON, in which a number that is none is null."""
    return "".join(json.dumps(finite(dict(row)), default=str) + "\n" for row in rows)
