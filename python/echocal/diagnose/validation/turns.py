"""Rows that take turns: several sensors, or versions of a firmware, that no column tells apart."""

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.special import fdtrc

from echocal.diagnose.findings.sentences import enumerated
from echocal.diagnose.inference.case import Case
from echocal.diagnose.inference.smoothing import MOST_ROWS
from echocal.diagnose.preprocess.table import Table, levels
from echocal.keywords import keyword
from echocal.model import Model

__all__ = ["FAR", "FAR_FROM_CHANCE", "Turns", "in_turns"]

Column = NDArray[np.float64]
Labels = NDArray[np.int64]

FAR = 0.5
"""Part of the mean square of an error, more of which is no noise."""

FAR_FROM_CHANCE = 1e-5
"""Probability below which an error is not left to chance."""

_MOST = 4  # turns
_ROWS_OF_A_TURN = 8  # of each, where rows are tried for a period in their order
_OTHER = 0.1  # of the variance of a column between the turns, from which on it may be the reason


class Turns(NamedTuple):
    """Rows that take turns.

    Attributes
    ----------
    said : str
        A sentence on their differences.
    rms_m : float
        Error that is left without these [m].
    degrees : tuple of float
        Degrees of freedom of the differences, and of what is left.
    p_value : float
        Of an F test.
    """

    said: str
    rms_m: float
    degrees: tuple[float, float]
    p_value: float


def in_turns(case: Case, model: Model) -> Turns | None:
    """Find a short period in the order of the rows that explains most of what a model leaves."""
    table = case.table.rows
    first = slice(0, MOST_ROWS)  # enough of a long table
    left = _left(table, model, first)
    known = np.isfinite(left)
    left, row, count = left[known], table.row[first][known], int(known.sum())
    for period in range(2, _MOST + 1):
        turn = row % period
        members = np.bincount(turn, minlength=period)
        if members.min() < _ROWS_OF_A_TURN:
            return None
        mean = np.bincount(turn, left, minlength=period) / members
        within = float(np.sum((left - mean[turn]) ** 2))
        total = float(np.sum((left - left.mean()) ** 2))
        if not total - within > FAR * total:
            continue
        others = (column[first][known] for column in _recorded(case))
        if any(_share(column, turn, members) > _OTHER for column in others):
            return None  # stations that take turns, or a column that tells the rows apart
        degrees = float(period - 1), float(count - period)
        p_value = float(fdtrc(*degrees, (total - within) / degrees[0] / (max(within, 1e-300) / degrees[1])))
        if p_value < FAR_FROM_CHANCE:
            rms = float(np.sqrt(within / count))
            return Turns(_sentence(period, mean, row, turn, rms), rms, degrees, p_value)
    return None


def _left(table: Table, model: Model, rows: slice) -> Column:
    """What a model leaves in some rows, less their level where it is unknown [m]."""
    corrected = table.correct(model, rows)
    if table.reference is not None:
        return corrected - table.reference[rows]
    return corrected - levels(corrected, table.groups[rows], np.isfinite(corrected), np.mean)


def _recorded(case: Case) -> Iterator[Column]:
    """Columns that may take turns, too."""
    table = case.table.rows
    columns = [*table.conditions.values(), *table.extra.values(), *table.labels.values()]
    for column in columns if table.reference is None else [*columns, table.reference]:
        if np.isfinite(column).all():
            yield np.asarray(column, dtype=np.float64)


def _share(column: Column, turn: Labels, members: Labels) -> float:
    """Part of the variance of a column that is between the turns."""
    mean = np.bincount(turn, column) / members
    total = float(np.sum((column - column.mean()) ** 2))
    return 1.0 - float(np.sum((column - mean[turn]) ** 2)) / total if total > 0.0 else 0.0


def _sentence(period: int, mean: Column, row: Labels, turn: Labels, rms: float) -> str:
    first = [int(row[turn == k].min()) + 1 for k in range(period)]
    above = [f"{1e3 * (mean[k] - mean.min()):.1f}" for k in np.argsort(first)]
    return (
        f"the readings take turns with a period of {period} rows: from row {min(first)} on they are "
        f"{enumerated(above)} mm above the lowest turn, over and over. Without these differences "
        f"{1e3 * rms:.2f} mm would be left. Several sensors, or versions of a firmware, may have written one "
        f"log. Diagnose them apart: add a column that tells them apart, and give {keyword('by', 'COLUMN')}"
    )
