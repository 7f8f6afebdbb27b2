"""What the pictures of a diagnosis show: the columns that the change by its model follows, in bins."""

import numpy as np
from numpy.typing import NDArray

from echocal.diagnose.findings.parts import Traces
from echocal.diagnose.findings.sentences import Recorded, most_correlated
from echocal.diagnose.preprocess.hold_out import HELD_OUT_ROW
from echocal.diagnose.results.diagnosis import Diagnosis
from echocal.diagnose.results.fates import USED

__all__ = ["ERROR", "SIGN", "binned_means", "by_correlation", "drawn_columns", "is_finer", "left_out_at"]
__all__ += ["limits"]

Column = NDArray[np.float64]

ERROR = "reading minus reference [mm]"
"""What an error is: the label of its axis. The level stands for a reference that is not known."""

SIGN = "above 0, it reads too far"
"""What the sign of an error means."""

_BINS = 30
_FEW = 200  # rows that are visible one by one
_ENOUGH = 5  # fewest rows of a mean that is drawn
_SAME = 1e-6  # m, far below the resolution of such sensors
_REPEATED = 0.999  # correlation with a column that is drawn, beyond which a further panel shows nothing new
_FINER = 0.2  # part of the error, below which a scale of its own is needed to see it
_MIDDLE = (0.5, 99.5)  # percentiles between which the errors are drawn
_ROOM = 0.25


def by_correlation(diagnosis: Diagnosis) -> list[str]:
    """Columns that vary, those first that the change by the model (or the residual) follows most.

    The first one is the column that a sentence about the whole change would name.

    Returns
    -------
    list of str
        Names in ``diagnosis.traces.against``.
    """
    traces = diagnosis.traces
    changed = traces.before - traces.after
    signal = changed if np.nanstd(changed) > _SAME else traces.before
    known = np.isfinite(signal)
    varied = {name: column[known] for name, column in traces.against.items() if _varies(column)}
    first = most_correlated(signal[known], Recorded(varied))
    return sorted(varied, key=lambda name: (name != first, -_explained_variance(varied[name], signal[known])))


def drawn_columns(diagnosis: Diagnosis, most: int) -> list[str]:
    """The first columns by correlation, without those that repeat another one; time wherever it is recorded.

    Parameters
    ----------
    most : int
        Number of columns, 1 at least.
    """
    against = diagnosis.traces.against
    every = by_correlation(diagnosis)
    if "time" in every and "row" in every:
        every.remove("row")  # the same order
    kept: list[str] = []
    for name in every:
        if name == "time" or not any(_repeats(against[name], against[other]) for other in kept):
            kept.append(name)
    chosen = kept[:most]
    if "time" in kept and "time" not in chosen:
        chosen[-1] = "time"
    return chosen


def _repeats(one: Column, other: Column) -> bool:
    return abs(float(np.corrcoef(one, other)[0, 1])) > _REPEATED


def is_finer(traces: Traces) -> bool:
    """Whether the errors after are so much smaller than those before that they need a scale of their own."""
    before, after = (np.ptp(_middle(error)) for error in (traces.before, traces.after))
    return bool(after < _FINER * before)


def limits(traces: Traces, which: str) -> tuple[float, float]:
    """Range of the axis of the errors before or after [mm]: one range for both, or one for each."""
    own = [traces.before if which == "before" else traces.after]
    ends = np.concatenate([_middle(e) for e in (own if is_finer(traces) else (traces.before, traces.after))])
    low, high = 1e3 * min(ends.min(), 0.0), 1e3 * max(ends.max(), 0.0)
    room = _ROOM * (high - low) + 1e-3
    return low - room, high + room


def _middle(error: Column) -> Column:
    return np.asarray(np.nanpercentile(error, _MIDDLE))


def left_out_at(diagnosis: Diagnosis, name: str) -> Column:
    """Where rows are left out: as positions in the source, or on an axis of time, by the rows around them."""
    out = np.flatnonzero(~np.isin(diagnosis.fates.fate.astype(str), (USED, HELD_OUT_ROW))).astype(np.float64)
    if name == "row":
        return out
    if name != "time":
        return np.empty(0)
    traces = diagnosis.traces
    order = np.argsort(traces.row)
    return np.interp(out, traces.row[order], traces.against[name][order])


def binned_means(x: Column, y: Column) -> tuple[Column, Column]:
    """Means of bins with about equally many rows; of many rows, bins with few rows are left out."""
    if not len(x):
        return x, y
    bins = _binned(x)
    rows = np.bincount(bins)
    filled = rows >= (1 if len(x) <= _FEW else min(_ENOUGH, rows.max()))
    means = [np.bincount(bins, weights=values)[filled] / rows[filled] for values in (x, y)]
    return means[0], means[1]


def _binned(x: Column) -> NDArray[np.int64]:
    """Bin of each value: about equally many rows in each, or one for each value where these are few."""
    count = min(_BINS, max(2, len(x) // 3))
    distinct, bins = np.unique(x, return_inverse=True)
    if len(distinct) > count:
        edges = np.unique(np.quantile(x, np.linspace(0, 1, count + 1)))
        bins = np.clip(np.searchsorted(edges, x, side="right") - 1, 0, max(len(edges) - 2, 0))
    return np.asarray(bins, dtype=np.int64)


def _explained_variance(x: Column, y: Column) -> float:
    """Part of the variance of y that the means of bins of x explain."""
    bins = _binned(x)
    rows = np.bincount(bins)
    filled = rows > 0
    means = np.bincount(bins, weights=y)[filled] / rows[filled]
    return float(rows[filled] @ (means - y.mean()) ** 2 / max(len(y) * y.var(), 1e-300))


def _varies(column: Column) -> bool:
    return bool(np.isfinite(column).all() and np.ptp(column) > 0)
