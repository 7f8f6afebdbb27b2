"""Which memories of the noise are worth a pass over the rows of a long table."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from echocal.diagnose.candidates.columns import Columns
from echocal.diagnose.inference.innovation import log_likelihood
from echocal.diagnose.inference.noise import VARIANCE_FLOOR, WHITE, Memory, Noise
from echocal.diagnose.inference.sums import Sums
from echocal.diagnose.preprocess.order import Order
from echocal.diagnose.settings.noise_models import NoiseModelSettings

__all__ = ["at_first", "that_may_be_there"]

_STRETCHES, _STRETCH = 5, 20_000  # rows that are looked at


def at_first(order: Order, settings: NoiseModelSettings) -> Sequence[Memory]:
    """List the memories that a first pass has: all in a short table, none in a long one.

    Where no row follows another, nothing can be remembered.
    """
    nothing = len(order.starts) > settings.long_table or order.starts.all()
    return (WHITE,) if nothing else tuple(memory for memory, _ in settings.autoregressions)


def that_may_be_there(
    columns: Columns, sums: Sums, residual: NDArray[np.float64], settings: NoiseModelSettings
) -> list[Memory]:
    """Find the memories that what every cause together leaves may have.

    Of a long table what is left by all columns together is the noise, but for some numbers. A
    memory that is hopeless there is hopeless beside any of the causes: beside few of them it would
    have to make up for the others, and cannot better than they do.

    Parameters
    ----------
    columns : Columns
        The first is a group's own, the last what is to be explained.
    sums : Sums
        Theirs, of a pass that remembered nothing.
    residual : ndarray, shape (n,)
        What is to be explained [m].
    settings : NoiseModelSettings

    Returns
    -------
    list of Memory
        To be summed in one more pass; empty where the noise remembers nothing.
    """
    if sums.order.starts.all():
        return []
    products, order = sums.whiten(Noise(0.0, 0.0, 0.0, 1.0)).products, sums.order
    among, along = products[1:-1, 1:-1], products[1:-1, -1]
    ridge = max(products[-1, -1] / sums.degrees(), VARIANCE_FLOOR**2) / settings.ridge_width**2
    sizes = np.linalg.solve(among + ridge * np.eye(len(among)), along)
    used = np.flatnonzero(sizes)
    left = residual - columns.combined((1 + used).tolist(), sizes[used])
    rows = _looked_at(len(left))
    left, order = left[rows], order.at(rows)
    logs = {
        memory: max(log_likelihood(left, order, Noise(memory, rho, 0.0, 1.0)) for rho in rhos if rho)
        for memory, rhos in settings.autoregressions
    }
    least = max(log_likelihood(left, order, Noise(0.0, 0.0, 0.0, 1.0)), *logs.values()) - settings.pruning
    return [memory for memory, log in logs.items() if log > least]


def _looked_at(rows: int) -> NDArray[np.int64]:
    if rows <= _STRETCHES * _STRETCH:
        return np.arange(rows)
    firsts = np.linspace(0, rows - _STRETCH, _STRETCHES).astype(np.int64)
    return np.concatenate([np.arange(first, first + _STRETCH) for first in firsts])
