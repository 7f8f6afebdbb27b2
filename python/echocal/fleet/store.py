"""Files of a run: complete or absent, in a folder that only one run writes to.

Files of many sensors are divided: each input row is read once, and a task reads the rows of its sensors.
Without this, each task would read every file that has a row of its sensors: a fleet in daily files would be
read as often as there are tasks. A piece holds the rows of some input files that belong to one bucket, a few
tasks.
"""

import gzip
import hashlib
import json
import secrets
import shutil
from collections.abc import Iterator, Mapping, Sequence
from contextlib import AbstractContextManager, contextmanager
from pathlib import Path
from typing import Any

from echocal.correct.manifest import FOLDER, locked
from echocal.errors import DataError, OutputError, UsageError, writing
from echocal.fleet.index import Sensor
from echocal.fleet.tables import Frame, label, opened, polars
from echocal.keywords import keyword
from echocal.observations.file import is_parquet
from echocal.observations.layout import Layout
from echocal.places import file_digest

_JOB = "job.json"
KEY = "_echocal_key"
PLACE = "_echocal_file"

_READS = 3
"""Times that all rows may be read before dividing them takes less; judgement."""

_PIECES = 50_000
"""Files that a division makes at most; a bucket then has several tasks."""


def put(path: Path, data: bytes) -> str:
    """Write a file, complete or not at all, and return its SHA-256.

    It does not wait for the disk: who trusts the file later compares the SHA-256.
    """
    with _unfinished(path) as unfinished:
        unfinished.write_bytes(data)
    return hashlib.sha256(data).hexdigest()


@contextmanager
def _unfinished(path: Path) -> Iterator[Path]:
    """A file to write, which is then put in its place."""
    unfinished = path.with_name(f".{path.name[:50]}.{secrets.token_hex(8)}.unfinished")
    with writing(path):
        try:
            yield unfinished
            unfinished.replace(path)
        finally:
            unfinished.unlink(missing_ok=True)


class Store:
    """The folder with what a run has finished."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self.job = folder / _JOB

    def locked(self) -> AbstractContextManager[bool]:
        """Keep other runs out; see `echocal.correct.manifest.locked`."""
        return locked(self.folder / FOLDER / "lock")

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
                raise UsageError(
                    f"{self.folder} has the unfinished run of another request (it differs in: {differing}); "
                    f"repeat that request to finish it, or start anew with {keyword('force', True)}"
                )
            self.clear()
        put(self.job, json.dumps(job, indent=1, sort_keys=True).encode())

    def check(self, run: str | None) -> None:
        """Refuse to write for a run that this folder is not of any more: its task has outlived it.

        Raises `OutputError` if another run has begun since, or the run has ended. `run` is the SHA-256 of
        the file that says what the run is; None: nobody else can have the folder.
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


