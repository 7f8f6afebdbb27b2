"""Columns with sizes of their own in every hypothesis, averaged out of the products of all columns."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from echocal.diagnose.inference.noise import VARIANCE_FLOOR

__all__ = ["averaged_out", "noise_variances"]

Matrix = NDArray[np.float64]

_SINGULAR = 1e-12  # of a sum of squares; columns that the rest explains to rounding leave no less


def averaged_out(
    products: Matrix,
    log_weight: Matrix,
    columns: Sequence[int],
    variance: NDArray[np.floating[Any]] | float,
    kept: NDArray[np.int64] | None = None,
) -> tuple[Matrix, Matrix]:
    """Average columns out whose sizes are normal with standard deviation 1: docs/method.md, Eq. 41.

    Parameters
    ----------
    products : ndarray, shape (noises, k, k)
        Whitened products of all columns.
    log_weight : ndarray, shape (noises,)
    columns : sequence of int
        Those that are averaged out.
    variance : float or ndarray, shape (noises,)
        Variance of the innovations [m^2].
    kept : ndarray of int, optional
        Columns of the result; default: all.

    Returns
    -------
    products : ndarray, shape (noises, kept, kept)
    log_weight : ndarray, shape (noises,)
    """
    own = np.array(columns, dtype=np.int64)
    left = products if kept is None else products[:, kept[:, None], kept]
    if not len(own):
        return left, log_weight
    along = products[:, own]
    among = along[:, :, own]
    variance = np.maximum(variance, _SINGULAR * np.trace(among, axis1=1, axis2=2))
    variance = np.where(variance > 0.0, variance, 1.0)  # the columns are zero
    among = among + variance[:, None, None] * np.eye(len(own))
    along = along if kept is None else along[:, :, kept]
    left = left - np.swapaxes(along, 1, 2) @ np.linalg.solve(among, along)
    return left, log_weight - 0.5 * (np.linalg.slogdet(among)[1] - len(own) * np.log(variance))


def noise_variances(products: Matrix, degrees: int, ridge_width: float) -> Matrix:
    """Mean square of what all columns together leave of the last one, under each noise [m^2].

    Parameters
    ----------
    products : ndarray, shape (noises, k, k)
    degrees : int
        Rows less unknown levels.
    ridge_width : float
        Width of the prior of every column, in its standard deviations.

    Returns
    -------
    ndarray, shape (noises,)
    """
    least, last = VARIANCE_FLOOR**2, products[:, -1, -1]
    size = np.trace(products[:, 1:-1, 1:-1], axis1=1, axis2=2)
    added = np.maximum(np.maximum(last / degrees, least) / ridge_width**2, _SINGULAR * size)
    among = products[:, 1:-1, 1:-1] + added[:, None, None] * np.eye(products.shape[-1] - 2)
    along = products[:, 1:-1, -1]
    sizes = np.linalg.solve(among, along[..., None])[..., 0]
    explained = np.einsum("ij,ij->i", sizes, along) + added * np.einsum("ij,ij->i", sizes, sizes)
    return np.asarray(np.maximum((last - explained) / degrees, least))
