"""Logs: rows that belong together, in one file or in several, for models that depend on other rows."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from echocal.correct.corrector import Context, Corrector
from echocal.errors import DataError

__all__ = ["Surroundings", "surroundings"]

_BYTES_A_ROW = 250
"""What a row takes while the quantities that a log derives from its rows are computed; judgement."""


@dataclass(frozen=True)
class Surroundings:
    """What the rows of a file depend on.

    Attributes
    ----------
    context : Context
        Of the rows before, of the file, and of the rows after.
    before, after : pandas.DataFrame
        Rows of the log just before and after the file.
    """

    context: Context
    before: pd.DataFrame
    after: pd.DataFrame


@dataclass(frozen=True)
class _Log:
    table: pd.DataFrame
    sizes: tuple[int, ...]
    context: Context


_KEPT: dict[tuple[tuple[Path, ...], tuple[str, ...]], _Log] = {}
"""The log that was used last: its files are mostly corrected one after the other."""


def surroundings(
    files: Sequence[Path],
    place: int,
    corrector: Corrector,
    read: Callable[[Path], pd.DataFrame],
    memory: int,
) -> Surroundings:
    """What the rows of one file of a log depend on.

    Parameters
    ----------
    files : sequence of Path
        The files of the log, in the order of time.
    place : int
        Which of them.
    read : callable
        Reads the needed columns of a file.

    Raises
    ------
    DataError
        If the log is larger than the memory, or its files overlap in time.
    """
    key = (tuple(files), corrector.columns)
    if key not in _KEPT:
        log = _read_log(files, corrector, read, memory)
        _KEPT.clear()
        _KEPT[key] = log
    log = _KEPT[key]
    ends = np.cumsum([0, *log.sizes])
    begin, end = int(ends[place]), int(ends[place + 1])
    first, last = max(begin - corrector.rows_around, 0), min(end + corrector.rows_around, len(log.table))
    return Surroundings(
        log.context.rows(first, last),
        log.table.iloc[first:begin].reset_index(drop=True),
        log.table.iloc[end:last].reset_index(drop=True),
    )


def _read_log(
    files: Sequence[Path], corrector: Corrector, read: Callable[[Path], pd.DataFrame], memory: int
) -> _Log:
    tables: list[pd.DataFrame] = []
    rows = 0
    for file in files:
        tables.append(read(file))
        rows += len(tables[-1])
        if rows * _BYTES_A_ROW > memory:
            message = (
                f"the model has {', '.join(corrector.remembers) or 'marks'}, which depends on the other rows "
                f"of a log, and this log has more than {memory // _BYTES_A_ROW} rows, which do not fit into "
                f"{memory >> 20} MB; give more memory (--memory 4GB), or correct shorter logs"
            )
            raise DataError(message)
    table = pd.concat(tables, ignore_index=True) if len(tables) > 1 else tables[0]
    context, elapsed = corrector.whole_log(table)
    sizes = tuple(len(own) for own in tables)
    _refuse_overlap(files, sizes, elapsed)
    return _Log(table, sizes, context)


def _refuse_overlap(files: Sequence[Path], sizes: Sequence[int], elapsed: NDArray[np.float64]) -> None:
    latest, before = -np.inf, files[0]
    for file, times in zip(files, np.split(elapsed, np.cumsum(sizes)[:-1]), strict=True):
        known = times[np.isfinite(times)]
        if len(known) and known.min() < latest:
            message = (
                f"{file} begins before {before} ends, and both are one log of a model that depends on the "
                "other rows; if they are of different sensors, say so: --by COLUMN, or --logs file"
            )
            raise DataError(message)
        if len(known):
            latest, before = max(latest, float(known.max())), file
