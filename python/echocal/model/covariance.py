"""Covariance of a model's parameters."""

import numpy as np
from numpy.typing import ArrayLike, NDArray

from echocal.errors import ModelError

__all__ = ["arranged", "checked"]

ROUNDING = 1e-9  # relative asymmetry that a solver may leave


def checked(given: ArrayLike | None, names: tuple[str, ...]) -> NDArray[np.float64] | None:
    """Return the covariance of these parameters if it can be one."""
    if given is None:
        return None
    count = len(names)
    try:
        matrix = np.array(given, dtype=np.float64)
    except (TypeError, ValueError, OverflowError):
        message = f"covariance is no table of {count} rows of {count} numbers each: {', '.join(names)}"
        raise ModelError(message) from None
    if matrix.size == count == 0:
        return np.zeros((0, 0))
    if matrix.shape != (count, count):
        message = f"covariance has shape {matrix.shape}; the model has {count} parameters: {', '.join(names)}"
        raise ModelError(message)
    if not np.isfinite(matrix).all():
        raise ModelError("covariance has values that are not finite numbers")
    variances = np.diag(matrix)
    if (variances < 0.0).any():
        message = f"covariance gives {names[int(np.argmin(variances))]} the variance {variances.min():g} < 0"
        raise ModelError(message)
    scale = np.sqrt(variances)
    with np.errstate(over="ignore"):
        apart = np.abs(matrix - matrix.T)
    if (apart > ROUNDING * np.multiply.outer(scale, scale)).any():
        raise ModelError("covariance is not symmetric")
    matrix.setflags(write=False)
    return matrix


def arranged(
    given: ArrayLike | None, listed: tuple[str, ...], names: tuple[str, ...]
) -> NDArray[np.float64] | None:
    """Return a covariance of listed parameters in the order of names; those not listed were held fixed."""
    matrix = checked(given, listed)
    if matrix is None:
        return None
    whole = np.zeros((len(names), len(names)))
    places = [names.index(name) for name in listed]
    whole[np.ix_(places, places)] = matrix
    whole.setflags(write=False)
    return whole
