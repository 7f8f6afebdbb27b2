"""The run over many files: tasks, manifest, resume. `echocal.engines` has who runs the tasks."""

import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path
from typing import Any

from echocal._core import __version__
from echocal._interrupt import stop_if_told
from echocal.correct.inputs import Inputs, Source
from echocal.correct.manifest import FOLDER, Manifest, locked
from echocal.correct.task import RESULT, SCHEMA, run_task
from echocal.engines import Engine
from echocal.engines.worker import check_workers
from echocal.errors import OutputError
from echocal.keywords import as_here
from echocal.objects import Object
from echocal.places import Place, exists, file_digest, place_of, size_of

_STRAY = re.compile(r"\..+\.[0-9a-f]{16}\.unfinished")


@dataclass
class Progress:
    """How far a run is: what is done, and of how much, in files and in bytes of the inputs."""

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
    source: Source,
    target: Place,
    job: Mapping[str, Any],
    digest: str,
    key: str | None,
    log: Sequence[Place],
) -> dict[str, Any]:
    """The task of one file, as plain data."""
    return {
        "schema": SCHEMA,
        "version": __version__,
        "source": str(source.path),
        "target": str(target),
        "key": key,
        "log": [str(path) for path in log],
        "digest": digest,
        "job": dict(job),
    }


def run(
    inputs: Inputs,
    tasks: Mapping[str, Mapping[str, Any]],
    out: Place,
    engine: Engine,
    *,
    force: bool = False,
    progress: Callable[[Progress], None] = lambda state: None,
) -> Summary:
    """Correct the files of a folder, those that are not done yet; call it within `alone`.

    Raises `UsageError` if the folder was begun with another model, it cannot be written, or a worker of the
    engine would do other work than this process. `tasks` has the task of each file by the place of its
    output. With `force` a folder that was begun with another model is begun anew.
    """
    summary = Summary()
    first = next(iter(tasks.values()))
    manifest = Manifest(out, first["job"], first["digest"], __version__, force=force)
    sources = {source.place.as_posix(): source for source in inputs.files}
    left = [place for place, source in sources.items() if not manifest.is_done(place, source.path)]
    summary.skipped = len(sources) - len(left)
    summary.results = {place: manifest.line(place) for place in sources if place not in set(left)}
    sizes = {place: size_of(sources[place].path) for place in left}
    state = Progress(len(left), sum(sizes.values()))
    places = {tasks[place]["target"]: place for place in left}

    def tell(rows: int) -> None:
        state.rows += rows
        progress(state)

    progress(state)
    if left:
        check_workers(engine, question_of(tasks[left[0]], manifest.file))
    owned = [{**tasks[place], "owner": manifest.owner} for place in left]
    for result in run_tasks(engine, owned, tell):
        place = places[result["target"]]
        if (result["error"] or {}).get("kind") == "OutputError":
            raise OutputError(result["error"]["text"])
        manifest.add(place, result)
        stop_if_told()
        summary.results[place] = result
        state.files += 1
        state.bytes += sizes[place]
        progress(state)
    manifest.close(sources)
    return summary


@contextmanager
def alone(out: Place) -> Iterator[bool]:
    """Keep other runs out, and remove what killed ones left behind; a store has neither locks nor strays.

    Raises `UsageError` if another run writes the folder. Yields whether the run before was killed: by one of
    its files, perhaps.
    """
    if isinstance(out, Object):
        yield False
        return
    with locked(out / FOLDER / "lock") as killed:
        sweep(out)
        try:
            yield killed
        finally:
            sweep(out)  # of workers that died


def question_of(task: Mapping[str, Any], written: Place | None = None) -> dict[str, Any]:
    """What every worker must see as this process does: input, models, and what this process has written."""
    question: dict[str, Any] = {
        "files": {task["source"]: size} if (size := size_of(place_of(task["source"]))) else {},
        "models": task["job"]["models"],
        "digest": task["digest"],
    }
    if written is not None:
        question["written"] = [str(written), file_digest(written)]
    return question


def run_tasks(
    engine: Engine, tasks: Sequence[Mapping[str, Any]], tell: Callable[[int], None]
) -> Iterator[dict[str, Any]]:
    """Results of tasks, as they end; `tell` is told the rows that are done."""
    work = partial(run_task, progress=tell) if engine.inside else as_here(run_task)
    for task, result in engine.run(work, tasks):
        if result is None:
            yield _died(task)
            continue
        if not engine.inside:
            tell(result.get("rows", 0))
            if result["error"] is None and not exists(place_of(result["target"])):
                text = f"{task['source']}: a worker wrote {result['target']}, which is absent here"
                result = {**result, "error": {"kind": "OutputError", "text": text}}
        yield result


def _died(task: Mapping[str, Any]) -> dict[str, Any]:
    text = f"{task['source']}: each process that corrected it was killed; too little memory?"
    return {
        "schema": RESULT,
        "source": task["source"],
        "target": task["target"],
        "error": {"kind": "ProcessDied", "text": text},
        "seconds": 0.0,
    }


def sweep(out: Path) -> None:
    """Remove what runs left behind that were killed."""
    for path in out.rglob(".*.unfinished"):
        if _STRAY.fullmatch(path.name):
            path.unlink(missing_ok=True)
