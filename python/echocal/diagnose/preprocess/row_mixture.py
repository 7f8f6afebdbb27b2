"""The rows of each visit as a mixture: the core, rows that missed whole periods, and wild rows."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from echocal.diagnose.settings.noise_models import VARIANCE_FLOOR

__all__ = ["PERIOD", "RowMixture", "row_mixture"]

Column = NDArray[np.float64]
Labels = NDArray[np.int64]

PERIOD = 25e-6
"""Period of the burst [s], of 40 kHz (HC-SR04 data sheet)."""

_ORDERS = np.array([0.0, 1.0, -1.0, 2.0])
"""Whole periods that a row may be off its visit."""

_APART = 5.0
"""Periods are told apart where one is so many standard deviations of the core: at fewer, a row is of either
group with a probability of more than 1 %."""

_WIDTH = 2.0
"""Range of the readings of a wild row [m]: half of that of an HC-SR04."""

_PRIOR = np.array([0.95, 0.01, 0.01, 0.01, 0.02])
"""Shares at first; the rounds forget them."""

_ROUNDS = 25

_TAME, _OF_TAME = 0.75, 0.6
"""The scatter starts from this part of the rows, the nearest ones; of normal ones their rms is 0.6 of it."""


@dataclass(frozen=True, eq=False)
class RowMixture:
    """Rows of visits.

    Attributes
    ----------
    mean : ndarray, shape (visits,)
        Of the core of each visit [m].
    scatter : float
        Standard deviation of the core [m].
    """

    mean: Column
    scatter: float


def row_mixture(reading: Column, visit: Labels, period: Column, rounding: float = 0.0) -> RowMixture:
    """Fit the mixture, its shares and its scatter common to all visits.

    docs/method/rows-and-candidates.md, Eq. 1a.

    Parameters
    ----------
    reading : ndarray, shape (n,)
        [m].
    visit : ndarray of int, shape (n,)
        Visit of each row, in ascending order from 0.
    period : ndarray, shape (n,)
        Length of one period [m].
    rounding : float
        Standard deviation of the error of rounding of a reading [m]: the core scatters no less.
    """
    least = max(rounding, VARIANCE_FLOOR)
    count = np.bincount(visit)
    firsts = np.append(0, np.cumsum(count)[:-1])
    order = np.lexsort((reading, visit))
    middle = 0.5 * (reading[order[firsts + (count - 1) // 2]] + reading[order[firsts + count // 2]])
    off = reading - middle[visit]
    free = max(len(reading) - len(count), 1) / len(reading)  # a median takes up a part of the scatter
    fitted = _fitted(off, period, _ORDERS, free, least)
    if not float(np.median(period)) > _APART * fitted[0]:  # periods are not told apart
        fitted = _fitted(off, period, _ORDERS[:1], free, least)
    scatter, kept, missed = fitted
    mean = np.bincount(visit, kept * (reading - missed * period)) / np.bincount(visit, kept)
    return RowMixture(np.asarray(mean), scatter)


def _fitted(
    off: Column, period: Column, orders: Column, free: float, floor: float
) -> tuple[float, Column, Column]:
    """Scatter of the core; of each row, whether it is not wild (probability), and its missed periods."""
    least = np.sort(np.abs(off))[: int(_TAME * len(off)) or 1]
    scatter = max(float(np.sqrt(np.mean(least**2) / free)) / _OF_TAME, floor)
    share = np.append(_PRIOR[: len(orders)], _PRIOR[-1])
    squares = (off - orders[:, None] * period) ** 2
    part = np.empty((len(share), len(off)))
    for _ in range(_ROUNDS):
        np.multiply(squares, -0.5 / scatter**2, out=part[:-1])
        part[:-1] += np.log(share[:-1, None] / (np.sqrt(2 * np.pi) * scatter))
        part[-1] = np.log(share[-1] / _WIDTH)
        np.exp(part - part.max(axis=0), out=part)
        part /= part.sum(axis=0)
        share = np.maximum(part.mean(axis=1), 1e-4)
        share /= share.sum()
        weight = part[:-1]
        square = float((weight * squares).sum() / weight.sum() / free)
        scatter = max(float(np.sqrt(square)), floor)
    kept = np.maximum(weight.sum(axis=0), 1e-6)
    return scatter, kept, np.asarray(orders @ weight / kept)
