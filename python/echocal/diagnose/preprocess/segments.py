"""Segments of an unknown level: the rows between two steps."""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from echocal.diagnose.preprocess.series import series_starts
from echocal.diagnose.preprocess.table import Table

__all__ = ["divided"]

Labels = NDArray[np.int64]


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
        starts=series_starts(elapsed, breaks, gap),
        steps=np.sort(steps),
    )
