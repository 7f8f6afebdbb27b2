"""Correct files: one or many, by one model or by one for each sensor."""

import json
import re
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any

from echocal._core import __version__
from echocal.correct.driver import Progress, Summary, alone, question_of, run, run_tasks, task_of
from echocal.correct.inputs import PARQUETS, Inputs, find_inputs, refuse_outputs
from echocal.correct.logs import logs_of
from echocal.correct.needed import refuse_no_model
from echocal.correct.rows import Reading
from echocal.engines import Engine, is_elsewhere, open_engine
from echocal.engines.processes import Processes
from echocal.engines.worker import check_workers
from echocal.errors import UsageError
from echocal.keywords import keyword
from echocal.model import Model
from echocal.model.document import to_plain
from echocal.model.folder import ModelFolder
from echocal.objects import is_url
from echocal.observations.given import READ_OPTIONS, refuse_keywords
from echocal.observations.layout import Layout
from echocal.places import place_of, size_of

_SMALL = 64 << 20
"""Bytes of inputs below which starting processes takes longer than the work; judgement."""
_LEAST = 256 << 20
"""Bytes below which the libraries alone do not fit; measured."""

_UNITS = {"": 1, "B": 1, "KB": 1 << 10, "MB": 1 << 20, "GB": 1 << 30, "TB": 1 << 40}


def correct_files(
    source: str | Path,
    out: str | Path,
    model: Model | None = None,
    *,
    models: str | Path | None = None,
    by: str | None = None,
    columns: Mapping[str, str] | None = None,
    uncertainties: Sequence[str] | Mapping[str, float] = (),
    mark_rows: bool = True,
    logs: str | None = None,
    append_only: Sequence[str] | None = None,
    round_mm: float | None = None,
    memory: int | str = "512MB",
    processes: int = 2,
    engine: str | Engine = "local",
    layout: Layout | None = None,
    spreadsheet_safe: bool = False,
    force: bool = False,
    progress: Callable[[Progress], None] = lambda state: None,
    **options: Any,
) -> Summary:
    r"""Correct a file, or every file of a folder or a glob, in constant memory.

    Parameters
    ----------
    source : path or URL
        CSV, TSV, either gzipped, Parquet; a folder of them, or a glob. Folders may be partitions
        (``sensor_id=17/``).
    out : path or URL
        The file to write; a folder for a folder or a glob. There, what is done is recorded, and is not done
        again.
    model : Model, optional
        The model of all rows.
    models : path, optional
        Folder of models, one for each key; see `echocal.model.folder`.
    by : str, optional
        Column, or partition, that has the key: ``"sensor_id"``.
    columns : mapping of str to str, optional
        Meaning of columns, by their names.
    uncertainties : sequence of str, or mapping of str to float
        Standard uncertainties of recorded or assumed values: ``["temperature_C=0.5", "echo_us=10"]``.
    mark_rows : bool
        As in `echocal.correct`.
    logs : str, optional
        Which files are one log, for a model that depends on other rows: ``"file"`` (each its own), ``"all"``
        (all files are one), ``"key"`` (those of a key are one; the default with `by`).
    append_only : sequence of str, optional
        Write these columns and the results only.
    round_mm : float, optional
        Round distances to multiples of this [mm].
    memory : int or str
        Memory that the run may use: ``"512MB"``.
    processes : int
        Processes of this machine, or threads for a single file.
    engine : str or Engine
        Who corrects the files: ``"local"``, ``"dask-local"``, ``"dask://HOST:PORT"``; see docs/batch.md. On a
        cluster, `memory` is what each task may use.
    layout : Layout, optional
        How text files are written.
    spreadsheet_safe : bool
        Write an apostrophe before texts of a text file that a spreadsheet would take for formulas.
    force : bool
        Begin anew where the folder was begun with another model.
    progress : callable
        Told how far the run is.
    **options
        Further arguments of `echocal.read_observations`, as in `echocal.correct`.

    Returns
    -------
    Summary
        Result of each file; files that cannot be corrected are set aside, with the reason.

    Raises
    ------
    UsageError
        If the request cannot be understood, or the output cannot be written.
    DataError
        If there is no file to correct; of a single file, also if it cannot be corrected.

    Examples
    --------
    >>> import pathlib, tempfile
    >>> import echocal
    >>> folder = pathlib.Path(tempfile.mkdtemp())
    >>> _ = (folder / "log.csv").write_text("echo_us,temperature_C\n11680,20\n-1,20\n")
    >>> device = echocal.Model("linear", {"fixed_delay": {"delay": 30e-6}})
    >>> summary = echocal.correct_files(folder / "log.csv", folder / "out.csv", device)
    >>> summary.rows, summary.unusable
    (2, 1)
    >>> (folder / "out.csv").read_text().splitlines()[1]
    '11680,20,2.000305,,,'
    """
    refuse_keywords(correct_files, options, READ_OPTIONS)
    written = {} if layout is None else layout.plain()
    reading = Reading.of({"columns": columns, **written, **options}, uncertainties, mark_rows)
    elsewhere = is_elsewhere(engine)
    if elsewhere:  # whose processes have working folders of their own
        source, out = (path if is_url(path) else Path(path).absolute() for path in (source, out))
        models = None if models is None else Path(models).absolute()
    inputs, target = find_inputs(source), place_of(out)
    refuse_outputs(inputs, source, target)
    if (model is None) == (models is None):
        raise UsageError(
            f"give one model ({keyword('model')}), or a folder of models ({keyword('models', 'DIR')}, "
            f"{keyword('by', 'COLUMN')})"
        )
    if model is not None:
        refuse_no_model(model)
    if (models is None) != (by is None) and models is not None:
        raise UsageError(
            f"{keyword('models')} needs {keyword('by', 'COLUMN')}, the column or partition with the key of "
            "a row"
        )
    if spreadsheet_safe and inputs.single and target.name.lower().endswith(PARQUETS):
        raise UsageError(f"{keyword('spreadsheet_safe')} is for CSV and TSV: no text of Parquet is a formula")
    several = len(inputs.files) > 1 and sum(size_of(file.path) for file in inputs.files) > _SMALL
    spread = processes > 1 and (several or engine != "local") and not elsewhere
    limit = in_bytes(memory)
    job = job_of(
        model,
        models,
        by,
        reading,
        round_mm,
        append_only=None if append_only is None else list(append_only),
        memory=limit // processes if spread else limit,
        threads=1 if spread or elsewhere else processes,
        several=not inputs.single,
        logs=logs,
        spreadsheet_safe=spreadsheet_safe,
    )
    folder = None if models is None else ModelFolder(Path(models))
    digest = model.hash if model is not None else str(folder and folder.digest())
    targets = {s.place.as_posix(): target if inputs.single else target / s.place for s in inputs.files}
    keys = {s.place.as_posix(): s.partition.get(by) if by else None for s in inputs.files}
    found = logs_of(inputs, keys, model, folder, logs, job)
    tasks = {
        s.place.as_posix(): task_of(
            s, targets[s.place.as_posix()], job, digest, keys[s.place.as_posix()], found[s.place.as_posix()]
        )
        for s in inputs.files
    }
    if inputs.single:
        with open_engine(engine, processes if spread else 1) as by_whom:
            return _single(inputs, next(iter(tasks.values())), by_whom, progress)
    with alone(target) as killed:
        if killed and engine == "local" and not spread:
            engine = Processes(1)  # a file that kills its process does not end this one
        with open_engine(engine, processes if spread else 1) as by_whom:
            return run(inputs, tasks, target, by_whom, force=force, progress=progress)


