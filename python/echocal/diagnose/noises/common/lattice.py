"""Errors of placements on a lattice of whole periods: which integers fit, beside linear causes."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.special import gammaln

from echocal.diagnose.settings.priors import WIDEST

__all__ = ["ORDERS", "Placements", "log_lattice", "log_prior", "log_prior_along", "propose"]

Column = NDArray[np.float64]
Labels = NDArray[np.int64]

ORDERS = np.arange(-4, 5)
"""Whole periods that a placement may be off."""

_ROUNDS = 25  # of the fixed point; more change no integer of the tables tried
_PHASES = (0.0, 0.25, 0.5, 0.75)  # of a period, at which the fixed point starts
_DRAWN = 4  # starts drawn from the causes' sizes under normal errors
_GRID = 12  # standard deviations of each kind; a finer grid moves no log by 0.1
_PRIOR = 0.5 ** np.abs(ORDERS)  # of an order, in placements: one that is off by k costs k ln 2


@dataclass(frozen=True, eq=False)
class Placements:
    """Means of placements and what causes would add to them.

    Attributes
    ----------
    error : ndarray, shape (k,)
        Median of the residuals of a placement [m].
    columns : ndarray, shape (p, k)
        What each free size of the causes adds, for one prior standard deviation [m].
    period : ndarray, shape (k,)
        Length of one period [m].
    station : ndarray of int, shape (k,)
        Station of each placement: several may share the error of a reference.
    """

    error: Column
    columns: Column
    period: Column
    station: Labels

    def __len__(self) -> int:
        return len(self.error)


def log_prior(orders: Labels) -> float:
    """Log probability of integers, their frequencies unknown: a Dirichlet-multinomial."""
    counts = (orders[:, None] == ORDERS).sum(axis=0)
    total = _PRIOR.sum()
    one = gammaln(total) - gammaln(total + counts.sum())
    return float(one + (gammaln(_PRIOR + counts) - gammaln(_PRIOR)).sum())


def log_prior_along(orders: Labels, column: Column) -> float:
    """The same of integers that change in steps along a column; a step costs its place, sign and size."""
    step = np.abs(np.diff(orders[np.argsort(column, kind="stable")]))
    changes = np.count_nonzero(step)
    first = np.log(_PRIOR[orders[column.argmin()] - ORDERS[0]] / _PRIOR.sum())
    each = np.log(max(len(orders) - 1, 1)) + 2 * np.log(2)
    return float(first - changes * each - step.sum() * np.log(2) - np.log(2))


def log_lattice(placements: Placements, orders: Labels, sizes: int) -> tuple[float, float]:
    """Log Bayes factors against jumps of any size, and against placements that all have a level of their own.

    Under either rival, what is left beside the nearest integer is uniform over a period. Under the lattice it
    is normal: an error of the placement and one that a station's placements share, whose standard deviations
    are summed over a grid in parts of a period.

    Parameters
    ----------
    placements : Placements
        With the errors less whole periods.
    orders : ndarray of int, shape (k,)
    sizes : int
        Free sizes of the causes that were fitted to the placements.
    """
    still = orders == 0
    every = _log_normal(placements, np.ones(len(orders), dtype=bool))
    known = _log_normal(placements, still) if still.any() else 0.0
    jumps = every - known + float(np.log(placements.period[~still]).sum())
    own = every + float(np.log(placements.period).sum()) - 0.5 * sizes * float(np.log(len(orders)))
    return jumps, own


def _log_normal(placements: Placements, chosen: NDArray[np.bool_]) -> float:
    """Log density of some errors, averaged over the standard deviations of the grid."""
    usual = float(np.median(placements.period))
    station = np.unique(placements.station[chosen], return_inverse=True)[1].reshape(-1)
    error, count = placements.error[chosen], np.bincount(station)
    square, total = float((error**2).sum()), np.bincount(station, error)
    own = usual * np.geomspace(0.01, 0.5, _GRID)[:, None]
    shared = usual * np.append(0.0, np.geomspace(0.02, 0.3, _GRID - 1))[None, :]
    ratio = (shared / own)[:, :, None] ** 2
    less = (ratio / (1 + ratio * count) * total**2).sum(axis=2)
    log = -0.5 * (square - less) / own**2 - len(error) * np.log(own * np.sqrt(2 * np.pi))
    log -= 0.5 * np.log1p(ratio * count).sum(axis=2)
    return float(np.logaddexp.reduce(log.ravel()) - np.log(log.size))


def propose(placements: Placements, mean: Column, seed: int) -> list[tuple[float, Labels]]:
    """Integers that may be those of the placements, with their gain in log likelihood, best first.

    The nearest integers to what causes and stations leave, and the causes and stations that fit what the
    integers leave, in turn, from several starts. The gain is counted from the same fit without integers. It
    only sorts: the evidence is computed elsewhere.

    Parameters
    ----------
    placements : Placements
    mean : ndarray, shape (p,)
        Sizes at which the search starts.
    seed : int
    """
    usual, spread = float(np.median(placements.period)), placements.error - mean @ placements.columns
    wide = float(np.sqrt(np.mean(spread**2))) + 1e-6
    levels = [wide] if _own_levels(placements) is None else [wide, 0.05 * usual]
    plain = max(_settled(placements, mean, 0.0, level, ORDERS[ORDERS == 0])[0] for level in levels)
    found: dict[bytes, tuple[float, Labels]] = {}
    for sizes, shift in _starts(placements, mean, wide, seed):
        for level in levels:
            log, orders = _settled(placements, sizes, shift * usual, level, ORDERS)
            if log - plain > found.get(orders.tobytes(), (-np.inf, orders))[0]:
                found[orders.tobytes()] = log - plain, orders
    return sorted(found.values(), key=lambda one: -one[0])


def _own_levels(placements: Placements) -> Column | None:
    """Which placements each station has, one per line; None where each has one."""
    stations = int(placements.station.max()) + 1
    return None if stations == len(placements) else np.eye(stations)[:, placements.station]


def _starts(placements: Placements, mean: Column, spread: float, seed: int) -> list[tuple[Column, float]]:
    """Sizes and phases to start from: those given, and some that normal errors would allow."""
    starts = [(mean, phase) for phase in _PHASES]
    if len(mean):
        columns = placements.columns
        inverse = columns @ columns.T / spread**2 + np.eye(len(mean)) / WIDEST**2
        drawn = np.random.default_rng(seed).normal(size=(_DRAWN, len(mean)))
        wide = np.sqrt(len(placements) / 4)  # the phase of a period is found from within a quarter of it
        starts += [
            (mean + wide * each, 0.0) for each in np.linalg.solve(np.linalg.cholesky(inverse).T, drawn.T).T
        ]
    return starts


def _settled(
    placements: Placements, sizes: Column, shift: float, among: float, allowed: Labels
) -> tuple[float, Labels]:
    """Log likelihood and integers once they settle; stations differ by `among` (standard deviation) [m]."""
    error, period, member = placements.error, placements.period, _own_levels(placements)
    usual = float(np.median(period))
    columns, prior = placements.columns, np.full(len(placements.columns), 1 / WIDEST**2)
    if member is not None:
        columns, prior = np.vstack([columns, member]), np.append(prior, np.full(len(member), 1 / among**2))
    center, scale, orders = sizes @ placements.columns + shift, usual / 6, np.zeros(len(error), np.int64)
    for _ in range(_ROUNDS):
        before, orders = orders, np.clip(np.round((error - center) / period), allowed[0], allowed[-1])
        orders = orders.astype(np.int64)
        target = error - orders * period
        inverse = columns @ columns.T / scale**2 + np.diag(prior)
        found = np.linalg.solve(inverse, columns @ target / scale**2)
        center = found @ columns
        scale = float(np.sqrt(np.mean((target - center) ** 2))) + 0.01 * usual
        if np.array_equal(orders, before):
            break
    cost = 0.5 * float((prior * found**2).sum() - np.log(prior).sum() + np.linalg.slogdet(inverse)[1])
    return log_prior(orders) - len(error) * float(np.log(scale)) - cost, orders
