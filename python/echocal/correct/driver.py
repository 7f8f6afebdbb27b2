"""The run over many files: tasks, manifest, resume. Who runs the tasks is another matter (`executors`)."""

import re
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from echocal._core import __version__
from echocal.correct.executors import Executor
from echocal.correct.inputs import Inputs, Source
from echocal.correct.lock import locked
from echocal.correct.manifest import FOLDER, Manifest
from echocal.correct.task import SCHEMA
from echocal.errors import OutputError

__all__ = ["Progress", "Summary", "run", "task_of"]

_STRAY = re.compile(r"\..+\.[0-9a-f]{16}\.unfinished")


@dataclass
class Progress:
    """How far a run is.

    Attributes
    ----------
    files, of_files : int
        Files done, and all that have to be done.
    bytes, of_bytes : int
        The same in bytes of the inputs.
    rows : int
        Rows done.
    """

    of_files: int = 0
    of_bytes: int = 0
    files: int = 0
    bytes: int = 0
    rows: int = 0


@dataclass
class Summary:
    """What a run did.

    Attributes
    ----------
    results : dict of str to dict
        Result of each task by the place of its output; of files that were done before, too.
    skipped : int
        Files that were done before.
    """

    results: dict[str, dict[str, Any]] = field(default_factory=dict)
    skipped: int = 0

    @property
    def set_aside(self) -> dict[str, str]:
        """Files without an output, and why."""
        return {r["source"]: r["error"]["text"] for r in self.results.values() if r["error"] is not None}

    @property
    def rows(self) -> int:
        """Rows of all outputs."""
        return sum(result.get("rows", 0) for result in self.results.values())

    @property
    def unusable(self) -> int:
        """Rows without a distance."""
        return sum(sum(result.get("unusable", {}).values()) for result in self.results.values())


def task_of(
    source: Source, target: Path, job: Mapping[str, Any], key: str | None, log: list[Path]
) -> dict[str, Any]:
    """The task of one file, as plain data."""
    return {
        "schema": SCHEMA,
        "version": __version__,
        "source": str(source.path),
        "target": str(target),
        "key": key,
        "log": [str(path) for path in log],
        "job": dict(job),
    }


def run(
    inputs: Inputs,
    tasks: Mapping[str, Mapping[str, Any]],
    out: Path,
    executor: Executor,
    models: str,
    *,
    force: bool = False,
    progress: Callable[[Progress], None] = lambda state: None,
) -> Summary:
    """Correct the files of a folder, those that are not done yet.

    Parameters
    ----------
    inputs : Inputs
    tasks : mapping of str to dict
        Task of each file by the place of its output.
    out : Path
        Folder of the outputs.
    executor : Executor
    models : str
        Digest of the models.
    force : bool
        Begin anew where the folder was begun with another model.

    Raises
    ------
    UsageError
        If another run writes the folder, it was begun with another model, or it cannot be written.
    """
    summary = Summary()
    with locked(out / FOLDER / "lock"):
        sweep(out)
        job = next(iter(tasks.values()))["job"]
        manifest = Manifest(out, job, models, __version__, force=force)
        sources = {source.place.as_posix(): source for source in inputs.files}
        left = [place for place, source in sources.items() if not manifest.is_done(place, source.path)]
        summary.skipped = len(sources) - len(left)
        summary.results = {place: manifest.line(place) for place in sources if place not in set(left)}
        sizes = {place: _size(sources[place].path) for place in left}
        state = Progress(len(left), sum(sizes.values()))
        places = {tasks[place]["target"]: place for place in left}

        def tell(rows: int) -> None:
            state.rows += rows
            progress(state)

        progress(state)
        for result in executor.run((tasks[place] for place in left), tell):
            place = places[result["target"]]
            if (result["error"] or {}).get("kind") == "OutputError":
                raise OutputError(result["error"]["text"])
            manifest.add(place, result)
            summary.results[place] = result
            state.files += 1
            state.bytes += sizes[place]
            progress(state)
        sweep(out)  # of workers that died
    return summary


def sweep(out: Path) -> None:
    """Remove what runs left behind that were killed."""
    for path in _strays(out):
        path.unlink(missing_ok=True)


def _strays(out: Path) -> Iterator[Path]:
    return (path for path in out.rglob(".*.unfinished") if _STRAY.fullmatch(path.name))


def _size(path: Path) -> int:
    try:
        return path.stat().st_size
    except OSError:
        return 0
