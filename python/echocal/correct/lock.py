"""One run at a time on one output: a lock that a dead process does not keep."""

import errno
import json
import os
import socket
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import IO

from echocal.errors import UsageError, writing

__all__ = ["locked"]

PATIENCE = 5.0
"""How long the lock of an owner that is gone is waited for [s]."""

try:
    import fcntl
except ImportError:  # Windows
    fcntl = None  # type: ignore[assignment]


@contextmanager
def locked(file: Path) -> Iterator[bool]:
    """Hold a lock for the time of a block.

    The system gives a lock back when its process ends, however it ends. A process that the owner was starting
    when it was killed shares the lock for a moment. So the lock of an owner that is gone is waited for. Where
    the file system has no such locks, the process that the file names must be gone. Raises `UsageError` if
    another process has it; the text names the process.

    Yields
    ------
    bool
        Whether the owner before was killed: it has left its name.
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
