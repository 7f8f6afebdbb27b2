"""Where rows come from: files that grow, a folder of them, lines of stdin."""

import os
import select
import time
from collections.abc import Iterator
from pathlib import Path
from typing import IO, Any, Protocol

from echocal.errors import DataError, UsageError
from echocal.watch.parser import Batch, Parser
from echocal.watch.state import State

__all__ = ["Files", "Lines", "Source"]

_TEXTS = (".csv", ".tsv", ".jsonl", ".ndjson")
_MOST = 2000  # rows of a batch: what a stop by force repeats at most
_BYTES = 1 << 20  # that are read at a time


class Source(Protocol):
    """Anything that rows come from."""

    def batches(self) -> Iterator[Batch]:
        """Rows, and what is none, as they come; an empty batch while nothing does."""

    def done(self, state: State) -> None:
        """Take the last batch for done, for what is committed next."""


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
                yield Batch()
                continue
            data = os.read(number, _BYTES)
            lines = (rest + data).split(b"\n")
            rest = lines.pop()
            if not data and rest:
                lines, rest = [rest], b""
            yield parser.batch(lines, "stdin")
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
        self._read: dict[str, dict[str, Any]] = {}
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
                    said = "ends within a line, which is read when it is whole"
                    yield Batch(notes=[f"{file} {said}" for file in self._unfinished])
                return
            if idle:
                yield Batch()
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
        at = self._read.get(key) or self.state.position(key) or {"byte": 0}
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
            begin = {"separator": "\t" if file.suffix.lower() == ".tsv" else ","}
            parser = Parser(**(at.get("parser") or begin))
            with file.open("rb") as stream:
                stream.seek(at["byte"])
                while lines := self._lines(stream, file):
                    batch = parser.batch(lines, str(file))
                    at = {"byte": at["byte"] + sum(map(len, lines)), "parser": parser.to_dict()}
                    self.reading = (key, at)
                    self._read[key] = at  # also of lines without a row, which nobody takes for done
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
