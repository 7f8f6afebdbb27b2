"""Least squares on whitened products: a ridge on all columns, and columns that are averaged out."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from echocal.diagnose.inference.noise import VARIANCE_FLOOR
from echocal.diagnose.settings.priors import WIDEST

__all__ = ["ROUNDING", "averaged_out", "principal", "ridge"]

Matrix = NDArray[np.float64]

ROUNDING = 1e-12
"""Part of a sum of squares that arithmetic leaves behind: a few thousand roundings of 1.1e-16."""


def ridge(products: Matrix, degrees: int) -> tuple[Matrix, Matrix]:
    """Sizes of all columns between the first and the last at once, and the mean square that they leave.

    A ridge of three prior standard deviations, beside the mean square of the last column.

    Parameters
    ----------
    products : ndarray, shape (..., k, k)
    degrees : int
        Rows less unknown levels.

    Returns
    -------
    ndarray, shape (..., k - 2)
        In prior standard deviations.
    ndarray, shape (...)
        [m^2].
    """
    among, along, square = products[..., 1:-1, 1:-1], products[..., 1:-1, -1], products[..., -1, -1]
    added = np.maximum(square / degrees, VARIANCE_FLOOR**2) / WIDEST**2
    added = np.maximum(added, ROUNDING * np.trace(among, axis1=-2, axis2=-1))
    whole = among + added[..., None, None] * np.eye(among.shape[-1])
    sizes = np.linalg.solve(whole, along[..., None])[..., 0]
    left = square - (sizes * along).sum(axis=-1) - added * (sizes**2).sum(axis=-1)
    return sizes, np.maximum(left / degrees, VARIANCE_FLOOR**2)


def principal(products: Matrix) -> tuple[Matrix, Matrix]:
    """Squares of the columns between the first and the last, and the last along them, both in principal axes.

    A ridge ``r`` then has the sizes ``along / (squares + r)``.
    """
    squares, axes = np.linalg.eigh(products[1:-1, 1:-1])
    return np.maximum(squares, 0.0), axes.T @ products[1:-1, -1]


def averaged_out(
    products: Matrix, columns: Sequence[int], kept: Sequence[int], place: list[int], variance: Matrix
) -> tuple[Matrix, Matrix]:
    """Products without columns whose sizes are normal, and what that adds to the log evidence.

    docs/method/noises.md, Eq. 41.

    Parameters
    ----------
    products : ndarray, shape (noises, k, k)
    columns : sequence of int
        Averaged out with a standard deviation of 1. Their products are zero in the result.
    kept : sequence of int
        Columns of the result.
    place : list of int
        The matrix that each result comes from.
    variance : ndarray
        Of the innovations, for each result [m^2]; an infinite one takes nothing out.
    """
    own, every = list(columns), list(kept)
    among, along = products[:, own][:, :, own], products[:, own][:, :, every][place]
    least = ROUNDING * np.trace(among, axis1=-2, axis2=-1)[place]
    variance = np.maximum(variance, least)
    variance = np.where(variance > 0.0, variance, 1.0)[:, None, None]  # else the columns are zero
    whole = np.eye(len(own)) + among[place] / variance
    found = products[place] if len(every) == products.shape[-1] else products[np.ix_(place, every, every)]
    found -= along.swapaxes(1, 2) @ np.linalg.solve(whole, along / variance)
    gone = np.isin(every, own)
    found[:, gone] = found[:, :, gone] = 0.0
    return found, -0.5 * np.linalg.slogdet(whole)[1]
