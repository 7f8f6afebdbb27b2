"""A reference distance that is a level: it rises where the distance falls."""

import numpy as np
from numpy.typing import NDArray

from echocal.errors import DataError
from echocal.keywords import keyword

__all__ = ["refuse_level"]

Column = NDArray[np.float64]

_FEWEST = 8  # rows
_LEAST = 0.02  # m that a level changes at least: more than the steps of readings in whole centimeters
_RATIO = 1 / 3
"""Spread of sum over spread of difference: 1 without any relation, 1/3 at a correlation of -0.8."""
_SPEED = 343.0  # m/s: the height in the message is a rough one


def refuse_level(
    reference: Column, reading: Column | None, echo_time: Column, usable: NDArray[np.bool_], column: str
) -> None:
    """Refuse a reference distance whose sum with the reading is nearly constant, and their difference is not.

    Parameters
    ----------
    reference : ndarray, shape (n,)
        What the table gives as reference distance [m].
    reading : ndarray, shape (n,), or None
        What the device indicates [m].
    echo_time : ndarray, shape (n,)
        Taken where there is no reading [s].
    usable : ndarray of bool, shape (n,)
    column : str
        Name of the column, for the message.

    Raises
    ------
    DataError
        If it looks like a level.
    """
    indicated = 0.5 * _SPEED * echo_time if reading is None else reading
    known = usable & np.isfinite(reference) & np.isfinite(indicated)
    if known.sum() < _FEWEST:
        return
    level, distance = reference[known], indicated[known]
    height = float(np.median(distance + level))
    together, apart, own = (_spread(v) for v in (distance + level, distance - level, level))
    if own < _LEAST or together > _RATIO * apart:
        return
    message = (
        f"column '{column}' looks like a level, not like the distance to the target: where it rises, the "
        f"reading falls. Their sum stays within {together:.3f} m of {height:.2f} m, and their difference "
        f"changes by {apart:.3f} m (90 % of {known.sum()} rows). distance = height - level, where height is "
        f"that of the sensor above the zero of the level, about {height:.2f} m: write this distance into the "
        f"table. To read the table without the column: {keyword('columns', {column: 'ignore'})}; if it is a "
        f"distance all the same: {keyword('trust', [column])}"
    )
    raise DataError(message)


def _spread(values: Column) -> float:
    low, high = np.quantile(values, [0.05, 0.95])
    return float(high - low)
