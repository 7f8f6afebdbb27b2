"""Files of a run: complete or absent, in a folder that only one run writes to."""

import gzip
import hashlib
import json
import secrets
import shutil
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from echocal.correct.lock import locked
from echocal.correct.manifest import FOLDER
from echocal.errors import OutputError, UsageError, writing
from echocal.keywords import keyword
from echocal.places import file_digest

__all__ = ["Store", "put"]

_JOB = "job.json"


def put(path: Path, data: bytes) -> str:
    """Write a file, complete or not at all, and return its SHA-256.

    It does not wait for the disk: who trusts the file later compares the SHA-256.
    """
    unfinished = path.with_name(f".{path.name[:50]}.{secrets.token_hex(8)}.unfinished")
    with writing(path):
        try:
            unfinished.write_bytes(data)
            unfinished.replace(path)
        finally:
            unfinished.unlink(missing_ok=True)
    return hashlib.sha256(data).hexdigest()


class Store:
    """The folder with what a run has finished."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self.job = folder / _JOB

    @contextmanager
    def locked(self) -> Iterator[None]:
        """Keep other runs out; the lock ends with the process, however it ends.

        Raises `UsageError` if another run has the folder.
        """
        with locked(self.folder / FOLDER / "lock"):
            yield

    def begin(self, job: Mapping[str, Any], force: bool) -> None:
        """Record what the run is, or find that it is the one that was begun.

        Raises `UsageError` if the folder has another run.
        """
        if self.job.exists():
            before = _json(self.job)
            if before == job:
                return
            if not force:
                differing = ", ".join(sorted(k for k in {*before, *job} if before.get(k) != job.get(k)))
                message = (
                    f"{self.folder} has the unfinished run of another request (it differs in: {differing}); "
                    f"repeat that request to finish it, or start anew with {keyword('force', True)}"
                )
                raise UsageError(message)
            self.clear()
        put(self.job, json.dumps(job, indent=1, sort_keys=True).encode())

    def check(self, run: str | None) -> None:
        """Refuse to write for a run that this folder is not of any more: its task has outlived it.

        Raises `OutputError` if another run has begun since, or the run has ended.

        Parameters
        ----------
        run : str or None
            SHA-256 of the file that says what the run is; None: nobody else can have the folder.
        """
        if run is not None and (not self.job.is_file() or file_digest(self.job) != run):
            message = f"{self.folder} was begun anew by another run, or has ended; this run leaves it alone"
            raise OutputError(message)

    def finished(self, number: int) -> list[dict[str, Any]] | None:
        """What a task has left, None if it is not finished or damaged."""
        try:
            content: list[dict[str, Any]] = json.loads(gzip.decompress(self.path(number).read_bytes()))
        except (OSError, EOFError, ValueError):
            return None
        return content

    def path(self, number: int) -> Path:
        """File of a task's results."""
        return self.folder / f"{number:07d}.json.gz"

    def clear(self) -> None:
        """Remove what the run has finished, and unfinished files of killed processes."""
        for file in self.folder.iterdir():
            if file.name.endswith((".json.gz", ".unfinished")) or file.name == _JOB:
                file.unlink(missing_ok=True)
        shutil.rmtree(self.folder / "rows", ignore_errors=True)

    def remove(self) -> None:
        """Remove the folder, if nothing else is in it."""
        self.clear()
        (self.folder / FOLDER / "lock").unlink(missing_ok=True)
        try:
            (self.folder / FOLDER).rmdir()
            self.folder.rmdir()
        except OSError:
            return


def _json(file: Path) -> dict[str, Any]:
    try:
        content = json.loads(file.read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return {}
    return content if isinstance(content, dict) else {}
