"""The table as candidates are evaluated on it."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from echocal.diagnose.candidates.columns import Columns
from echocal.diagnose.preprocess.base import Base
from echocal.diagnose.preprocess.table import Table
from echocal.diagnose.settings import Settings

__all__ = ["Scene"]

Column = NDArray[np.float64]

_CACHED = 8192  # rows of a block whose columns fit into the cache of a processor


@dataclass(frozen=True)
class Scene:
    """The table as candidates are evaluated on it.

    Attributes
    ----------
    residual : ndarray, shape (n,)
        Reading less what the base simulation predicts [m].
    """

    table: Table
    base: Base
    residual: Column
    settings: Settings

    @cached_property
    def distance(self) -> Column:
        """Reference distance, or the level of each row's segment [m]."""
        return self.table.distance(self.base.model())

    @property
    def conditions(self) -> Mapping[str, Column]:
        """Recorded influence quantities."""
        return self.table.conditions

    @property
    def groups(self) -> NDArray[np.int64] | None:
        """Segment of each row if the level is unknown; None if the distance is known."""
        return None if self.table.reference is not None else self.table.groups

    @cached_property
    def leftover(self) -> Column:
        """Residual after a fit of a scale and the temperature, shape (n,) [m].

        An onset in time is visible in it, even if other effects act.
        """
        warm = np.asarray(self.conditions.get("temperature", 0.0))
        mean, spread = np.mean(warm), max(float(np.std(warm)), 1e-12)
        firsts = range(0, len(self.distance), _CACHED)

        def design(first: int) -> Column:
            rows = slice(first, first + _CACHED)
            distance = self.distance[rows]
            scaled = ((warm[rows] if warm.ndim else warm) - mean) / spread
            columns = np.empty((4, len(distance)))
            columns[0], columns[1] = 1.0, distance
            for power in (2, 3):  # the distance times the temperature, once and twice
                np.multiply(columns[power - 1], scaled, out=columns[power])
            return columns

        among, along = np.zeros((4, 4)), np.zeros(4)
        for first in firsts:
            columns = design(first)
            among += columns @ columns.T
            along += columns @ self.residual[first : first + _CACHED]
        found = np.linalg.lstsq(among, along, rcond=1e-9)[0]
        left = self.residual.copy()
        for first in firsts:
            left[first : first + _CACHED] -= found @ design(first)
        return left

    def columns(self) -> Columns:
        """An empty set of columns of the table."""
        return Columns(self.base.plain, self.distance, self.conditions, self.groups)

    def bound(self, quantity: str, thermometer: str) -> "Scene":
        """The same, with a quantity read from a further thermometer."""
        conditions = {**self.conditions, quantity: self.table.thermometers[thermometer]}
        return replace(self, table=replace(self.table, conditions=conditions))

    def levels(self, id_: str, at: Mapping[str, float]) -> Column | None:
        """Level of each segment with an effect [m]; None if the distance is known."""
        if self.groups is None:
            return None
        firsts = np.unique(self.groups, return_index=True)[1]
        return self.table.distance(self.base.model({id_: at}))[firsts]
