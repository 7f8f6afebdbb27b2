"""The diagnosis of a fleet: index, tasks, prevalence of causes, table."""

import hashlib
import tempfile
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Any

from echocal._core import __version__
from echocal._interrupt import stop_if_told
from echocal.correct.driver import sweep
from echocal.correct.inputs import Source
from echocal.diagnose.request import Request
from echocal.diagnose.settings import Settings
from echocal.engines import Engine, is_elsewhere, open_engine
from echocal.engines.engine import Here
from echocal.engines.processes import processors
from echocal.engines.worker import check_workers
from echocal.errors import DataError, UsageError, writing
from echocal.fleet import verdicts
from echocal.fleet.index import Sensor, files_of, indexed
from echocal.fleet.prevalence import judged
from echocal.fleet.store import Store, is_spilled, plan_spills, run_spill
from echocal.fleet.summary import summary
from echocal.fleet.task import BYTES_A_ROW, digest, run_task, tasks_of
from echocal.fleet.verdicts import FAILED, failure
from echocal.keywords import as_here, keyword
from echocal.model import Model
from echocal.model.document import to_plain
from echocal.model.folder import INDEX, index_text, named
from echocal.observations.layout import Layout
from echocal.observations.options import ReadOptions
from echocal.outputs import replace_text
from echocal.places import file_digest, stamp

Records = list[dict[str, Any]]
Progress = Callable[[int, int, int], object]
"""Called with the sensors that are done, those of all, and those that were done in an earlier run."""

_MEMORY = 512 << 20


@dataclass(frozen=True)
class Fleet:
    """The verdicts of a fleet.

    Attributes
    ----------
    rows : list of dict
        One for each sensor, as in the table.
    summary : dict
        Schema ``echocal.fleet/1``.
    """

    rows: list[dict[str, Any]]
    summary: dict[str, Any]

    @property
    def failed(self) -> int:
        """Sensors that could not be diagnosed."""
        return sum(row["verdict"] == FAILED for row in self.rows)


