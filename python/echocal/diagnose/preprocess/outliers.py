"""Outliers: rows that no noise and no air explains."""

from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import NDArray

from echocal.diagnose.preprocess.stations import far_as_a_whole, stations
from echocal.diagnose.preprocess.usable import Usable, some
from echocal.diagnose.preprocess.wild import wild_beyond
from echocal.diagnose.settings.rows import RowSettings
from echocal.observations import Observations
from echocal.observations.quantiles import MAD_TO_SD, median

__all__ = ["FAR", "far_rows", "robust", "without_far_rows"]

Column = NDArray[np.float64]
Mask = NDArray[np.bool_]
Labels = NDArray[np.int64]

FAR = "far from its neighbors or from the base simulation"
"""Why a row is left out."""


def robust(values: Column) -> tuple[float, float]:
    """Median and robust standard deviation."""
    known = values if np.isfinite(values).all() else values[~np.isnan(values)]
    center = median(known)
    return center, MAD_TO_SD * median(np.abs(known - center))


def far_rows(
    indication: Column,
    expected: Column | None,
    orders: Callable[[], Sequence[Column]],
    settings: RowSettings,
    step: float = 0.0,
) -> Mask:
    """Find rows farther off than noise or the air can explain.

    Parameters
    ----------
    indication : ndarray, shape (n,)
        Readings [m], in the order recorded.
    expected : ndarray, shape (n,), or None
        Readings that the base simulation predicts [m]. None where the distance is not known; then
        each row is compared with its neighbors.
    orders : callable
        ``orders()`` are columns, shape (n,), that a deviation may depend on.
    settings : RowSettings
    step : float
        Step of the readings [m]. Rows may be one step apart, even if most are equal.

    Returns
    -------
    ndarray of bool, shape (n,)
        Includes rows with a physically possible deviation if no neighbor deviates as much.
    """
    if len(indication) <= 2 * settings.half_window:
        return np.zeros(len(indication), dtype=bool)
    resting = expected is None
    if expected is None:
        import pandas as pd  # takes long to import

        window = pd.Series(indication).rolling(2 * settings.half_window + 1, center=True, min_periods=1)
        expected = window.median().to_numpy()
    deviation = indication - expected
    center, spread = robust(deviation)
    least = settings.far_least + step
    if max(center - np.fmin.reduce(deviation), np.fmax.reduce(deviation) - center) <= least:
        return np.zeros(len(indication), dtype=bool)
    off = np.abs(deviation - center)
    limit = max(wild_beyond(off, spread, median(np.abs(expected)), step, settings), least)
    possible = 0.0 if resting else np.maximum(settings.far * spread, settings.far_relative * np.abs(expected))
    far = np.asarray(off > np.maximum(limit, possible))
    odd = np.flatnonzero((off > limit) & ~far)
    if 0 < len(odd) <= settings.exceptions:  # a larger number has a common cause
        far[odd[_alone(deviation, odd, orders(), limit, settings.half_window)]] = True
    return far


def _alone(
    deviation: Column, odd: NDArray[np.intp], orders: Sequence[Column], limit: float, neighbors: int
) -> Mask:
    """Whether rows deviate differently from their neighbors in every order.

    Rows with similar values of the column that a cause depends on deviate similarly. A row that
    deviates alone in time, by distance and by temperature is therefore an outlier.
    """
    alone = np.zeros(len(odd), dtype=bool)
    for i, row in enumerate(odd):
        others = np.delete(deviation, row)
        apart = (np.abs(np.delete(order, row) - order[row]) for order in orders)
        near = (np.argpartition(gap, neighbors)[:neighbors] for gap in apart)
        alone[i] = all(abs(deviation[row] - np.median(others[rows])) > limit for rows in near)
    return alone


def without_far_rows(
    observations: Observations,
    usable: Usable,
    reference: Column | None,
    settings: RowSettings,
    step: float = 0.0,
) -> Usable:
    """Leave out rows farther off than noise or the air can explain, but not a whole station.

    Parameters
    ----------
    observations : Observations
    usable : Usable
    reference : ndarray, shape (total,), or None
        Reference distance of every row of the source [m]; None where it is not known.
    settings : RowSettings
    step : float
        Step of the readings [m].
    """
    rows = usable.rows
    columns = (reference, observations.conditions.get("temperature"))

    def orders() -> list[Column]:
        """Columns by which neighbors are found: the row, the distance and the temperature."""
        return [rows.astype(np.float64), *(some(column, rows) for column in columns if column is not None)]

    expected = None if reference is None else some(reference, rows)
    far = far_rows(usable.indication, expected, orders, settings, step)
    if reference is not None and far.any():
        far &= ~far_as_a_whole(far, stations(observations, reference, rows, settings), settings)
    if not far.any():
        return usable
    return usable.without(far, FAR)
