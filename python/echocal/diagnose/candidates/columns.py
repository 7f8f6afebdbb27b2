"""Columns of candidate causes: recipes that are computed block by block in a pass over the rows."""

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.polynomial.legendre import legvander
from numpy.typing import NDArray

from echocal import _core
from echocal.diagnose.preprocess.order import Order
from echocal.model import Model
from echocal.observations.quantiles import spread
from echocal.quantities import QUANTITIES

__all__ = ["Columns", "legendre", "waves"]

Column = NDArray[np.float64]
Labels = NDArray[np.int64]


_CLIP = 1.5  # scaled values are cut off there, as in rust/infer: far ones must not bend a curve


def legendre(values: Column, low: float, high: float, last: int) -> Column:
    """Legendre polynomials of values that are scaled to -1..1 between two others, a line for each degree."""
    scaled = (2.0 * values - low - high) / max(high - low, 1e-300)
    return np.asarray(legvander(np.clip(scaled, -_CLIP, _CLIP), last).T)


def waves(values: Column, period: float, count: int) -> list[tuple[Column, Column]]:
    """Sine and cosine of so many multiples of the phase of values, from the first on."""
    turns = 2.0 * np.pi * (values / period % 1.0)
    return [(np.sin(k * turns), np.cos(k * turns)) for k in range(1, count + 1)]


class Columns:
    """Columns of one table, each identified by its position.

    Parameters
    ----------
    base : Model
        The base simulation.
    distance : ndarray, shape (n,)
        Reference distance, or the level of the segment of each row [m].
    conditions : mapping of str to ndarray
        Recorded influence quantities.
    groups : ndarray of int, shape (n,), or None
        Segment of each row if the level is unknown; None if the distance is known.
    """

    def __init__(
        self, base: Model, distance: Column, conditions: Mapping[str, Column], groups: Labels | None
    ) -> None:
        given: dict[str, Column | float] = {**base.air}
        given |= {name: np.ascontiguousarray(column) for name, column in conditions.items()}
        missing = {name: np.nan if q.default is None else q.default for name, q in QUANTITIES.items()}
        recorded = [given.get(name, missing[name]) for name in QUANTITIES]
        labels = None if groups is None else groups.astype(np.uint32)
        self._core = _core.Columns(base._core, np.ascontiguousarray(distance), recorded, labels)

    def __len__(self) -> int:
        return len(self._core)

    def __getitem__(self, position: int) -> Column:
        column: Column = self.at([position])[0]
        return column

    def at(self, positions: Sequence[int], rows: Labels | None = None) -> Column:
        """Compute some columns, one per line, at all rows or at some rows in ascending order."""
        wanted = None if rows is None else np.ascontiguousarray(rows, dtype=np.uintp)
        made: Column = self._core.made(list(positions), wanted)
        return made

    def combined(self, positions: Sequence[int], factors: Column) -> Column:
        """Sum of some columns, each multiplied by its factor, at all rows."""
        return self._core.combined(list(zip(positions, factors.tolist(), strict=True)))

    def slope(self) -> int:
        """Add the derivative of the base's reading with respect to the distance."""
        return self._core.slope()

    def store(self, column: Column) -> int:
        """Add a column by its values."""
        return self._core.store(np.ascontiguousarray(column))

    def shift(self, id_: str, at: Mapping[str, float], levels: Column | None) -> int:
        """Add the change of the reading by an effect [m]; `levels` are those of the segments with it [m]."""
        return self._core.shift(id_, list(at.items()), levels)

    def tangent(
        self,
        id_: str,
        at: Mapping[str, float],
        name: str,
        scale: float,
        *,
        at_work: bool = False,
        levels: Column | None = None,
    ) -> int:
        """Add the derivative of the reading with respect to a parameter of an effect, times a scale.

        Parameters
        ----------
        id_, name : str
            The effect and its parameter.
        at : mapping of str to float
            Parameters at which it is taken.
        at_work : bool
            Whether the effect acts at these parameters.
        levels : ndarray, optional
            Level of each segment if it does [m].
        """
        return self._core.tangent(id_, list(at.items()), at_work, levels, name, scale)

    def legendre(
        self, column: Column, low: float, high: float, scales: Sequence[float], *, first: int = 1
    ) -> list[int]:
        """Add Legendre polynomials of a column, scaled to -1..1 between two values, without their means.

        Parameters
        ----------
        column : ndarray, shape (n,)
        scales : sequence of float
            Factor of each degree.
        first : int, default: 1
            Lowest degree. If it is 2, the straight line that fits best is subtracted from each.
        """
        some = spread(column)
        functions = legendre(some, low, high, first + len(scales) - 1)[first:].T
        (flat, line), last = legendre(some, low, high, 1), min(first, 2)
        fitted = np.linalg.lstsq(np.stack([flat, line][:last], axis=1), functions)[0]
        lines = [(float(one[0]), float(one[1]) if last > 1 else 0.0) for one in fitted.T]
        return self._core.legendre(np.ascontiguousarray(column), low, high, first, list(scales), lines)

    def waves(self, column: Column, period: float, scales: Sequence[float]) -> list[int]:
        """Add sine and cosine of multiples of the phase of a column, without their means.

        Parameters
        ----------
        column : ndarray, shape (n,)
        scales : sequence of float
            Factor of each multiple, from the first on.
        """
        each = waves(spread(column), period, len(scales))
        means = [(float(sine.mean()), float(cosine.mean())) for sine, cosine in each]
        return self._core.waves(np.ascontiguousarray(column), period, list(scales), means)

    def settle(self) -> None:
        """Subtract from each column what unknown levels fit, once all columns are added."""
        self._core.settle()

    def gram(self) -> Column:
        """Products of all pairs of columns, summed over all rows; settles the columns."""
        self._core.settle()
        gram: Column = self._core.gram()
        return gram

    def products(
        self,
        order: Order,
        blocks: Labels,
        cells: Labels,
        places: tuple[Labels, Labels],
        series: Column,
        correlations: Sequence[float | tuple[float, float, bool] | None],
    ) -> _core.Sums:
        """Lag-0 and lag-1 products, see `Sums`; settles the columns."""
        self._core.settle()
        labels = (blocks.astype(np.uint32), cells.astype(np.uint32))
        where = list(zip(*(place.tolist() for place in places), strict=True))
        return self._core.products(
            order.starts, *labels, order.distance, where, series, list(correlations), order.flat_level
        )
