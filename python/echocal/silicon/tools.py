"""Compilers and simulators as commands that must succeed in silence, and a folder for what they made."""

import atexit
import os
import shutil
import subprocess
import tempfile
from collections.abc import Callable
from functools import cache
from pathlib import Path

from echocal.errors import EchocalError


def run(*command: str | Path) -> str:
    """Return the standard output of a command. Raises `EchocalError` if it fails, with what it said."""
    code, out, said = attempt(*command)
    if code != 0:
        raise EchocalError(f"{' '.join(map(str, command))}: {(said or out).strip() or f'exit code {code}'}")
    return out


def attempt(*command: str | Path) -> tuple[int, str, str]:
    """Return exit code, standard output and standard error of a command."""
    words = [str(word) for word in command]
    done = subprocess.run(words, capture_output=True, text=True, errors="replace", check=False)
    return done.returncode, done.stdout, done.stderr


def absent(*tools: str) -> list[str]:
    """Return those of the commands that are not installed."""
    return [tool for tool in tools if shutil.which(tool) is None]


def compiler_version(compiler: str) -> str:
    """Return a compiler's version in full, as in ``12.2.1``."""
    # Compilers before version 7 know only the second of the two.
    for asked in ("-dumpfullversion", "-dumpversion"):
        done = subprocess.run([compiler, asked], capture_output=True, text=True, check=False)
        if done.returncode == 0 and done.stdout.strip():
            return done.stdout.strip()
    return "of unknown version"


def kept(name: str, fill: Callable[[Path], None]) -> Path:
    """Return a folder of this name; whoever comes first fills it.

    It is complete or absent: two processes that fill it at once each fill their own, and one stays. A hash
    of what it is made from is part of its name. `fill` is called with an empty folder, if there is none of
    this name.
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
