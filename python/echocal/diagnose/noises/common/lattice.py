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

    A mixture of normal distributions one period apart, whose center is a linear function of the causes plus
    an error of each station; fitted by expectation and maximization from several starts. The gain is counted
    from the same fit without integers. It only sorts: the evidence is computed elsewhere.

    Parameters
    ----------
    placements : Placements
    mean : ndarray, shape (p,)
        Sizes at which the search starts.
    seed : int
    """
    spread = _continuous_spread(placements, mean)
    starts = _starts(placements, mean, spread, seed)
    plain = _maximize(placements, mean[None], np.zeros(1), spread, ORDERS[ORDERS == 0])[0][0]
    logs, orders = _maximize(placements, starts, _shifts(len(starts)), spread, ORDERS)
    found: dict[bytes, tuple[float, Labels]] = {}
    for log, integers in zip(logs - plain, orders, strict=True):
        found.setdefault(integers.tobytes(), (float(log), integers))
    return sorted(found.values(), key=lambda one: -one[0])


def _continuous_spread(placements: Placements, mean: Column) -> float:
    left = placements.error - mean @ placements.columns
    return float(np.sqrt(np.mean(left**2))) + 1e-6


def _shifts(count: int) -> Column:
    shifts = np.zeros(count)
    shifts[: len(_PHASES)] = _PHASES
    return shifts


def _starts(placements: Placements, mean: Column, spread: float, seed: int) -> Column:
    """Sizes to start from: those given, and some that normal errors would allow."""
    columns = placements.columns
    starts = np.repeat(mean[None], len(_PHASES) + _DRAWN * bool(len(mean)), axis=0)
    if len(mean):
        inverse = columns @ columns.T / spread**2 + np.eye(len(mean)) / WIDEST**2
        drawn = np.random.default_rng(seed).normal(size=(_DRAWN, len(mean)))
        wide = np.sqrt(len(placements) / 4)  # the phase of a period is found from within a quarter of it
        starts[len(_PHASES) :] += wide * np.linalg.solve(np.linalg.cholesky(inverse).T, drawn.T).T
    return starts


def _maximize(
    placements: Placements, sizes: Column, shifts: Column, spread: float, orders: Labels
) -> tuple[Column, Labels]:
    """Log likelihood and integers from each start."""
    error, columns, period = placements.error, placements.columns, placements.period
    stations = int(placements.station.max()) + 1
    shared = stations < len(error)
    member = np.zeros((len(error), stations)) if shared else np.empty((0, 0))
    if shared:
        member[np.arange(len(error)), placements.station] = 1.0
    usual = float(np.median(period))
    lattice = period[:, None] * orders
    own = np.zeros((len(sizes), stations))
    among = np.full(len(sizes), 0.05 * usual)
    if shared:
        among[1::2] = usual  # of the stations' errors
    scale = np.full(len(sizes), min(usual / 6, spread) if len(orders) > 1 else spread)
    prior = 0.5 ** np.abs(orders)
    share = np.repeat(prior[None] / prior.sum(), len(sizes), axis=0)
    gram, width = columns @ columns.T, np.eye(len(columns)) / WIDEST**2
    center = sizes @ columns + (shifts[:, None] * usual)
    log, weight = np.zeros(len(sizes)), np.empty(0)
    for _ in range(_ROUNDS):
        left = (error - center)[:, :, None] - lattice
        each = -0.5 * (left / scale[:, None, None]) ** 2 + np.log(share)[:, None, :]
        top = each.max(axis=2)
        weight = np.exp(each - top[:, :, None])
        total = weight.sum(axis=2)
        log = (top + np.log(total)).sum(axis=1) - len(error) * np.log(scale)
        weight /= total[:, :, None]
        target = error - (weight * lattice).sum(axis=2)
        if len(columns):
            right = (target - (own[:, placements.station] if shared else 0.0)) @ columns.T
            inverse = gram / scale[:, None, None] ** 2 + width
            sizes = np.linalg.solve(inverse, (right / scale[:, None] ** 2)[:, :, None])[:, :, 0]
        center = sizes @ columns
        if shared:
            ratio = member.sum(axis=0) + (scale / among)[:, None] ** 2
            own = ((target - center) @ member) / ratio
            spare = scale[:, None] ** 2 / ratio
            among = np.sqrt((own**2 + spare).mean(axis=1)) + 0.01 * usual
            center = center + own[:, placements.station]
        square = (weight * ((error - center)[:, :, None] - lattice) ** 2).sum(axis=(1, 2))
        scale = np.sqrt(square / len(error)) + 0.01 * usual
        share = (weight.sum(axis=1) + prior) / (len(error) + prior.sum())
    if shared:
        log = log - stations * np.log(among) - 0.5 * (own**2).sum(axis=1) / among**2
        log += 0.5 * np.log(scale[:, None] ** 2 / (member.sum(axis=0) + (scale / among)[:, None] ** 2)).sum(1)
    log = log - 0.5 * (sizes**2).sum(axis=1) / WIDEST**2
    return log, np.asarray(orders[weight.argmax(axis=2)])
