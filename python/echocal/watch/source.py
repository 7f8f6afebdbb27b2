"""Where rows come from: files that grow, a folder of them, lines of stdin."""

import csv
import json
import os
import select
import time
from collections.abc import Iterator
from pathlib import Path
from typing import IO, Any, Protocol

from echocal.errors import DataError, UsageError
from echocal.watch.rows import Row
from echocal.watch.state import State

__all__ = ["Files", "Lines", "Source", "parsed"]

_TEXTS = (".csv", ".tsv", ".jsonl", ".ndjson")
_MOST = 2000  # rows of a batch: what a stop by force repeats at most
_BYTES = 1 << 20  # that are read at a time

Batch = tuple[list[Row], list[str]]


class Source(Protocol):
    """Anything that rows come from."""

    def batches(self) -> Iterator[Batch]:
        """Rows, and why a line is none, as they come; an empty batch while nothing does."""

    def done(self, state: State) -> None:
        """Take the last batch for done, for what is committed next."""


class Parser:
    """From lines to rows: JSON where a line begins with a brace, else fields below a header."""

    def __init__(self, separator: str = ",", header: list[str] | None = None) -> None:
        self.separator, self.header = separator, header

    def row(self, line: str) -> tuple[Row | None, str]:
        """A row, or why the line is none; neither for a header or an empty line."""
        text = line.strip("\r\n\ufeff")
        if not text.strip() or text.startswith("#"):
            return None, ""
        if text.lstrip().startswith("{"):
            return parsed(text)
        fields = next(csv.reader([text], delimiter=self.separator))
        if self.header is None or fields == self.header:
            if self.header is None and ";" in text and len(fields) == 1:
                self.separator = ";"
                fields = next(csv.reader([text], delimiter=";"))
            self.header = [field.strip() for field in fields]
            if len(set(self.header)) < len(self.header):
                message = f"the header names a column twice: {text[:200]}"
                raise DataError(message)
            return None, ""
        if len(fields) != len(self.header):
            return None, f"a line has {len(fields)} fields, its header {len(self.header)}: {text[:80]}"
        return dict(zip(self.header, fields, strict=True)), ""


def parsed(text: str) -> tuple[Row | None, str]:
    """A row from a JSON object, or why there is none.

    Examples
    --------
    >>> from echocal.watch.source import parsed
    >>> parsed('{"echo_us": 11660}'), parsed("[1]")
    (({'echo_us': 11660}, ''), (None, 'a line is no JSON object: [1]'))
    """
    try:
        row = json.loads(text)
    except ValueError:
        row = None
    return (row, "") if isinstance(row, dict) and row else (None, f"a line is no JSON object: {text[:80]}")


class Lines:
    """Lines of a stream, such as stdin.

    Parameters
    ----------
    stream : binary file
    wait : float
        Longest wait for the next line before an empty batch [s].
    """

    def __init__(self, stream: IO[bytes], wait: float) -> None:
        self.stream, self.wait = stream, wait

    def batches(self) -> Iterator[Batch]:
        """Rows of whole lines; a stream that cannot be continued keeps no position."""
        parser, rest, number = Parser(), b"", self.stream.fileno()
        while True:
            ready = select.select([number], [], [], self.wait)[0]
            if not ready:
                yield [], []
                continue
            data = os.read(number, _BYTES)
            lines = (rest + data).split(b"\n")
            rest = lines.pop()
            if not data and rest:
                lines, rest = [rest], b""
            yield _rows(parser, lines)
            if not data:
                return

    def done(self, state: State) -> None:
        """Nothing to keep."""


class Files:
    """A file that grows, or all files of a folder, which grow or are added; in the order of their names.

    Parameters
    ----------
    path : Path
    state : State
        Knows how far each was read.
    poll : float
        Wait between two looks [s].
    once : bool
        End with what there is now; a last line without an end is then whole.
    """

    def __init__(self, path: Path, state: State, poll: float, *, once: bool) -> None:
        if not path.exists():
            message = f"{path} does not exist; to wait for files give their folder"
            raise UsageError(message)
        if path.is_file() and path.suffix.lower() not in _TEXTS:
            message = f"{path} cannot be watched; endings of growing files: {', '.join(_TEXTS)}"
            raise UsageError(message)
        self.path, self.state, self.poll, self.once = path, state, poll, once
        self._unfinished: dict[Path, None] = {}
        self.reading: tuple[str, dict[str, Any]] | None = None

    def batches(self) -> Iterator[Batch]:
        """Rows of whole lines, file by file."""
        while True:
            idle = True
            for file in self._files():
                for batch in self._news(file):
                    idle = False
                    yield batch
            if idle and self.once:
                if self._unfinished:
                    yield (
                        [],
                        [
                            f"{file} ends within a line, which is read when it is whole"
                            for file in self._unfinished
                        ],
                    )
                return
            if idle:
                yield [], []
                time.sleep(self.poll)

    def done(self, state: State) -> None:
        """Keep how far the file of the last batch is read."""
        if self.reading is not None:
            state.set_position(*self.reading)

    def _files(self) -> list[Path]:
        if self.path.is_file():
            return [self.path]
        found = (file for file in self.path.rglob("*") if file.suffix.lower() in _TEXTS and file.is_file())
        return sorted(file for file in found if not any(part[0] in "._" for part in self._inside(file)))

    def _inside(self, file: Path) -> tuple[str, ...]:
        return file.relative_to(self.path).parts

    def _news(self, file: Path) -> Iterator[Batch]:
        key = str(file.resolve())
        at = self.state.position(key) or {"byte": 0, "header": None, "separator": None}
        try:
            size = file.stat().st_size
            if size < at["byte"]:
                message = (
                    f"{file} became shorter ({at['byte']} bytes were read, it has {size}): it was replaced "
                    "or cut; give new rows a new file"
                )
                raise DataError(message)
            if size == at["byte"]:
                return
            separator = at["separator"] or ("\t" if file.suffix.lower() == ".tsv" else ",")
            parser = Parser(separator, at["header"])
            with file.open("rb") as stream:
                stream.seek(at["byte"])
                while lines := self._lines(stream, file):
                    batch = _rows(parser, lines)
                    at = {
                        "byte": at["byte"] + sum(map(len, lines)),
                        "header": parser.header,
                        "separator": parser.separator,
                    }
                    self.reading = (key, at)
                    yield batch
        except OSError as error:
            message = f"{file} cannot be read: {error.strerror or error}"
            raise DataError(message) from None

    def _lines(self, stream: IO[bytes], file: Path) -> list[bytes]:
        lines = []
        for _ in range(_MOST):
            line = stream.readline()
            if not line:
                break
            if not line.endswith(b"\n") and (not self.once or self.state.path is not None):
                self._unfinished[file] = None
                break  # a line that is still being written is read when it is whole
            lines.append(line)
        return lines


def _rows(parser: Parser, lines: list[bytes]) -> Batch:
    rows: list[Row] = []
    wrong = []
    for line in lines:
        row, why = parser.row(line.decode("utf-8", errors="replace"))
        if row is not None:
            rows.append(row)
        if why:
            wrong.append(why)
    return rows, wrong