def plan_spills(
    sensors: Sequence[Sensor], tasks: list[dict[str, Any]], job: Mapping[str, Any], most: int
) -> list[dict[str, Any]]:
    """Tasks that divide the files, none where reading them directly takes less; gives tasks their buckets.

    `job` is what all tasks share, and `most` the largest number of rows of a spill.
    """
    rows: dict[str, int] = {}
    for sensor in sensors:
        for source, count in sensor.files:
            if job["by"] is not None and job["by"] not in source.partition:
                rows[str(source.path)] = rows.get(str(source.path), 0) + count
    read = sum(rows.get(file, 0) for task in tasks for file in _files(task))
    if read <= _READS * sum(rows.values()):
        return []
    layout = Layout(**job["layout"])
    groups = list(_groups(rows, layout, most))
    together = -(-len(groups) * len(tasks) // _PIECES)
    buckets: dict[str, int] = {}
    for number, task in enumerate(tasks):
        task["bucket"] = number // together
        buckets |= {sensor["key"]: task["bucket"] for sensor in task["sensors"]}
    places = {file: place for task in tasks for s in task["sensors"] for file, _, place in s["files"]}
    return [
        {
            "number": number,
            "files": [[file, places[file], *part] for file, part in group],
            "buckets": buckets,
            "job": dict(job),
        }
        for number, group in enumerate(groups)
    ]


def run_spill(task: Mapping[str, Any]) -> dict[str, Any]:
    """Write the pieces of some files; of a run that has ended none."""
    pl = polars()
    job = task["job"]
    store = Store(Path(job["store"]))
    store.check(job.get("run"))
    folder = store.folder / "rows"
    folder.mkdir(parents=True, exist_ok=True)
    frames = []
    for file, place, first, count in task["files"]:
        number = pl.lit(place, pl.Int32).alias(PLACE)
        try:
            table = opened(Path(file), Layout(**job["layout"]))
            names = [name for name in table.schema if name not in {job["by"], job["kind"]}]
            key = label(job["by"], table.schema[job["by"]]).alias(KEY)
            frames.append(table.read([pl.col(names), key, number], rows=(first, count)))
        except DataError as error:  # its sensors fail, the others go on
            store.check(job.get("run"))
            put(_broken(folder, place), str(error).encode())
    whole = pl.concat(frames) if frames else pl.DataFrame(schema={KEY: pl.String})
    of_key = pl.DataFrame(
        {KEY: list(task["buckets"]), "_bucket": list(task["buckets"].values())},
        schema={KEY: pl.String, "_bucket": pl.Int32},
    )
    whole = whole.join(of_key, on=KEY, how="inner", maintain_order="left")
    for (bucket,), part in whole.partition_by("_bucket", as_dict=True, maintain_order=True).items():
        path = folder / f"{bucket:06d}" / f"{task['number']:06d}.parquet"
        store.check(job.get("run"))
        with writing(path):
            path.parent.mkdir(parents=True, exist_ok=True)
        with _unfinished(path) as unfinished:
            part.drop("_bucket").write_parquet(unfinished, compression="lz4")
            store.check(job.get("run"))
    store.check(job.get("run"))
    put(_mark(folder, task["number"]), b"")
    return {"number": task["number"]}


def is_spilled(store: Path, number: int) -> bool:
    """Whether a spill is done."""
    return _mark(store / "rows", number).exists()


def broken_files(store: Path) -> dict[int, str]:
    """Places of the files that could not be read, with the reasons."""
    return {int(path.stem): path.read_text("utf-8") for path in (store / "rows").glob("*.broken")}


def pieces(store: Path, bucket: int, keys: Sequence[str]) -> Iterator[tuple[int, str, Frame]]:
    """Rows of some sensors of a bucket, by place of the input file and by key.

    Raises `DataError` if a piece cannot be read.
    """
    pl = polars()
    for path in sorted((store / "rows" / f"{bucket:06d}").glob("[0-9]*.parquet")):
        frame = opened(path, Layout(), compare=False).read([pl.all()], pl.col(KEY).is_in(keys))
        parts = frame.partition_by([PLACE, KEY], as_dict=True, maintain_order=True, include_key=False)
        yield from ((place, key, part) for (place, key), part in parts.items())


def _mark(folder: Path, number: int) -> Path:
    return folder / f"{number:06d}.done"


def _broken(folder: Path, place: int) -> Path:
    return folder / f"{place:06d}.broken"


def _files(task: Mapping[str, Any]) -> set[str]:
    return {file for sensor in task["sensors"] for file, *_ in sensor["files"]}


def _groups(
    rows: Mapping[str, int], layout: Layout, most: int
) -> Iterator[list[tuple[str, tuple[int, int | None]]]]:
    """Files of the same columns whose rows fit into the memory; a large file in parts."""
    group: list[tuple[str, tuple[int, int | None]]] = []
    held, schema = 0, None
    for file, count in rows.items():
        own = opened(Path(file), layout, compare=False).schema if is_parquet(Path(file)) else None
        if group and (own is None or own != schema or held + count > most):
            yield group
            group, held = [], 0
        schema = own
        if own is None or count <= most:
            group.append((file, (0, None)))
            held += count
            continue
        whole = opened(Path(file), layout, compare=False).height
        for first in range(0, whole, most):
            yield [(file, (first, min(most, whole - first)))]
    if group:
        yield group
