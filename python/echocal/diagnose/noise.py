"""Noise that the engine reckons with before it names anything: memory, and an error per stand."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

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
    blocks : ndarray, shape (memories, 4, blocks, k, k)
    cells : ndarray, shape (memories, 4, cells, k)
    cell_block, cell_group : ndarray of int, shape (cells,)
        Block and group (stretch, or stand) of each cell.
    rows, series : ndarray of int, shape (blocks,)
        Rows, and series begun, per block.
    flat_level : bool
        Whether groups have an unknown level (nothing known about it) or a random error.
    """

    blocks: NDArray[np.float64]
    cells: NDArray[np.float64]
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
        pairs, cells = np.unique(np.stack([blocks, groups]), axis=1, return_inverse=True)
        cells = cells.reshape(-1)
        gathered = columns.products(starts, blocks, cells, list(_RHO))
        k, count = len(columns), int(blocks.max()) + 1
        return cls(
            blocks=np.stack([np.stack(b).reshape(4, count, k, k) for b, _ in gathered]),
            cells=np.stack([np.stack(c).reshape(4, -1, k) for _, c in gathered]),
            cell_block=pairs[0],
            cell_group=pairs[1],
            rows=np.bincount(blocks, minlength=count),
            series=np.bincount(blocks, weights=starts, minlength=count).astype(np.int64),
            flat_level=flat_level,
        )

    def merged(self, use: NDArray[np.bool_]) -> "Sums":
        """Take the blocks in `use` for one: whitening many noises then costs one addition."""
        cells = use[self.cell_block]
        names, inverse = np.unique(self.cell_group[cells], return_inverse=True)
        member = (inverse == np.arange(len(names))[:, None]).astype(float)  # groups x cells
        summed = member @ self.cells[:, :, cells]
        return Sums(
            blocks=self.blocks[:, :, use].sum(axis=2, keepdims=True),
            cells=summed,
            cell_block=np.zeros(len(names), dtype=np.int64),
            cell_group=names,
            rows=np.array([self.rows[use].sum()]),
            series=np.array([self.series[use].sum()]),
            flat_level=self.flat_level,
        )

    def whiten(self, noise: Noise, use: NDArray[np.bool_] | None = None) -> Whitened:
        """Products of the whitened columns over the blocks in `use` (all by default)."""
        use = np.ones(len(self.rows), dtype=bool) if use is None else use
        memory = list(_RHO).index(noise.memory)
        factors = np.array([1.0, noise.rho**2, -noise.rho, noise.first_weight])
        total = np.tensordot(factors, self.blocks[memory][:, use].sum(axis=1), 1)
        lagged = self.blocks[memory][2][use].sum(axis=0)
        total = total - noise.rho * lagged.T
        cells = np.tensordot(factors, self.cells[memory][:, use[self.cell_block]], 1)
        groups = _sum_by(self.cell_group[use[self.cell_block]], cells)
        log_weight = np.log(noise.prior)
        log_weight += 0.5 * self.series[use].sum() * np.log(noise.first_weight)
        own = groups[:, 0]
        if self.flat_level:
            shrink, log_det = 1 / own, np.log(own).sum()
        else:
            shrink = noise.stand_ratio / (1 + noise.stand_ratio * own)
            log_det = np.log1p(noise.stand_ratio * own).sum()
        total -= groups.T @ (shrink[:, None] * groups)
        return Whitened(total, float(log_weight - 0.5 * log_det), noise)

    def mean_square_step(self) -> float:
        """Mean square of the last column's change from row to row."""
        present, previous, lagged, _ = self.blocks[0][:, :, -1, -1].sum(axis=1)
        steps = self.rows.sum() - self.series.sum()
        return float((present + previous - 2 * lagged) / max(steps, 1))

    def degrees(self, use: NDArray[np.bool_] | None = None) -> int:
        """Rows less unknown levels."""
        use = np.ones(len(self.rows), dtype=bool) if use is None else use
        levels = len(np.unique(self.cell_group[use[self.cell_block]])) if self.flat_level else 0
        return int(self.rows[use].sum()) - levels


def _sum_by(labels: NDArray[np.int64], lines: Matrix) -> Matrix:
    names, inverse = np.unique(labels, return_inverse=True)
    sums = np.zeros((len(names), lines.shape[1]))
    np.add.at(sums, inverse, lines)
    return sums
