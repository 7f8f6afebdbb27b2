"""Density of noise: normal, or with the heavier tails of Student's t."""

from math import lgamma, log, pi

import numpy as np
from numpy.typing import NDArray

__all__ = ["fitted", "log_density", "weight"]

Column = NDArray[np.float64]

_ROUNDS = 8  # of the fixed point for a scale
_SMALLEST = 1e-12  # added to a scale, so that numbers that are all zero have one


def log_density(values: Column, scale: Column | float, freedom: float) -> Column:
    """Log density of Student's t, or of the normal distribution for infinite degrees of freedom."""
    square = (values / scale) ** 2
    if np.isinf(freedom):
        return np.asarray(-0.5 * square - np.log(scale) - 0.5 * log(2 * pi))
    constant = lgamma(0.5 * freedom + 0.5) - lgamma(0.5 * freedom) - 0.5 * log(freedom * pi)
    return np.asarray(constant - 0.5 * (freedom + 1) * np.log1p(square / freedom) - np.log(scale))


def weight(values: Column, scale: Column | float, freedom: float) -> Column | float:
    """How much values count beside normal ones of the same scale (doi:10.1080/01621459.1989.10478852)."""
    return 1.0 if np.isinf(freedom) else (freedom + 1) / (freedom + (values / scale) ** 2)


def fitted(values: Column, freedom: float, least: float) -> tuple[Column, Column]:
    """Scale of greatest likelihood of each line, but not below `least`, and the log density there."""
    square = values**2
    scale = np.sqrt(square.mean(axis=-1)) + _SMALLEST
    for _ in range(0 if np.isinf(freedom) else _ROUNDS):
        counts = weight(values, scale[..., None], freedom)
        scale = np.sqrt((counts * square).mean(axis=-1)) + _SMALLEST
    scale = np.maximum(scale, least)
    return scale, log_density(values, scale[..., None], freedom).sum(axis=-1)
