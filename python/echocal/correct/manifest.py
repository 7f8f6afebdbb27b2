"""The manifest of a folder of outputs: what is done, with what, and what was set aside; and its lock.

Lines of JSON in ``_echocal/manifest.jsonl``: first what all files have in common, then a line for each file
when it is in its place. A line that a crash cut off is no line. In an object store, where nothing can be
appended, the whole manifest is put anew every few seconds, and at the end.

The first line is also the mark of the owner: a task leaves its output only while the line is that of its run.
The lock is that of one run at a time, and a dead process does not keep it.
"""

import errno
import json
import os
import socket
import time
from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import IO, Any

from echocal.errors import DataError, OutputError, UsageError, writing
from echocal.keywords import keyword
from echocal.model.document import sha256
from echocal.objects import Object
from echocal.outputs import replace_text
from echocal.places import Place, exists, file_digest, place_of, stamp

FOLDER = "_echocal"
_SCHEMA = "echocal.manifest/1"
_FILE = "manifest.jsonl"
_EVERY = 5.0
"""Time between two manifests in an object store [s]: a killed run repeats what it did since; judgement."""
_SHARE = 20.0
"""The same in times that putting one takes; judgement."""
_HEAD = 4096  # bytes that hold the first line
_LINE = {"place", "source", "error"}
"""What a line has of every output."""
_OF_THE_MACHINE = ("memory", "threads")  # options that change no output
PATIENCE = 5.0
"""How long the lock of an owner that is gone is waited for [s]."""

try:
    import fcntl
except ImportError:  # Windows
    fcntl = None  # type: ignore[assignment]


class Manifest:
    """What is done in a folder.

    Raises `UsageError` if the folder was begun with another model, other options or another version.
    `models` is the digest of the model, or of all models. With `force` the folder is begun anew where
    another model or other options were used.
    """

    def __init__(
        self, out: Place, job: Mapping[str, Any], models: str, version: str, *, force: bool = False
    ) -> None:
        self.out = out
        self.file = out / FOLDER / _FILE
        options = {name: own for name, own in job.items() if name not in (*_OF_THE_MACHINE, "models")}
        self._head = {"schema": _SCHEMA, "version": version, "models": models, "options": sha256(options)}
        lines = self._read()
        self._done: dict[str, dict[str, Any]] = {}
        self._twice = False  # whether an output has two lines, as it was made again
        if lines and lines[0] != self._head and not force:
            raise UsageError(self._other(lines[0]))
        if lines and lines[0] == self._head:
            self._done = {line["place"]: line for line in lines[1:]}
        self._put()  # without what a crash cut off
        self.owner = {"folder": str(out), "manifest": str(self.file), "head": self._head}

    def is_done(self, place: str, source: Place) -> bool:
        """Whether an output is in its place, whole, and of this input as it is now."""
        line = self._done.get(place)
        if line is None or line["error"] is not None:
            return False
        target = self.out / place
        try:
            if not exists(target) or stamp(target) != line["output"]:
                return False
            now, then = stamp(source), dict(line["input"])
            digest = then.pop("sha256")
            return now == then or (now["size"] == then["size"] and file_digest(source) == digest)
        except (DataError, OSError):  # its task tells
            return False

    def line(self, place: str) -> dict[str, Any]:
        """What was recorded of an output."""
        return self._done[place]

    def add(self, place: str, result: Mapping[str, Any]) -> None:
        """Record the result of a task; on a disk, it is there when this returns."""
        line = {"place": place, **result}
        self._twice = self._twice or place in self._done
        self._done[place] = line
        if isinstance(self.file, Object):
            if time.monotonic() > self._next:
                self._put_again()
            return
        with writing(self.file), self.file.open("a", encoding="utf-8") as file:
            file.write(json.dumps(line) + "\n")
            file.flush()
            os.fsync(file.fileno())

    def close(self, places: Iterable[str]) -> None:
        """Leave one line for each output. In a store, look whether each is there as this run has put it.

        Raises `OutputError` if another run has begun the folder anew, or has replaced one of the outputs.
        """
        if not isinstance(self.file, Object) or not isinstance(self.out, Object):
            if self._twice:
                self._put()
            return
        self._put_again()
        there = self.out.stamps()
        done = {place: line["output"] for place in places if (line := self._done[place])["error"] is None}
        other = [place for place, own in done.items() if there.get(place) != own and self._is_other(place)]
        if other:
            raise OutputError(
                f"{self.out}: another run replaced {len(other)} of {len(done)} outputs, first {other[0]}; "
                "run again when no other run writes there"
            )

    def _is_other(self, place: str) -> bool:
        target = self.out / place
        return not exists(target) or stamp(target) != self._done[place]["output"]

    def _put_again(self) -> None:
        check_owner(self.owner)
        self._put()

    def _put(self) -> None:
        begun = time.monotonic()
        text = "".join(json.dumps(line) + "\n" for line in (self._head, *self._done.values()))
        if isinstance(self.file, Object):
            self.file.write_text(text)
        else:
            with writing(self.file):
                self.file.parent.mkdir(parents=True, exist_ok=True)
            replace_text(self.file, text)
        now = time.monotonic()
        self._next = now + max(_EVERY, _SHARE * (now - begun))

    def _read(self) -> list[dict[str, Any]]:
        try:
            if isinstance(self.file, Object):
                text = self.file.read_text()
            else:
                text = self.file.read_text(encoding="utf-8", errors="replace")
        except (OSError, DataError):
            return []
        lines: list[dict[str, Any]] = []
        for line in text.split("\n"):
            try:
                own = json.loads(line)
            except ValueError:
                break  # cut off
            known = _LINE if lines else {"schema"}
            if not isinstance(own, dict) or not known <= set(own):
                break  # of somebody else
            lines.append(own)
        return lines if lines and lines[0]["schema"] == _SCHEMA else []

    def _other(self, head: Mapping[str, Any]) -> str:
        what = {
            "models": "another model",
            "options": "other options",
            "version": f"echocal {head.get('version')}",
        }
        other = next((what[name] for name in what if head.get(name) != self._head[name]), "another manifest")
        anew = keyword("force", True)
        return f"{self.out} was begun with {other}; name another output, or begin anew with {anew}"


