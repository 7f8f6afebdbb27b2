"""Compilers and simulators as commands that must succeed in silence."""

import shutil
import subprocess
from pathlib import Path

from echocal.errors import EchocalError


def run(*command: str | Path) -> str:
    """Return the standard output of a command.

    Raises
    ------
    EchocalError
        If it fails, with what it said.
    """
    code, out, said = attempt(*command)
    if code != 0:
        message = f"{' '.join(map(str, command))}: {(said or out).strip() or f'exit code {code}'}"
        raise EchocalError(message)
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
