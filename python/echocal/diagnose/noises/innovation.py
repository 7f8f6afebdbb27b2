"""What guards leave of the residuals: innovations."""

import numpy as np
from numpy.typing import NDArray

from echocal import _core
from echocal.diagnose.case import Case
from echocal.diagnose.evidence import Weighed
from echocal.diagnose.noise import Noise
from echocal.diagnose.order import Order

__all__ = ["innovation", "left_by"]

Column = NDArray[np.float64]


def left_by(case: Case, weighed: Weighed, rows: NDArray[np.int64]) -> Column:
    """Residual of the base less what a hypothesis makes of it, at some rows [m]."""
    variants = weighed.hypothesis.variants
    fixed = [v.offset for v in variants if v.offset is not None]
    free = [column for v in variants for column in v.free]
    sizes = np.concatenate([np.ones(len(fixed)), weighed.mean])
    return np.asarray(case.residual[rows] - sizes @ case.found.columns.at([*fixed, *free], rows))


def innovation(left: Column, order: Order, noise: Noise) -> Column:
    """Take out what a guard knows: the stands' own errors and what the rows before tell.

    Parameters
    ----------
    left : ndarray, shape (n,)
        Residuals [m].
    order : Order
    noise : Noise

    Returns
    -------
    ndarray, shape (n,)
        In units in which they are as dense as the residuals, so that likelihoods compare [m].
    """
    if noise.stand_ratio > 0.0:
        count = np.bincount(order.groups)
        shrunken = np.bincount(order.groups, left) * noise.stand_ratio / (1 + noise.stand_ratio * count)
        left = left - shrunken[order.groups]
    if noise.rho == 0.0:
        return left
    series = (np.ascontiguousarray(left), order.starts, order.distance)
    white, log_variance = _core.whitened(noise.remembers, noise.rho, noise.first_weight, *series)
    return np.asarray(white * np.exp(0.5 * log_variance / len(left)))
