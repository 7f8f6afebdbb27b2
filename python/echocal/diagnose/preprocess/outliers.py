"""Outliers: rows with another echo, or without a real reading."""

from collections import Counter
from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import NDArray

from echocal.diagnose.preprocess.stations import stations
from echocal.diagnose.preprocess.usable import Usable, some
from echocal.diagnose.settings.rows import RowSettings
from echocal.observations import Observations
from echocal.observations.quantiles import Grouped, median

__all__ = ["FAR", "OFF_STATION", "far_rows", "robust", "without_outliers"]

Column = NDArray[np.float64]
Mask = NDArray[np.bool_]
Labels = NDArray[np.int64]

FAR = "far from its neighbors or from the base simulation"
OFF_STATION = "far from the usual reading at its station: another echo"
"""Reasons why a row is left out."""

_MAD_TO_SD = 1.4826  # of a normal distribution


def robust(values: Column) -> tuple[float, float]:
    """Median and robust standard deviation."""
    known = values if np.isfinite(values).all() else values[~np.isnan(values)]
    center = median(known)
    return center, _MAD_TO_SD * median(np.abs(known - center))


def far_rows(
    indication: Column,
    expected: Column | None,
    orders: Callable[[], Sequence[Column]],
    settings: RowSettings,
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

    Returns
    -------
    ndarray of bool, shape (n,)
        Includes rows with a physically possible deviation if no neighbor deviates as much.
    """
    if len(indication) <= 2 * settings.half_window:
        return np.zeros(len(indication), dtype=bool)
    if expected is None:
        import pandas as pd  # takes long to import

        window = pd.Series(indication).rolling(2 * settings.half_window + 1, center=True, min_periods=1)
        expected = window.median().to_numpy()
    deviation = indication - expected
    center, spread = robust(deviation)
    usual = settings.far * spread
    if max(center - np.fmin.reduce(deviation), np.fmax.reduce(deviation) - center) <= usual:
        return np.zeros(len(indication), dtype=bool)
    off = np.abs(deviation - center)
    far = np.asarray(off > np.maximum(usual, settings.far_relative * np.abs(expected)))
    limit = max(usual, settings.far_least)
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


def far_as_a_whole(far: Mask, labels: Labels, settings: RowSettings) -> Mask:
    """Find the rows of stations most of whose rows are far: an error of the station, not outliers.

    Parameters
    ----------
    far : ndarray of bool, shape (n,)
    labels : ndarray of int, shape (n,)
        Placement of the target of each row.

    Returns
    -------
    ndarray of bool, shape (n,)
    """
    members = np.bincount(labels)
    far_ones = np.bincount(labels, far)
    most = (far_ones > settings.as_a_whole * members) & (members >= settings.station_tells)
    return np.asarray(most[labels])


def far_from_station(
    indication: Column, labels: Labels, temperature: Column | None, settings: RowSettings
) -> Mask:
    """Find rows far from the usual reading at their station, because of another echo.

    If most of the last rows of the table are far, this is a step and not a set of outliers.

    Parameters
    ----------
    indication : ndarray, shape (n,)
        Readings [m], in the order recorded.
    labels : ndarray of int, shape (n,)
        Placement of the target of each row.
    temperature : ndarray, shape (n,), or None
        Air temperature [degC]; limits the possible change by the air.

    Returns
    -------
    ndarray of bool, shape (n,)
    """
    none = np.zeros(len(indication), dtype=bool)
    members = np.bincount(labels)
    if np.median(members[members > 0]) < settings.station_tells:
        return none
    by_station = Grouped(labels)
    centers, usual, farthest = by_station.scatter(indication)
    least = max(settings.off_station * _MAD_TO_SD * float(np.nanmedian(usual)), settings.far_least)
    if farthest <= least:
        return none
    off = np.abs(indication - centers[labels])
    limit = np.full(len(indication), least)
    if temperature is not None:
        warming = temperature - by_station.median(temperature)[labels]
        limit += settings.per_kelvin * np.abs(warming * indication)
    far = (off > limit) & (members[labels] >= settings.station_tells)
    first = int(far.argmax())
    is_step = len(far) - first >= settings.station_tells and far[first:].mean() > settings.as_a_whole
    return none if far.any() and is_step else np.asarray(far)


def without_outliers(
    observations: Observations, usable: Usable, reference: Column | None, settings: RowSettings
) -> tuple[Usable, Labels | None]:
    """Leave out outliers.

    Parameters
    ----------
    observations : Observations
    usable : Usable
    reference : ndarray, shape (total,), or None
        Reference distance of every row of the source [m]; None where it is not known.
    settings : RowSettings

    Returns
    -------
    Usable
    ndarray of int, or None
        Station of each row that is left; None where the reference is not known.
    """
    columns = (reference, observations.conditions.get("temperature"))

    def orders() -> list[Column]:
        """Columns by which neighbors are found: the row, the distance and the temperature."""
        rows = usable.rows
        return [rows.astype(np.float64), *(some(column, rows) for column in columns if column is not None)]

    if reference is None:
        far = far_rows(usable.indication, None, orders, settings)
        return _without(usable, far, FAR), None
    far = far_rows(usable.indication, some(reference, usable.rows), orders, settings)
    if far.any():
        far &= ~far_as_a_whole(far, stations(observations, reference, usable.rows, settings), settings)
    usable = _without(usable, far, FAR)
    if not len(usable.rows):
        return usable, None
    labels, warm = stations(observations, reference, usable.rows, settings), columns[1]
    temperature = None if warm is None else some(warm, usable.rows)
    far = far_from_station(usable.indication, labels, temperature, settings)
    if far.any():
        usable = _without(usable, far, OFF_STATION)
        labels = stations(observations, reference, usable.rows, settings)
    return usable, labels


def _without(usable: Usable, rows: Mask, reason: str) -> Usable:
    """Leave out some of the rows."""
    if not rows.any():
        return usable
    left_out = Counter(usable.left_out) + Counter({reason: int(rows.sum())})
    return Usable(usable.rows[~rows], usable.indication[~rows], left_out)
