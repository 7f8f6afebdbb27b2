"""The grouping of rows: series, stations or segments, and their distances."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

__all__ = ["Order"]

Labels = NDArray[np.int64]


@dataclass(frozen=True, eq=False)
class Order:
    """The grouping of rows.

    Attributes
    ----------
    starts : ndarray of bool, shape (n,)
        First rows of series. Noise is not autocorrelated from one series to the next.
    groups : ndarray of int, shape (n,)
        Segment of constant level, or station, of each row.
    distance : ndarray, shape (n,)
        Of each row [m].
    flat_level : bool
        Whether each group has an unknown level with a flat prior; else it has a random error.
    """

    starts: NDArray[np.bool_]
    groups: Labels
    distance: NDArray[np.float64]
    flat_level: bool

    def at(self, rows: Labels) -> "Order":
        """Of some rows alone, in ascending order."""
        starts = self.starts[rows]
        starts[1:] |= np.diff(rows) > 1
        starts[:1] = True
        return Order(starts, self.groups[rows], self.distance[rows], self.flat_level)

    def cells(self, blocks: Labels) -> tuple[Labels, tuple[Labels, Labels]]:
        """Cell of each row, and block and group of each cell. A cell is the rows of a group in a block."""
        groups = int(self.groups.max()) + 1
        code = blocks * groups + self.groups
        present = np.flatnonzero(np.bincount(code))
        place = np.zeros(int(present[-1]) + 1, dtype=np.int64)
        place[present] = np.arange(len(present))
        return place[code], np.divmod(present, groups)