def diagnose_fleet(
    inputs: Sequence[str | Path] | str | Path,
    by: str | None = None,
    *,
    out: str | Path | None = None,
    models: str | Path | None = None,
    results: str | Path | None = None,
    kind: str | None = None,
    base: str | float | Path = "linear",
    reading: Mapping[str, Any] | None = None,
    layout: Layout | None = None,
    settings: Settings | Mapping[str, Mapping[str, Any]] | None = None,
    workers: int | None = None,
    engine: str | Engine = "local",
    memory: int = _MEMORY,
    spreadsheet_safe: bool = False,
    force: bool = False,
    progress: Progress | None = None,
    seed: int = 0,
    **request: Any,
) -> Fleet:
    """Diagnose every sensor of a fleet by itself, and estimate how common each cause is.

    Parameters
    ----------
    inputs : path or sequence of paths
        Files, folders or patterns. A log may lie in several files.
    by : str, optional
        Column, or level of the folders (``sensor_id=17``), with the key of a sensor. Default: each file is
        the log of one sensor.
    out : path, optional
        Table of verdicts to write, ``.parquet`` or ``.csv``. A run that was killed is continued if its
        request is repeated.
    models, results : path, optional
        Folders for the model and for the whole diagnosis of each sensor.
    kind : str, optional
        Column or level of the folders with the kind of a sensor. Sensors of a kind share how common each
        cause is. Default: all are of one kind.
    base : str, float or path
        As for `echocal.diagnose`; a model by its file.
    reading : mapping, optional
        Arguments of `echocal.read_observations`.
    layout : Layout, optional
        How text files are written.
    settings, seed
        As for `echocal.diagnose`.
    workers : int, optional
        Processes of this machine; default: as many as processors.
    engine : str or Engine
        Who diagnoses: ``"local"``, ``"dask-local"``, ``"dask://HOST:PORT"``; see docs/batch.md.
    memory : int
        Bytes of rows that a process holds at a time.
    spreadsheet_safe : bool
        Write an apostrophe before texts of a CSV file that a spreadsheet would take for formulas.
    force : bool
        Whether an unfinished run of another request is thrown away.
    progress : callable, optional
    **request
        ``reference_distance``, ``constant_distance``, ``since``, ``until`` and ``hold_out_after`` as for
        `echocal.diagnose`.

    Returns
    -------
    Fleet

    Raises
    ------
    DataError
        If there is no sensor.
    UsageError
        If a request contradicts itself, or an output cannot be written.

    Examples
    --------
    >>> import pathlib, tempfile
    >>> import numpy as np
    >>> import pandas as pd
    >>> import echocal
    >>> folder = pathlib.Path(tempfile.mkdtemp())
    >>> noise = 1e-3 * np.sin(np.arange(40.0) ** 2)
    >>> for name, offset in (("cellar", 0.0), ("roof", 0.02)):
    ...     log = pd.DataFrame({"reading_m": 1.0 + offset + noise, "temperature_C": 20.0})
    ...     log.to_csv(folder / f"{name}.csv", index=False)
    >>> fleet = echocal.diagnose_fleet(folder / "*.csv", reference_distance=1.0, workers=1)
    >>> [(row["sensor"], row["verdict"]) for row in fleet.rows]
    [('cellar', 'nothing'), ('roof', 'named')]
    """
    begun = time.perf_counter()
    given = [inputs] if isinstance(inputs, str | Path) else list(inputs)
    files = files_of([Path(one).absolute() for one in given] if is_elsewhere(engine) else given)
    how = ReadOptions(**{**(layout.plain() if layout else {}), **(reading or {})})
    layout = replace(how.layout, text_column=by or "")
    index = indexed(files.sources, by, kind, layout)
    folders = {"models": _folder(models), "results": _folder(results)}
    asked = {
        **_request(base, request, settings, seed),
        "reading": how.plain(),
        "layout": asdict(layout),
        "by": by,
        "kind": kind,
        "models": folders["models"],
        "results": folders["results"],
    }
    checked = Settings.of(settings)
    with tempfile.TemporaryDirectory(prefix="echocal-") as scratch:
        store = Store(Path(scratch) if out is None else Path(f"{Path(out)}.parts"))
        with store.locked():
            store.begin(_state(asked, files.sources, index.sensors, memory), force)
            job = {**asked, "store": str(store.folder.resolve()), "run": file_digest(store.job)}
            tasks = tasks_of(index.sensors, named(sensor.key for sensor in index.sensors), by, job, memory)
            for folder in (path for path in folders.values() if path):
                with writing(folder):
                    Path(folder).mkdir(parents=True, exist_ok=True)
            spills = plan_spills(index.sensors, tasks, job, max(memory // BYTES_A_ROW, 1))
            count = workers or processors()
            with open_engine(engine, count) as by_whom:
                check_workers(by_whom, _question(store, files.sources[0].file))
                _divide(store, spills, by_whom, count)
                records = _records(store, tasks, job, by_whom, progress)
            for folder in (path for path in folders.values() if path):
                sweep(Path(folder))  # of workers that died
            found = judged(records, checked)
            rows = [verdicts.row(one, own) for one, own in zip(records, found.sensors, strict=True)]
            whole = [*files.notes, *index.notes]
            told = summary(rows, found, checked, whole, time.perf_counter() - begun)
            if folders["models"]:
                made = {one["sensor"]: one["model"] for one in records if one["model"]}
                replace_text(Path(folders["models"]) / INDEX, index_text(made))
            if out is not None:
                verdicts.write(rows, Path(out), spreadsheet_safe=spreadsheet_safe)
            store.remove()
    return Fleet(rows, told)


def _question(store: Store, file: Path) -> dict[str, Any]:
    """What every worker must see as this process does: a file, and what this process has written."""
    return {
        "files": {str(file): stamp(file)["size"]},
        "written": [str(store.job.resolve()), file_digest(store.job)],
    }


def _divide(store: Store, spills: Sequence[Mapping[str, Any]], engine: Engine, workers: int) -> None:
    """Divide the files that hold many sensors, as far as an earlier run has not."""
    left = [task for task in spills if not is_spilled(store.folder, task["number"])]
    few = len(left) <= workers  # then starting processes takes longer than the work
    for task, result in (Here() if few else engine).run(as_here(run_spill), left):
        if result is None:
            files = ", ".join(file for file, *_ in task["files"][:3])
            message = f"the process that divided {files} was killed twice, perhaps for want of memory; "
            raise DataError(message + f"give less {keyword('memory')}")


def _records(
    store: Store,
    tasks: Sequence[Mapping[str, Any]],
    job: Mapping[str, Any],
    engine: Engine,
    progress: Progress | None,
) -> list[dict[str, Any]]:
    """Run what is not finished, and return the records of all sensors in the order of the tasks."""
    total = sum(len(task["sensors"]) for task in tasks)
    kept: dict[int, Records] = {}
    left = []
    for task in tasks:
        before = store.finished(task["number"])
        if before is not None and _whole(before, job):
            kept[task["number"]] = before
        else:
            left.append(task)
    done = earlier = sum(len(records) for records in kept.values())
    if progress is not None:
        progress(done, total, earlier)
    for task, result in engine.run(as_here(run_task), left):
        if result is None:
            kept[task["number"]] = [_lost(sensor) for sensor in task["sensors"]]
        stop_if_told()
        done += len(task["sensors"])
        if progress is not None:
            progress(done, total, earlier)
    records: Records = []
    shared: dict[tuple[str, ...], tuple[str, ...]] = {}  # a fleet has few sets of causes, many times each
    for task in tasks:
        own = kept.get(task["number"]) or store.finished(task["number"])
        if own is None:
            raise UsageError(f"{store.path(task['number'])} is missing or damaged; run again")
        for one in own:
            found = ((tuple(ids), p) for ids, p in one["posterior"])
            one["posterior"] = [(shared.setdefault(ids, ids), p) for ids, p in found]
        records += own
    return records


def _whole(records: Sequence[Mapping[str, Any]], job: Mapping[str, Any]) -> bool:
    """Whether the files that the records name are there as they were written."""
    for one in records:
        for what, sum_ in one["sha256"].items():
            try:
                content = (Path(job[what]) / one["file"]).read_bytes()
            except OSError:
                return False
            if hashlib.sha256(content).hexdigest() != sum_:
                return False
    return True


def _lost(sensor: Mapping[str, Any]) -> dict[str, Any]:
    less = f"give less {keyword('memory')}"
    reason = f"the process that diagnosed it was killed twice, perhaps for want of memory; {less}"
    own = {"sensor": sensor["key"], "kind": sensor["kind"], "files": len(sensor["files"]), "repeated": 0}
    named = {"model": None, "model_hash": None, "file": sensor["file"], "sha256": {}, "seconds": None}
    return {**failure(reason), **own, **named}


def _request(
    base: str | float | Path, request: Mapping[str, Any], settings: Any, seed: int
) -> dict[str, Any]:
    """The request as plain data, checked before any file is read."""
    usual = {"reference_distance": None, "constant_distance": False, "since": None, "until": None}
    whole = {**usual, "hold_out_after": None, **request}
    law: str | float = base if isinstance(base, float | int) else str(base)
    model = Model.load(law) if isinstance(law, str) and law.endswith(".json") else None
    Request.of(law if model is None else model, seed, settings, **whole)
    plain_base = law if model is None else to_plain(model)
    plain = None if settings is None else Settings.of(settings).to_dict()
    return {"request": {"base": plain_base, "seed": seed, "settings": plain, **whole}}


def _state(
    asked: Mapping[str, Any], files: Sequence[Source], sensors: Sequence[Sensor], memory: int
) -> dict[str, Any]:
    """What makes a run the same: a change of any of it would mix two runs."""
    stamps = [(str(file.file.resolve()), *stamp(file.file).values()) for file in files]
    return {
        "version": __version__,
        **{name: asked[name] for name in sorted(asked)},
        "files": digest(stamps),
        "sensors": len(sensors),
        "memory": memory,
    }


def _folder(path: str | Path | None) -> str | None:
    return None if path is None else str(Path(path).resolve())
