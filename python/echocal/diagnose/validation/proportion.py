"""How far one error is in proportion to another quantity, row by row."""

import numpy as np
from numpy.typing import NDArray

__all__ = ["proportion"]

Column = NDArray[np.float64]


def proportion(error: Column, to: Column) -> tuple[float, float]:
    """Fit an error by a multiple of another column.

    Parameters
    ----------
    error, to : ndarray, shape (n,)

    Returns
    -------
    tuple of float
        The factor, and the part of the mean square of the error that the multiple is; 0 where one is zero.
    """
    among, square = float(to @ to), float(error @ error)
    if among == 0.0 or square == 0.0:
        return 0.0, 0.0
    factor = float(to @ error) / among
    return factor, factor**2 * among / square
