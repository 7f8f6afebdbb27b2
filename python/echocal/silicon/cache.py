"""A folder of the user's in which what is compiled once is kept."""

import atexit
import os
import shutil
import tempfile
from collections.abc import Callable
from functools import cache
from pathlib import Path

__all__ = ["kept"]


def kept(name: str, fill: Callable[[Path], None]) -> Path:
    """Return a folder of this name; whoever comes first fills it.

    It is complete or absent: two processes that fill it at once each fill their own, and one stays.

    Parameters
    ----------
    name : str
        Name of the folder. It names its content: a hash of what that is made from is part of it.
    fill : callable
        Called with an empty folder, if there is none of this name.
    """
    base = _base()
    folder = base / name
    if folder.is_dir():
        return folder
    unfinished = Path(tempfile.mkdtemp(prefix=".unfinished-", dir=base))
    try:
        fill(unfinished)
        try:
            unfinished.rename(folder)
        except OSError:
            if not folder.is_dir():  # else another process was faster
                raise
    finally:
        shutil.rmtree(unfinished, ignore_errors=True)
    return folder


def _base() -> Path:
    """Return the folder for what is kept: ``ECHOCAL_CACHE``, or by the XDG specification."""
    try:
        base = _wanted()
        base.mkdir(parents=True, exist_ok=True)
    except (OSError, RuntimeError):  # a home that cannot be written to, or none
        return _passing()
    return base if os.access(base, os.W_OK | os.X_OK) else _passing()


def _wanted() -> Path:
    if own := os.environ.get("ECHOCAL_CACHE"):
        return Path(own)
    given = os.environ.get("XDG_CACHE_HOME", "")
    return (Path(given) if given.startswith("/") else Path.home() / ".cache") / "echocal"


@cache
def _passing() -> Path:
    folder = Path(tempfile.mkdtemp(prefix="echocal-"))
    atexit.register(shutil.rmtree, folder, ignore_errors=True)
    return folder