def _single(
    inputs: Inputs, task: Mapping[str, Any], engine: Engine, progress: Callable[[Progress], None]
) -> Summary:
    """Correct one file; a mistake in it is an error."""
    import echocal.errors as errors

    state = Progress(1, size_of(inputs.files[0].path))

    def tell(rows: int) -> None:
        state.rows += rows
        progress(state)

    check_workers(engine, question_of(task))
    (result,) = run_tasks(engine, [task], tell)
    if result["error"] is not None:
        kind = getattr(errors, result["error"]["kind"], errors.DataError)
        raise kind(result["error"]["text"])
    return Summary({inputs.files[0].place.as_posix(): result})


def job_of(
    model: Model | None,
    models: str | Path | None,
    by: str | None,
    reading: Reading,
    round_mm: float | None,
    **others: Any,
) -> dict[str, Any]:
    """The job of all tasks, as plain data."""
    if round_mm is not None and not round_mm > 0.0:
        raise UsageError(f"{keyword('round_mm', round_mm)} is no step; give a positive number of millimeters")
    stated = reading.uncertainties.plain()
    metadata = {"echocal.version": __version__, "echocal.distance_unit": "m"}
    if model is not None:
        metadata["echocal.model_hash"] = model.hash
    else:
        metadata["echocal.models_hash"] = ModelFolder(Path(str(models))).digest()
        metadata["echocal.models_by"] = str(by)
    if stated:
        metadata["echocal.standard_uncertainties"] = json.dumps(stated, sort_keys=True)
    if reading.at:
        metadata["echocal.stated_conditions"] = json.dumps(reading.at, sort_keys=True)
    if round_mm is not None:
        metadata["echocal.rounded_to_mm"] = f"{round_mm:g}"
    described = {"model": to_plain(model)} if model is not None else {"folder": str(models), "by": str(by)}
    how = {**reading.plain(), "mark_rows": reading.mark_rows, "uncertainties": stated}
    return {
        "models": described,
        "reading": how,
        "metadata": metadata,
        "round_m": None if round_mm is None else round_mm / 1000,
        **others,
    }


def in_bytes(text: int | str) -> int:
    """Bytes of an amount of memory.

    Raises `UsageError` if it is no amount, or too small for the libraries.

    Examples
    --------
    >>> in_bytes("512MB") == 512 * 2**20, in_bytes("1.5 GiB") == 3 * 2**29
    (True, True)
    """
    match = re.fullmatch(r"\s*(\d+(?:\.\d+)?)\s*([KMGT]?)i?(B?)\s*", str(text), re.IGNORECASE)
    unit = "" if match is None else (match[2] + (match[3] or ("B" if match[2] else ""))).upper()
    if match is None or unit not in _UNITS:
        raise UsageError(f"{keyword('memory', text)} is no amount of memory; e.g. 512MB, 2GB")
    amount = int(float(match[1]) * _UNITS[unit])
    if amount < _LEAST:
        message = f"{keyword('memory', text)} is too little: the libraries alone take {_LEAST >> 20}MB"
        raise UsageError(message)
    return amount