def check_owner(owner: Mapping[str, Any] | None) -> None:
    """Refuse to write where another run has begun the folder anew since.

    Raises `OutputError` if the first line is another one now, or the manifest is gone. `owner` has the
    ``folder`` of the outputs, the file of the ``manifest``, and ``head``: its first line, as the run has
    written it. None: nobody else can have begun it.
    """
    if owner is None:
        return
    file = place_of(owner["manifest"])
    try:
        text = file.read_text(_HEAD) if isinstance(file, Object) else _first_line(file)
    except (DataError, FileNotFoundError):
        if exists(file):
            raise
        text = ""
    if _line(text.partition("\n")[0]) != owner["head"]:
        message = f"{owner['folder']} was begun anew by another run, or removed; this run leaves it alone"
        raise OutputError(message)


def _first_line(file: Path) -> str:
    with file.open(encoding="utf-8", errors="replace") as lines:
        return lines.readline(_HEAD)


def _line(text: str) -> Any:
    try:
        return json.loads(text)
    except ValueError:
        return None


@contextmanager
def locked(file: Path) -> Iterator[bool]:
    """Hold a lock for the time of a block.

    The system gives a lock back when its process ends, however it ends. A process that the owner was
    starting when it was killed shares the lock for a moment. So the lock of an owner that is gone is waited
    for. Where the file system has no such locks, the process that the file names must be gone. Raises
    `UsageError` if another process has it; the text names the process. Yields whether the owner before was
    killed: it has left its name.
    """
    with writing(file):
        file.parent.mkdir(parents=True, exist_ok=True)
        handle = file.open("a+", encoding="utf-8")
    with handle:
        if not _taken_in_time(handle):
            owner = _owner(handle)
            message = f"{file.parent.parent} is being written by {owner}; wait, or name another output"
            raise UsageError(message)
        killed = bool(_read(handle))
        with writing(file):
            handle.seek(0)
            handle.truncate()
            json.dump({"host": socket.gethostname(), "process": os.getpid()}, handle)
            handle.flush()
        try:
            yield killed
        finally:
            handle.seek(0)
            handle.truncate()
            _give_back(handle)


def _taken_in_time(handle: IO[str]) -> bool:
    """Whether this process has the lock now; waits only while no living process is its owner."""
    end = time.monotonic() + PATIENCE
    while not _taken(handle):
        owner = _read(handle)
        if (owner and _may_live(owner)) or time.monotonic() > end:
            return False
        time.sleep(0.02)
    return True


def _give_back(handle: IO[str]) -> None:
    """Also from a process that is being started and shares the open file."""
    if fcntl is not None:
        with suppress(OSError):
            fcntl.flock(handle, fcntl.LOCK_UN)


def _taken(handle: IO[str]) -> bool:
    if fcntl is not None:
        try:
            fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
            return True
        except OSError as error:
            if error.errno in (errno.EAGAIN, errno.EACCES):
                return False
    owner = _read(handle)
    return not owner or not _may_live(owner)


def _may_live(owner: dict[str, object]) -> bool:
    """On another host it may."""
    return owner["host"] != socket.gethostname() or _lives(int(str(owner["process"])))


def _lives(process: int) -> bool:
    try:
        os.kill(process, 0)
    except ProcessLookupError:
        return False
    except OSError:
        return True
    return True


def _owner(handle: IO[str]) -> str:
    owner = _read(handle)
    return f"process {owner['process']} on {owner['host']}" if owner else "another process"


def _read(handle: IO[str]) -> dict[str, object]:
    handle.seek(0)
    try:
        found = json.load(handle)
    except ValueError:
        return {}
    return found if isinstance(found, dict) and {"host", "process"} <= set(found) else {}
