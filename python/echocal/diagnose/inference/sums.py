"""Sums over the rows of a table, and what noise makes of them."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from echocal import _core
from echocal.diagnose.candidates.columns import Columns
from echocal.diagnose.inference.noise import WHITE, Noise, NoiseCorrelation
from echocal.diagnose.preprocess.order import Order

__all__ = ["Sums", "Whitened"]

Matrix = NDArray[np.float64]


@dataclass(frozen=True)
class Whitened:
    """Products of the columns after whitening and after removing levels, for one noise.

    Attributes
    ----------
    products : ndarray, shape (k, k)
    log_weight : float
        What the noise adds to the log evidence of every hypothesis.
    noise : Noise
    """

    products: Matrix
    log_weight: float
    noise: Noise


@dataclass(frozen=True, eq=False)
class Sums:
    """Lag-0 and lag-1 products of columns, from one pass over the rows.

    Attributes
    ----------
    products : object
        The sums, in the core.
    order : Order
    blocks : ndarray of int, shape (n,)
    correlations : tuple
        What they were summed with.
    cell_block, cell_group : ndarray of int, shape (cells,)
        Block and group (segment, or station) of each cell.
    rows, series : ndarray of int, shape (blocks,)
        Rows, and series begun, per block.
    """

    products: _core.Sums
    order: Order
    blocks: NDArray[np.int64]
    correlations: tuple[NoiseCorrelation, ...]
    cell_block: NDArray[np.int64]
    cell_group: NDArray[np.int64]
    rows: NDArray[np.int64]
    series: NDArray[np.int64]

    @classmethod
    def gather(
        cls,
        columns: Columns,
        order: Order,
        blocks: NDArray[np.int64],
        correlations: Sequence[NoiseCorrelation],
    ) -> "Sums":
        """Pass once over the rows of some columns, of which the first is a group's own."""
        cells, places = order.cells(blocks)
        count = int(blocks.max()) + 1
        series = np.bincount(blocks, weights=order.starts, minlength=count).astype(np.float64)
        return cls(
            products=columns.products(order, blocks, cells, places, series, correlations),
            order=order,
            blocks=blocks,
            correlations=tuple(correlations),
            cell_block=places[0],
            cell_group=places[1],
            rows=np.bincount(blocks, minlength=count),
            series=series.astype(np.int64),
        )

    @property
    def flat_level(self) -> bool:
        """Whether groups have an unknown level (nothing known about it) or a random error."""
        return self.order.flat_level

    def with_correlations(self, columns: Columns, correlations: Sequence[NoiseCorrelation]) -> "Sums":
        """Pass once more over the rows of the same columns, for other correlations."""
        more = Sums.gather(columns, self.order, self.blocks, correlations)
        joined = self.products.joined(more.products)
        return replace(self, products=joined, correlations=(*self.correlations, *correlations))

    def has(self, noise: Noise) -> bool:
        """Whether the rows were summed as a noise asks for."""
        return noise.correlation is WHITE or noise.correlation in self.correlations

    def _place(self, correlation: NoiseCorrelation) -> int:
        """Position of the sums for a correlation: white noise is any autoregression's with coefficient 0."""
        return self.correlations.index(correlation if correlation in self.correlations else 0.0)

    def model(self, noise: Noise) -> _core.NoiseModel:
        """Describe a noise to the core."""
        return _core.NoiseModel(
            self._place(noise.correlation),
            0.0 if noise.growth else noise.rho,
            noise.station_ratio,
            noise.first_weight,
            float(np.log(noise.prior)),
        )

    def whiten_all(
        self, noises: Sequence[Noise], use: NDArray[np.bool_] | None = None
    ) -> tuple[Matrix, Matrix]:
        """Products of the columns whitened for each noise, and what it adds to the log evidence."""
        use = np.ones(len(self.rows), dtype=bool) if use is None else use
        return self.products.whiten([self.model(noise) for noise in noises], use.tolist())

    def whiten(self, noise: Noise, use: NDArray[np.bool_] | None = None) -> Whitened:
        """Products of the whitened columns over the blocks in `use` (all by default)."""
        products, log_weight = self.whiten_all([noise], use)
        return Whitened(products[0], float(log_weight[0]), noise)

    def without_infinite(self) -> "tuple[Sums, NDArray[np.bool_]]":
        """Put zero in place of columns that are not finite; return whether each is, too."""
        products, finite = self.products.without_infinite()
        return replace(self, products=products), np.array(finite)

    def degrees(self, use: NDArray[np.bool_] | None = None) -> int:
        """Rows less unknown levels."""
        use = np.ones(len(self.rows), dtype=bool) if use is None else use
        levels = len(np.unique(self.cell_group[use[self.cell_block]])) if self.flat_level else 0
        return int(self.rows[use].sum()) - levels
