"""Segments of an unknown level, between two steps; and series, whose noise may be autocorrelated."""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from echocal.diagnose.preprocess.table import Table
from echocal.observations.quantiles import median

__all__ = ["divided", "gaps"]

Column = NDArray[np.float64]
Labels = NDArray[np.int64]
Mask = NDArray[np.bool_]


def divided(table: Table, steps: Labels, gap: float) -> Table:
    """Begin a segment at each step, and a series at each segment or station.

    Parameters
    ----------
    table : Table
    steps : ndarray of int
        Source rows at which the level changes; of a known distance there are none.
    gap : float
        Usual intervals after which a series begins.
    """
    groups = table.groups if table.placements is None else table.placements
    breaks = np.zeros(len(table), dtype=bool)
    breaks[1:] = groups[1:] != groups[:-1]
    if table.placements is not None:
        at = table.places(steps)
        breaks[at] = True
        groups = np.cumsum(breaks)
        groups = groups - groups[0]
    elapsed = table.conditions.get("elapsed_time")
    return replace(
        table,
        groups=groups.astype(np.int64),
        starts=_series_starts(elapsed, breaks, gap),
        steps=np.sort(steps),
    )


def _series_starts(elapsed: Column | None, breaks: Mask, gap: float) -> Mask:
    """Find the first rows of series: those after a gap in time or a break."""
    starts = breaks.copy()
    starts[:1] = True
    return starts if elapsed is None else starts | gaps(elapsed, gap)


def gaps(elapsed: Column, longest: float) -> Mask:
    """Rows before which the time has a gap of so many usual intervals, or decreases."""
    late = np.zeros(len(elapsed), dtype=bool)
    if len(elapsed) < 2:
        return late
    wait = np.diff(elapsed)
    usual = median(wait) if np.isfinite(wait).all() else float(np.nanmedian(wait))
    if usual > 0:
        late[1:] = ~((wait >= 0) & (wait <= longest * usual))
    return late
