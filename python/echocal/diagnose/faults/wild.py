"""Wild rows on one side of what is expected: shared by crosstalk and multipath."""

import numpy as np
from numpy.typing import NDArray

from echocal.diagnose.faults.values import chance_far, far
from echocal.diagnose.preprocess.view import View

__all__ = ["count_evidence", "wild_side"]

_USUAL = 0.02  # part of the rows of a table with such a fault
_BUMPED = 50  # rows on either side of a moment when the sensor moved, at least
_DISTANCES = 10, 0.2  # of these rows, at least, and per row: all echoes from one target may be misread
_MOST = 0.01, 0.99  # quantiles between which such rows are looked for
_AS_FAR = 0.5  # of what they are off by, that the rows among them are off by


def wild_side(view: View, sign: int, least: float = 0.0) -> NDArray[np.bool_]:
    """Far rows that read too long (+1) or too short (-1), by a part of the distance at least.

    None, if most rows before or after some moment are off as far: then the sensor moved.
    """
    rows = far(view)
    if not rows.any():
        return rows
    with np.errstate(invalid="ignore"):
        rows = rows & (sign * view.deviation > least * np.abs(view.expected))
    return np.zeros_like(rows) if _moved(view, rows, sign) else rows


def _moved(view: View, rows: NDArray[np.bool_], sign: int) -> bool:
    """Whether these rows begin or end a table, among rows most of which are off by as much."""
    where = np.flatnonzero(rows)
    if len(where) < _BUMPED:
        return False
    early, late = np.quantile(where, _MOST).astype(np.int64)
    least, per_row = _DISTANCES
    limit = _AS_FAR * np.median(sign * view.deviation[rows])
    for stretch in (slice(0, late + 1), slice(early, len(rows))):
        known = view.good[stretch]
        distances = len(np.unique(view.expected[stretch][known]))
        others = len(rows) - len(known)
        if distances < max(least, per_row * len(known)) or min(len(known), others) < _BUMPED:
            continue
        if np.median(sign * view.deviation[stretch][known]) > limit:
            return True
    return False


def count_evidence(view: View, count: int) -> float:
    """Log Bayes factor of a fault that hits some percent of the rows against heavy tails alone."""
    total = int(view.good.sum())
    chance, usual = 0.5 * chance_far(view), _USUAL * total + 0.5
    return float(min(count * np.log(max(usual, 1.0) / chance) - (usual - chance), 60.0))
