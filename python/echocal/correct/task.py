"""One task: one input file to one output file. Plain data in, plain data out; any ``map`` can run it.

The output has a temporary name of its own until it is complete, so that a task can be run twice, at the same
time too, or be killed at any moment. The same task makes the same file, byte for byte. A task that outlives
its run, on a worker of a cluster, leaves no file in an output that another request has begun anew.
"""

import errno
import tempfile
import time
from collections.abc import Callable, Iterator, Mapping
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from functools import partial
from pathlib import Path
from typing import Any

from echocal._core import __version__
from echocal._interrupt import stop_if_told
from echocal.correct.corrector import Tally
from echocal.correct.inputs import PARQUETS, TEXTS
from echocal.correct.job import Job
from echocal.correct.manifest import check_owner
from echocal.errors import DataError, EchocalError, OutputError, UsageError, unexpected, writing
from echocal.keywords import keyword
from echocal.observations.file import TextFile
from echocal.outputs import WriteError, replacing
from echocal.places import Place, file_digest, place_of, stamp

SCHEMA = "echocal.task/1"
RESULT = "echocal.task_result/1"

_OF_THE_NAME = {
    errno.ENAMETOOLONG,
    errno.EISDIR,
    errno.ENOTDIR,
    errno.EEXIST,
    errno.ELOOP,
    errno.EINVAL,
    errno.EILSEQ,
}
"""Reasons why one output cannot be written, and others can: its name, and what stands in its place."""


def run_task(task: Mapping[str, Any], progress: Callable[[int], None] = lambda rows: None) -> dict[str, Any]:
    """Correct one file.

    The task is plain data, as `echocal.correct.driver.task_of` makes it; of a run over a folder it has
    ``owner``, too, see `echocal.correct.manifest.check_owner`. So is the result: what was done, or under
    ``error`` why the file was set aside. Whatever is wrong with a file never raises. `progress` is told the
    rows of each piece that is done.
    """
    begun = time.perf_counter()
    place, target = place_of(task["source"]), place_of(task["target"])
    result: dict[str, Any] = {
        "schema": RESULT,
        "source": str(place),
        "target": str(target),
        "error": None,
    }
    staged = str(place)
    try:
        refuse_other_version(task, SCHEMA)
        job = Job.of(task)
        before = stamp(place)
        last = partial(check_owner, task.get("owner"))
        with (
            fetched(place) as source,
            replaced(target, last) as unfinished,
            ThreadPoolExecutor(1) as beside,
        ):
            staged = str(source)
            digesting = beside.submit(file_digest, source)
            tally = _correct(source, unfinished, target.name, job, task, progress)
            digest = digesting.result()
            if stamp(place) != before:
                raise DataError(f"{place} was written while it was read; run again when it is complete")
        result |= {
            "input": {**before, "sha256": digest},
            "output": stamp(target),
            "rows": tally.rows,
            "unusable": tally.unusable,
            "marked": tally.marked,
            "first": tally.first,
            "outside": {domain: list(own) for domain, own in tally.outside.items()},
            "columns": tally.columns,
            "types": tally.types,
            "notes": list(tally.notes),
        }
    except BaseException as error:  # of one file: the others go on
        stop_if_told()
        kind, text = _told(error, place)
        result["error"] = {"kind": kind, "text": text.replace(staged, str(place))}
    result["seconds"] = round(time.perf_counter() - begun, 6)
    return result


def refuse_other_version(task: Mapping[str, Any], schema: str) -> None:
    """Raise `UsageError` for a task that another version has made."""
    if task["schema"] != schema or task["version"] != __version__:
        raise UsageError(
            f"the task is of echocal {task['version']} ({task['schema']}), and this process has "
            f"{__version__} ({schema}); install the same version everywhere"
        )


def _told(error: BaseException, place: Place) -> tuple[str, str]:
    """Kind and text of an error."""
    kind = type(error).__name__
    if isinstance(error, OutputError) and error.number in _OF_THE_NAME:
        return "UsageError", str(error)  # which ends no run
    if isinstance(error, EchocalError):
        return kind, str(error)
    if isinstance(error, MemoryError):
        return kind, f"{place}: memory ran out; give less {keyword('memory')}"
    if isinstance(error, OSError):
        return kind, f"{error.filename or place}: {error.strerror or error}"
    return kind, f"{place}: {unexpected(error)}"


def _correct(
    source: Path,
    unfinished: Path,
    target: str,
    job: Job,
    task: Mapping[str, Any],
    progress: Callable[[int], None],
) -> Tally:
    """Correct a file by its kind: what it begins with, and the ending of the output."""
    log = [source if path == task["source"] else Path(path) for path in task["log"]]
    ending = next((own for own in (*TEXTS, *PARQUETS) if target.lower().endswith(own)), "")
    file = TextFile(source, job.reading.layout)
    if file.is_parquet and ending in PARQUETS:
        from echocal.correct.parquet.file import correct_parquet

        return correct_parquet(source, unfinished, job, task["key"], log, progress)
    if not file.is_parquet and ending in TEXTS:
        from echocal.correct.text.file import correct_text

        zipped = ending.endswith(".gz")
        return correct_text(file, unfinished, job, task["key"], log, progress, zipped=zipped)
    if ending in PARQUETS:
        from echocal.correct.text_to_parquet import text_to_parquet

        return text_to_parquet(file, unfinished, job, task["key"], log, progress)
    from echocal.correct.parquet_to_text import parquet_to_text

    return parquet_to_text(source, unfinished, ending, job, task["key"], log, progress)


@contextmanager
def fetched(place: Place) -> Iterator[Path]:
    """Give a file of this machine with the content."""
    if isinstance(place, Path):
        yield place
        return
    with _scratch() as folder:
        place.fetch(folder / place.name)
        yield folder / place.name


@contextmanager
def replaced(place: Place, last: Callable[[], None] = lambda: None) -> Iterator[Path]:
    """Give a file of this machine to write to, and put it in place when it is complete.

    `last` is called right before; what it raises keeps what was there. What is written by
    `echocal.outputs.opened_output` tells errors of its own: any other is of what is read meanwhile.

    Raises `OutputError` if the output cannot be written, and `DataError` if an input cannot be read.
    """
    if isinstance(place, Path):
        with writing(place.parent):
            place.parent.mkdir(parents=True, exist_ok=True)
        with replacing(place, last) as unfinished, _reading():
            yield unfinished
        return
    with _scratch() as folder:
        with writing(folder), _reading():
            yield folder / "unfinished"
        last()
        place.put(folder / "unfinished")


@contextmanager
def _reading() -> Iterator[None]:
    """Tell errors of inputs from those of the output, which pass."""
    try:
        yield
    except WriteError:
        raise
    except OSError as error:
        raise DataError(f"{error.filename or 'the file'} cannot be read: {error.strerror or error}") from None


@contextmanager
def _scratch() -> Iterator[Path]:
    with tempfile.TemporaryDirectory(prefix="echocal-") as folder:
        yield Path(folder)
