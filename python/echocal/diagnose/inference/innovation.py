"""Innovations: residuals without the correlations of the nuisance noise."""

import math

import numpy as np
from numpy.typing import NDArray

from echocal import _core
from echocal.diagnose.inference.noise import VARIANCE_FLOOR, WHITE, Noise
from echocal.diagnose.preprocess.order import Order
from echocal.diagnose.settings import NoiseModelSettings

__all__ = ["innovation", "likeliest", "log_likelihood"]

Column = NDArray[np.float64]


def innovation(left: Column, order: Order, noise: Noise) -> Column:
    """Whiten residuals: subtract the errors of the stations and what the rows before predict.

    docs/method.md, Eq. 3 and 5, and docs/method/noises.md, Eq. 4.

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
    if noise.station_ratio > 0.0:
        count = np.bincount(order.groups)
        shrunken = np.bincount(order.groups, left) * noise.station_ratio / (1 + noise.station_ratio * count)
        left = left - shrunken[order.groups]
    if noise.correlation is WHITE:
        return left
    series = (np.ascontiguousarray(left), order.starts, order.distance)
    white, log_variance = _core.whitened(noise.correlation, noise.rho, noise.first_weight, *series)
    return np.asarray(white * np.exp(0.5 * log_variance / len(left)))


def log_likelihood(left: Column, order: Order, noise: Noise) -> float:
    """Log likelihood of normal noise of unknown size, up to a constant of the rows."""
    square = float(np.mean(innovation(left, order, noise) ** 2))
    return -0.5 * len(left) * math.log(max(square, VARIANCE_FLOOR**2))


def likeliest(left: Column, order: Order, settings: NoiseModelSettings) -> Noise:
    """Most likely noise of residuals, of those that are alike at all distances."""
    noises = [Noise(theta, rho, 0.0, 1.0) for theta, rhos in settings.autoregressions for rho in rhos]
    return max(noises, key=lambda noise: log_likelihood(left, order, noise))
