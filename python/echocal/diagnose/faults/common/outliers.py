"""Outliers on one side of what is expected: shared by crosstalk and multipath."""

import numpy as np
from numpy.typing import NDArray

from echocal.diagnose.faults.common.values import chance_far, far, limit_of
from echocal.diagnose.preprocess.view import View
from echocal.diagnose.settings.faults import FaultSettings, Outliers
from echocal.observations.marks import RowRule

__all__ = ["count_evidence", "far_rule", "one_sided_outliers"]

_PARTS = np.linspace(0.025, 1.0, 40)[:, None]  # of the far rows, tried


def one_sided_outliers(
    view: View, sign: int, settings: FaultSettings, least: float = 0.0
) -> NDArray[np.bool_]:
    """Far rows that read too long (+1) or too short (-1), by a part of the distance at least.

    No row, if most rows before or after some moment are off as far (then the sensor moved), or if
    there are too many.
    """
    rows = far(view, settings.far)
    if not rows.any():
        return rows
    with np.errstate(invalid="ignore"):
        rows = rows & (sign * view.deviation > least * np.abs(view.expected))
    none = rows.sum() > settings.outliers.most * view.good.sum() or _moved(
        view, rows, sign, settings.outliers
    )
    return np.zeros_like(rows) if none else rows


def far_rule(
    view: View, reason: str, sign: int, settings: FaultSettings, least: float = 0.0, deviations: float = 0.0
) -> RowRule:
    """The rule for such rows: deviations from the reference distance, or from the rows around.

    Without `deviations` [robust standard deviations] and `least`, those of all far rows.
    """
    measured = view.known and view.given is None
    return RowRule(
        reason=reason,
        kind="far from reference" if measured else "far from neighbors",
        sign=sign,
        deviation=float((deviations or settings.far.deviations) * view.scatter),
        part=0.0 if deviations else max(settings.far.part, least),
    )


def _moved(view: View, rows: NDArray[np.bool_], sign: int, settings: Outliers) -> bool:
    """Whether these rows begin or end a table, among rows most of which are off by as much."""
    where = np.flatnonzero(rows)
    if len(where) < settings.moved_rows:
        return False
    tail = settings.moved_tail
    early, late = np.quantile(where, (tail, 1 - tail)).astype(np.int64)
    limit = settings.moved_as_far * np.median(sign * view.deviation[rows])
    for part in (slice(0, late + 1), slice(early, len(rows))):
        known = view.good[part]
        distances = len(np.unique(view.expected[part][known]))
        others = len(rows) - len(known)
        enough = max(settings.moved_distances, settings.moved_distances_per_row * len(known))
        if distances < enough or min(len(known), others) < settings.moved_rows:
            continue
        if np.median(sign * view.deviation[part][known]) > limit:
            return True
    return False


def count_evidence(view: View, rows: NDArray[np.bool_], settings: FaultSettings) -> float:
    """Log Bayes factor of a fault that hits some percent of the rows, against heavy tails and odd rows.

    Tails have two sides, and more rows that are somewhat less far off. Rows that are odd for a reason
    outside the catalogue are on either side, and off by any order of magnitude.
    """
    own, count, total = settings.outliers, int(rows.sum()), int(view.good.sum())
    off = view.deviation / limit_of(view.scatter, view.expected, settings.far)
    tail = min(int((view.good & (side * off > own.tail) & (side * off <= 1.0)).sum()) for side in (-1, 1))
    chance = max(0.5 * chance_far(view, settings.far), tail)
    usual = max(own.usual * total + 0.5, chance)
    against_tails = min(count * np.log(max(usual, 1.0) / chance) - (usual - chance), settings.cap)
    odd = np.log(own.odd) - _against_odd(view, rows, off, own) - np.log((count + 1) / own.alone)
    return float(against_tails - np.logaddexp(np.log(1.0 - own.odd), odd + against_tails))


def _against_odd(view: View, rows: NDArray[np.bool_], off: NDArray[np.float64], own: Outliers) -> float:
    """Log Bayes factor of echoes over another way against odd rows: docs/method/faults.md, Eq. 30b.

    All far rows are such echoes, or any part of them, with the same prior. `off` is in units of the limit.
    """
    beyond = view.good & (np.abs(off) > 1.0)
    way = np.abs(view.expected[beyond] / view.deviation[beyond])
    orders = np.maximum(np.log(way * np.abs(off[beyond])), 1.0)  # of magnitude, to which odd rows are off
    over = own.anywhere * orders / np.maximum(way, 1.0) + 1.0 - own.anywhere  # density over that of odd rows
    logs = np.log(_PARTS * np.where(rows[beyond], 2.0 * over, 0.0) + (1.0 - _PARTS) + 1e-300).sum(axis=1)
    return float(np.logaddexp(logs[-1], np.logaddexp.reduce(logs) - np.log(len(logs))) - np.log(2))
