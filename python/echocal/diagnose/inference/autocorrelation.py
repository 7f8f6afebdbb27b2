"""Which correlations of the noise are worth a pass over the rows of a long table."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from echocal.diagnose.candidates.columns import Columns
from echocal.diagnose.inference.innovation import log_likelihood
from echocal.diagnose.inference.least_squares import ridge
from echocal.diagnose.inference.noise import WHITE, Noise, NoiseCorrelation
from echocal.diagnose.inference.sums import Sums
from echocal.diagnose.preprocess.order import Order
from echocal.diagnose.settings.noise_models import NoiseModelSettings

__all__ = ["at_first", "that_may_be_there"]

LONG = 20_000
"""Rows of a longer table, in which impossible noises are excluded first."""

_PRUNED = 300.0  # log likelihood behind the best, beside all columns at once: few columns cannot make it up
_SEGMENTS, _SEGMENT = 5, 20_000  # rows that are used


def at_first(order: Order, settings: NoiseModelSettings) -> Sequence[NoiseCorrelation]:
    """List the correlations that a first pass has: all in a short table, none in a long one.

    Where no row follows another, there is no autocorrelation.
    """
    nothing = len(order.starts) > LONG or order.starts.all()
    return (WHITE,) if nothing else tuple(theta for theta, _ in settings.autoregressions)


def that_may_be_there(
    columns: Columns, sums: Sums, residual: NDArray[np.float64], settings: NoiseModelSettings
) -> list[NoiseCorrelation]:
    """Find the correlations that the residual beside every cause may have.

    Of a long table what is left by all columns together is the noise, but for some numbers. A
    correlation that is ruled out there is ruled out beside any of the causes: beside few of them it
    would have to explain what the others explain, and it cannot do so better.

    Parameters
    ----------
    columns : Columns
        The first is a group's own, the last what is to be explained.
    sums : Sums
        Theirs, of a pass with white noise alone.
    residual : ndarray, shape (n,)
        What is to be explained [m].
    settings : NoiseModelSettings

    Returns
    -------
    list of NoiseCorrelation
        To be summed in one more pass; empty where the noise is white.
    """
    if sums.order.starts.all():
        return []
    products, order = sums.whiten(Noise(0.0, 0.0, 0.0, 1.0)).products, sums.order
    sizes, _ = ridge(products, sums.degrees())
    used = np.flatnonzero(sizes)
    left = residual - columns.combined((1 + used).tolist(), sizes[used])
    rows = _sample(len(left))
    left, order = left[rows], order.at(rows)
    logs = {
        theta: max(log_likelihood(left, order, Noise(theta, rho, 0.0, 1.0)) for rho in rhos if rho)
        for theta, rhos in settings.autoregressions
    }
    least = max(log_likelihood(left, order, Noise(0.0, 0.0, 0.0, 1.0)), *logs.values()) - _PRUNED
    return [theta for theta, log in logs.items() if log > least]


def _sample(rows: int) -> NDArray[np.int64]:
    if rows <= _SEGMENTS * _SEGMENT:
        return np.arange(rows)
    firsts = np.linspace(0, rows - _SEGMENT, _SEGMENTS).astype(np.int64)
    return np.concatenate([np.arange(first, first + _SEGMENT) for first in firsts])
