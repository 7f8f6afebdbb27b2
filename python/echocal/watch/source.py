"""Where rows come from: files that grow, a folder of them, lines of stdin."""

import os
import select
import time
from collections.abc import Iterator
from pathlib import Path
from typing import IO, Any, Protocol

from echocal.errors import DataError, UsageError
from echocal.observations.layout import Layout
from echocal.observations.limits import LINE, too_long
from echocal.watch.parser import Batch, Parser
from echocal.watch.state import State

_JSON = (".jsonl", ".ndjson")
_TEXTS = (".csv", ".tsv", *_JSON)
_BYTES = 1 << 20  # that are read at a time


class Source(Protocol):
    """Anything that rows come from."""

    def batches(self) -> Iterator[Batch]:
        """Rows, and what is none, as they come; an empty batch while nothing does."""

    def done(self, state: State) -> None:
        """Take the last batch for done, for what is committed next."""

    def empty(self) -> str:
        """Why no row has come."""


class Lines:
    """Lines of a stream, such as stdin.

    `wait` is the longest wait for the next line before an empty batch [s].
    """

    def __init__(self, stream: IO[bytes], wait: float, layout: Layout | None = None) -> None:
        self.stream, self.wait, self.layout = stream, wait, layout or Layout()

    def batches(self) -> Iterator[Batch]:
        """Rows of whole lines; a stream that cannot be continued keeps no position."""
        parser, rest, number = Parser("stdin", self.layout), b"", self.stream.fileno()
        while True:
            ready = select.select([number], [], [], self.wait)[0]
            if not ready:
                yield Batch()
                continue
            data = os.read(number, _BYTES)
            rest += data
            for batch, size in parser.batches(rest, final=not data):
                rest = rest[size:]
                yield batch
            if not data:
                return
            if len(rest) > LINE:
                raise too_long("stdin", parser.line + 1)

    def done(self, state: State) -> None:
        """Nothing to keep."""

    def empty(self) -> str:
        """Why no row has come."""
        return "stdin ended without a row"


class Files:
    """A file that grows, or all files of a folder, which grow or are added; in the order of their names.

    `poll` is the wait between two looks [s]. With `once` it ends with what there is now; without a file for
    the state a last line without an end is then whole.
    """

    def __init__(
        self, path: Path, state: State, poll: float, *, once: bool, layout: Layout | None = None
    ) -> None:
        if not path.exists():
            raise UsageError(f"{path} does not exist; to wait for files give their folder")
        if path.is_file() and path.suffix.lower() not in _TEXTS:
            raise UsageError(f"{path} cannot be watched; endings of growing files: {', '.join(_TEXTS)}")
        self.path, self.state, self.poll, self.once = path, state, poll, once
        self.layout = layout or Layout()
        self._whole = once and state.path is None
        self._unfinished: dict[Path, str] = {}
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
                    yield Batch(notes=[f"{file} {said}" for file, said in self._unfinished.items()])
                return
            if idle:
                yield Batch()
                time.sleep(self.poll)

    def done(self, state: State) -> None:
        """Keep how far the file of the last batch is read."""
        if self.reading is not None:
            state.set_position(*self.reading)

    def empty(self) -> str:
        """Why no row has come; nothing where a note says it, of a file that the next start continues."""
        files = self._files()
        if self._unfinished:
            return ""
        if not files:
            return f"{self.path} has no file to watch; endings: {', '.join(_TEXTS)}"
        held = next((file for file in files if file.stat().st_size), None)
        return f"{files[0]} is empty" if held is None else f"{held} has no row, or none below a header"

    def _files(self) -> list[Path]:
        if self.path.is_file():
            return [self.path]
        found = (file for file in self.path.rglob("*") if file.suffix.lower() in _TEXTS and file.is_file())
        return sorted(
            file for file in found if not any(part[0] in "._" for part in file.relative_to(self.path).parts)
        )

    def _news(self, file: Path) -> Iterator[Batch]:
        key = str(file.resolve())
        at = self._read.get(key) or self.state.position(key) or {"byte": 0}
        try:
            size = file.stat().st_size
            if size < at["byte"]:
                raise DataError(
                    f"{file} became shorter ({at['byte']} bytes were read, it has {size}): it was replaced "
                    "or cut; give new rows a new file"
                )
            if size == at["byte"]:
                return
            parser = Parser(
                str(file), self.layout, only_json=file.suffix.lower() in _JSON, kept=at.get("parser")
            )
            with file.open("rb") as stream:
                asked = _BYTES
                while at["byte"] < size:
                    stream.seek(at["byte"])
                    data = stream.read(asked)
                    ended = len(data) < asked
                    for batch, taken in parser.batches(data, final=ended and self._whole):
                        at = {"byte": at["byte"] + taken, "parser": parser.to_dict()}
                        self.reading = (key, at)
                        self._read[key] = at  # also of lines without a row, which nobody takes for done
                        asked = _BYTES
                        yield batch
                    if ended:
                        break
                    if stream.tell() - len(data) == at["byte"] and asked > LINE:
                        raise too_long(file, parser.line + 1)
                    asked *= 2 if stream.tell() - len(data) == at["byte"] else 1
        except OSError as error:
            raise DataError(f"{file} cannot be read: {error.strerror or error}") from None
        self._unfinished.pop(file, None)
        if at["byte"] < size:
            what = "ends within a line, which is read when it is whole"
            self._unfinished[file] = what if parser.begun else "has no row below a header so far"
