"""The table as candidates are evaluated on it."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from echocal.diagnose.candidates.columns import Columns
from echocal.diagnose.preprocess.base import Base
from echocal.diagnose.settings import Settings
from echocal.model import Model

__all__ = ["Scene"]

Column = NDArray[np.float64]

_CACHED = 8192  # rows of a block whose columns fit into the cache of a processor


@dataclass(frozen=True)
class Scene:
    """The table as candidates are evaluated on it.

    Attributes
    ----------
    base : Base
        The base simulation.
    distance : ndarray, shape (n,)
        Reference distance, or the level of each row's segment [m].
    conditions : mapping of str to ndarray
        Recorded influence quantities.
    relevel : callable
        ``relevel(model)`` is the distance of every row by that model [m].
    groups : ndarray of int, shape (n,), or None
        Segment of each row if the level is unknown; None if the distance is known.
    residual : ndarray, shape (n,)
        Reading less what the base simulation predicts [m].
    echoes : bool
        Whether the readings come from recorded echo times.
    stated_speed : str
        Speed of the device that the user states; empty where it is that of the base.
    thermometers : mapping of str to ndarray
        Further thermometers [degC], by the names of their columns.
    """

    base: Base
    distance: Column
    conditions: Mapping[str, Column]
    relevel: Callable[[Model], Column]
    groups: NDArray[np.int64] | None
    residual: Column
    settings: Settings
    echoes: bool = False
    stated_speed: str = ""
    thermometers: Mapping[str, Column] = field(default_factory=dict)

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
        return replace(self, conditions={**self.conditions, quantity: self.thermometers[thermometer]})

    def levels(self, id_: str, at: Mapping[str, float]) -> Column | None:
        """Level of each segment with an effect [m]; None if the distance is known."""
        if self.groups is None:
            return None
        firsts = np.unique(self.groups, return_index=True)[1]
        return self.relevel(self.base.model({id_: at}))[firsts]
