"""Which recorded columns the change by a model follows, and the bins in which that is seen."""

import numpy as np
from numpy.typing import NDArray

from echocal.diagnose.findings.sentences import Recorded, most_correlated
from echocal.diagnose.results.diagnosis import Diagnosis

__all__ = ["binned", "by_correlation"]

Column = NDArray[np.float64]

_BINS = 30
_SAME = 1e-6  # m, far below the resolution of such sensors


def by_correlation(diagnosis: Diagnosis) -> list[str]:
    """Columns that vary, those first that the change by the model (or the residual) follows most.

    The first one is the column that a sentence about the whole change would name.

    Parameters
    ----------
    diagnosis : Diagnosis

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


def binned(x: Column) -> NDArray[np.int64]:
    """Bin of each value: about equally many rows in each, or one for each value where these are few."""
    count = min(_BINS, max(2, len(x) // 3))
    distinct, bins = np.unique(x, return_inverse=True)
    if len(distinct) > count:
        edges = np.unique(np.quantile(x, np.linspace(0, 1, count + 1)))
        bins = np.clip(np.searchsorted(edges, x, side="right") - 1, 0, max(len(edges) - 2, 0))
    return np.asarray(bins, dtype=np.int64)


def _explained_variance(x: Column, y: Column) -> float:
    """Part of the variance of y that the means of bins of x explain."""
    bins = binned(x)
    rows = np.bincount(bins)
    filled = rows > 0
    means = np.bincount(bins, weights=y)[filled] / rows[filled]
    return float(rows[filled] @ (means - y.mean()) ** 2 / max(len(y) * y.var(), 1e-300))


def _varies(column: Column) -> bool:
    return bool(np.isfinite(column).all() and np.ptp(column) > 0)
