"""Logs: rows that belong together, in one file or in several, for models that depend on other rows."""

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from echocal.correct.corrector import Context, Corrector
from echocal.correct.inputs import Inputs, Source
from echocal.correct.needed import context_of, remembered
from echocal.errors import DataError, EchocalError, UsageError
from echocal.keywords import keyword
from echocal.model import Model
from echocal.model.folder import ModelFolder
from echocal.objects import Object
from echocal.places import Place

LOGS = ("file", "key", "all")
"""Which files may be one log."""

_BYTES_A_ROW = 250
"""What a row takes while the quantities that a log derives from its rows are computed; judgement."""


@dataclass(frozen=True)
class _Log:
    table: pd.DataFrame
    places: Mapping[Path, tuple[int, int]]
    context: Context


_KEPT: dict[tuple[object, ...], _Log] = {}
"""The log that was used last: its files are mostly corrected one after the other."""


def surroundings(
    file: Path,
    log: Sequence[Path],
    corrector: Corrector,
    read: Callable[[Path], Iterable[pd.DataFrame]],
    memory: int,
) -> dict[str, Any]:
    """What the rows of a file depend on besides themselves, as `echocal.correct.stream.corrected` takes it.

    Raises `DataError` if the log is larger than the memory, or its files overlap in time. `log` has the
    files of the log in any order, none for the file alone; `read` gives the needed columns of a file, piece
    by piece.
    """
    if not corrector.remembers and (len(log) < 2 or not corrector.rows_around):
        return {"context": Context()}
    files = list(log) or [file]
    key = (*map(_version, files), corrector.reads)
    whole = _KEPT.get(key)
    if whole is None:
        whole = _read_log(files, corrector, read, memory)
        _KEPT.clear()
        _KEPT[key] = whole
    begin, end = whole.places[file]
    first, last = max(begin - corrector.rows_around, 0), min(end + corrector.rows_around, len(whole.table))
    return {
        "context": whole.context.rows(first, last),
        "before": whole.table.iloc[first:begin].reset_index(drop=True),
        "after": whole.table.iloc[end:last].reset_index(drop=True),
    }


def _version(file: Path) -> tuple[object, ...]:
    """A file as it is now: another one may be written at the same place."""
    found = file.stat()
    return file, found.st_ino, found.st_size, found.st_mtime_ns, found.st_ctime_ns


def _read_log(
    files: Sequence[Path],
    corrector: Corrector,
    read: Callable[[Path], Iterable[pd.DataFrame]],
    memory: int,
) -> _Log:
    tables: list[pd.DataFrame] = []
    rows = 0
    for file in files:
        pieces = list(read(file)) or [pd.DataFrame(columns=corrector.columns)]
        tables.append(pd.concat(pieces, ignore_index=True))
        rows += len(tables[-1])
        if rows * _BYTES_A_ROW > memory:
            raise DataError(
                f"the model has {', '.join(corrector.remembers) or 'marks'}, which depends on the other rows "
                f"of a log, and this log has more than {memory // _BYTES_A_ROW} rows, which do not fit into "
                f"{memory >> 20} MB; give more memory ({keyword('memory', '4GB')}), or correct shorter logs"
            )
    table, context, elapsed = _joined(tables, corrector)
    ends = np.cumsum([len(own) for own in tables])
    starts = [_earliest(times) for times in np.split(elapsed, ends[:-1])]
    order = sorted(range(len(files)), key=lambda place: starts[place])
    if order != list(range(len(files))):
        tables, files = [tables[place] for place in order], [files[place] for place in order]
        table, context, elapsed = _joined(tables, corrector)
    sizes = [len(own) for own in tables]
    _refuse_overlap(files, sizes, elapsed)
    ends = np.cumsum([0, *sizes])
    places = {file: (int(ends[n]), int(ends[n + 1])) for n, file in enumerate(files)}
    return _Log(table, places, context)


def _joined(
    tables: Sequence[pd.DataFrame], corrector: Corrector
) -> tuple[pd.DataFrame, Context, NDArray[np.float64]]:
    table = pd.concat(tables, ignore_index=True) if len(tables) > 1 else tables[0]
    return table, *corrector.whole_log(table)


def _earliest(times: NDArray[np.float64]) -> float:
    """Start of a file; one without times stays where it is named."""
    known = times[np.isfinite(times)]
    return float(known.min()) if len(known) else -np.inf


def _refuse_overlap(files: Sequence[Path], sizes: Sequence[int], elapsed: NDArray[np.float64]) -> None:
    latest, before = -np.inf, files[0]
    for file, times in zip(files, np.split(elapsed, np.cumsum(sizes)[:-1]), strict=True):
        known = times[np.isfinite(times)]
        if len(known) and known.min() < latest:
            raise DataError(
                f"{file} begins before {before} ends, and both are one log of a model that depends on the "
                f"other rows; if they are of different sensors, say so: {keyword('by', 'COLUMN')}, or "
                f"{keyword('logs', 'file')}"
            )
        if len(known):
            latest, before = max(latest, float(known.max())), file


def _model(folder: ModelFolder, key: str | None) -> Model | None:
    try:
        return None if key is None else folder.model(key)
    except EchocalError:  # the tasks of its files tell
        return None


def logs_of(
    inputs: Inputs,
    keys: Mapping[str, str | None],
    model: Model | None,
    folder: ModelFolder | None,
    logs: str | None,
    job: Mapping[str, Any],
) -> Mapping[str, Sequence[Place]]:
    """Files of the log that each file belongs to, in the order of time, by the place of its output.

    Only where the model depends on other rows; else every file is corrected by itself. Raises `UsageError` if
    it is not known which files are one log.
    """
    if logs not in (None, *LOGS):
        raise UsageError(f"{keyword('logs', logs)} is not one of {', '.join(LOGS)}")
    alone: dict[str, list[Place]] = {s.place.as_posix(): [s.path] for s in inputs.files}
    if len(inputs.files) == 1 or logs == "file":
        return alone
    groups: dict[str | None, list[Source]] = {}
    for source in inputs.files:
        key = None if logs == "all" else keys[source.place.as_posix()]
        groups.setdefault(key, []).append(source)
    for key, sources in groups.items():
        own = model if folder is None else _model(folder, key)
        depends = [] if own is None else [*remembered(own), *(["marks"] if context_of(own) else [])]
        if not depends or len(sources) < 2:
            continue
        if key is None and logs is None:
            raise UsageError(
                f"the model has {', '.join(depends)}, which depends on the other rows of a log, and there "
                f"are {len(sources)} files; say which are one log: {keyword('logs', 'all')}, "
                f"{keyword('logs', 'file')} "
                f"(each by itself), or {keyword('by', 'COLUMN')} with one partition for each sensor"
            )
        ordered: list[Place] = [source.path for source in sources]
        if any(isinstance(path, Object) for path in ordered):
            raise UsageError(
                f"the model has {', '.join(depends)}, which depends on the other rows of a log, and the "
                f"{len(ordered)} files of it are in an object store; copy them to a disk first, or write "
                "each log into one file"
            )
        for source in sources:
            alone[source.place.as_posix()] = ordered
    return alone
