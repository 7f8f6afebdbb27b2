"""Noise that the engine reckons with before it names anything: memory, and an error per stand."""

from collections.abc import Collection, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from echocal import _core
from echocal.diagnose.columns import Columns

__all__ = ["FINEST", "NOISES", "Noise", "Sums", "Whitened"]

Matrix = NDArray[np.float64]

FINEST = 1e-9
"""Standard deviation below which no noise is believed [m]; data of a simulation may have none."""

_RHO: dict[float, tuple[float, ...]] = {
    0.0: (0.0, 0.2, 0.4, 0.6, 0.8, 0.9, 0.95, 0.98),
    0.5: (0.7, 0.85, 0.95, 0.99),
    0.8: (0.9, 0.95, 0.98, 0.995),
    0.9: (0.95, 0.98, 0.995),
}
_STAND_RATIO = (0.0, 0.1, 1.0, 10.0)  # variance of a stand's own error over the noise's


@dataclass(frozen=True)
class Noise:
    """White noise on a first-order autoregression, with a random error per stand.

    Attributes
    ----------
    memory, rho : float
        Moving-average and autoregressive coefficient; ``rho > memory``, or both zero.
    stand_ratio : float
        Variance of the error that all rows of a stand share, over that of the innovations.
    prior : float
        Probability before the data.
    """

    memory: float
    rho: float
    stand_ratio: float
    prior: float

    @property
    def first_weight(self) -> float:
        """Innovation variance over the variance of the process: the weight of a series' first row."""
        return (1 - self.rho**2) / (1 - 2 * self.rho * self.memory + self.memory**2)


def _grid(ratios: tuple[float, ...]) -> tuple[Noise, ...]:
    # half of the prior on uncorrelated rows, the usual assumption; half on stands without an error
    pairs = [(m, r) for m, rhos in _RHO.items() for r in rhos]
    rows = {pair: 0.5 if pair == (0.0, 0.0) else 0.5 / (len(pairs) - 1) for pair in pairs}
    stands = {s: 1.0 if len(ratios) == 1 else 0.5 if s == 0.0 else 0.5 / (len(ratios) - 1) for s in ratios}
    return tuple(Noise(m, r, s, rows[m, r] * stands[s]) for m, r in pairs for s in ratios)


NOISES = {False: _grid((0.0,)), True: _grid(_STAND_RATIO)}
"""The noises considered, without and with a random error per stand."""


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


@dataclass(frozen=True)
class Sums:
    """Lag-0 and lag-1 products of columns, from one pass over the rows.

    Attributes
    ----------
    products : object
        The sums, in the core.
    cell_block, cell_group : ndarray of int, shape (cells,)
        Block and group (stretch, or stand) of each cell.
    rows, series : ndarray of int, shape (blocks,)
        Rows, and series begun, per block.
    flat_level : bool
        Whether groups have an unknown level (nothing known about it) or a random error.
    """

    products: _core.Sums
    cell_block: NDArray[np.int64]
    cell_group: NDArray[np.int64]
    rows: NDArray[np.int64]
    series: NDArray[np.int64]
    flat_level: bool

    @classmethod
    def gather(
        cls,
        columns: Columns,
        starts: NDArray[np.bool_],
        blocks: NDArray[np.int64],
        groups: NDArray[np.int64],
        *,
        flat_level: bool,
    ) -> "Sums":
        """Pass once over the rows of some columns, of which the first is a group's own."""
        code = blocks * (int(groups.max()) + 1) + groups
        present = np.flatnonzero(np.bincount(code))
        place = np.zeros(int(present[-1]) + 1, dtype=np.int64)
        place[present] = np.arange(len(present))
        cell_block, cell_group = np.divmod(present, int(groups.max()) + 1)
        count = int(blocks.max()) + 1
        series = np.bincount(blocks, weights=starts, minlength=count).astype(np.float64)
        cells = (cell_block, cell_group)
        return cls(
            products=columns.products(starts, blocks, place[code], cells, series, list(_RHO), flat_level),
            cell_block=cell_block,
            cell_group=cell_group,
            rows=np.bincount(blocks, minlength=count),
            series=series.astype(np.int64),
            flat_level=flat_level,
        )

    def whiten_all(
        self,
        noises: Sequence[Noise],
        use: NDArray[np.bool_] | None = None,
        columns: Collection[int] | None = None,
    ) -> tuple[Matrix, Matrix]:
        """Products of the columns whitened for each noise, and what it adds to the log evidence.

        With `columns`, of these and of what is to be explained alone; others are zero.
        """
        use = np.ones(len(self.rows), dtype=bool) if use is None else use
        memories = list(_RHO)
        given = [
            (memories.index(n.memory), n.rho, n.stand_ratio, n.first_weight, float(np.log(n.prior)))
            for n in noises
        ]
        last = self.products.width - 1
        chosen = None if columns is None else sorted({0, last, *columns})
        return self.products.whiten(given, use.tolist(), chosen)

    def whiten(
        self,
        noise: Noise,
        use: NDArray[np.bool_] | None = None,
        columns: Collection[int] | None = None,
    ) -> Whitened:
        """Products of the whitened columns over the blocks in `use` (all by default)."""
        products, log_weight = self.whiten_all([noise], use, columns)
        return Whitened(products[0], float(log_weight[0]), noise)

    def clear_infinite(self) -> NDArray[np.bool_]:
        """Make columns zero that are not finite; return which are."""
        return np.array(self.products.clear_infinite())

    def mean_square_step(self) -> float:
        """Mean square of the last column's change from row to row."""
        present, previous, lagged = self.products.steps()
        steps = self.rows.sum() - self.series.sum()
        return float((present + previous - 2 * lagged) / max(steps, 1))

    def degrees(self, use: NDArray[np.bool_] | None = None) -> int:
        """Rows less unknown levels."""
        use = np.ones(len(self.rows), dtype=bool) if use is None else use
        levels = len(np.unique(self.cell_group[use[self.cell_block]])) if self.flat_level else 0
        return int(self.rows[use].sum()) - levels
