"""Wild rows on one side of what is expected: shared by crosstalk and multipath."""

import numpy as np
from numpy.typing import NDArray

from echocal.diagnose.faults.values import chance_far, far
from echocal.diagnose.faults.view import View

__all__ = ["count_evidence", "wild_side"]

_USUAL = 0.02  # part of the rows of a table with such a fault


def wild_side(view: View, sign: int, least: float = 0.0) -> NDArray[np.bool_]:
    """Far rows that read too long (+1) or too short (-1), by a part of the distance at least."""
    rows = far(view)
    if not rows.any():
        return rows
    with np.errstate(invalid="ignore"):
        return np.asarray(rows & (sign * view.deviation > least * np.abs(view.expected)))


def count_evidence(view: View, count: int) -> float:
    """Log Bayes factor of a fault that hits some percent of the rows against heavy tails alone."""
    total = int(view.good.sum())
    chance, usual = 0.5 * chance_far(view), _USUAL * total + 0.5
    return float(min(count * np.log(max(usual, 1.0) / chance) - (usual - chance), 60.0))
