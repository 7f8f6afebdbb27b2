"""Robust losses: they limit the influence of large residuals; the covariance accounts for it."""

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

__all__ = ["LOSSES", "psi", "robust_scale"]

Array = NDArray[np.float64]
Loss = Callable[[Array], Array]


def _linear(z: Array) -> Array:
    return np.stack([z, np.ones_like(z), np.zeros_like(z)])


def _soft_l1(z: Array) -> Array:
    t = 1.0 + z
    return np.stack([2.0 * (np.sqrt(t) - 1.0), t**-0.5, -0.5 * t**-1.5])


def _huber(z: Array) -> Array:
    inner = z <= 1.0
    t = np.where(inner, 1.0, z)
    return np.stack(
        [
            np.where(inner, z, 2.0 * np.sqrt(t) - 1.0),
            np.where(inner, 1.0, t**-0.5),
            np.where(inner, 0.0, -0.5 * t**-1.5),
        ]
    )


def _cauchy(z: Array) -> Array:
    t = 1.0 + z
    return np.stack([np.log1p(z), 1.0 / t, -1.0 / t**2])


LOSSES: dict[str, Loss] = {"linear": _linear, "soft_l1": _soft_l1, "huber": _huber, "cauchy": _cauchy}
"""rho, rho' and rho'' of the squared scaled residual, shape (3, n), as scipy takes them."""


def psi(loss: str, residuals: Array, scale: float) -> tuple[Array, Array]:
    """First and second derivative of the cost to each residual, each of shape (n,)."""
    z = (residuals / scale) ** 2
    _, first, second = LOSSES[loss](z)
    return first * residuals, first + 2.0 * second * z


def robust_scale(residuals: Array, parameters: int) -> float:
    """Standard deviation from the median absolute residual, corrected for the parameters.

    The factor 1.4826 = 1 / Phi^-1(3/4) makes it the standard deviation of a normal distribution.
    """
    n = len(residuals)
    return float(1.4826 * np.median(np.abs(residuals)) * np.sqrt(n / max(n - parameters, 1)))
