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
        warm = np.asarray(self.conditions.get("temperature", np.zeros(len(self.distance))))
        warm = (warm - np.mean(warm)) / max(float(np.std(warm)), 1e-12)
        design = np.stack([np.ones_like(warm), *(self.distance * warm**power for power in range(3))])
        sizes = np.linalg.lstsq(design @ design.T, design @ self.residual, rcond=1e-9)[0]
        return np.asarray(self.residual - sizes @ design)

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
