"""Rows of another echo: far from the usual reading at their station."""

import numpy as np
from numpy.typing import NDArray

from echocal.diagnose.preprocess.wild import wild_beyond
from echocal.diagnose.settings.rows import RowSettings
from echocal.observations.quantiles import MAD_TO_SD, Grouped, median

__all__ = ["OFF_STATION", "far_from_station"]

Column = NDArray[np.float64]
Mask = NDArray[np.bool_]
Labels = NDArray[np.int64]

OFF_STATION = "far from the usual reading at its station: another echo"
"""Why a row is left out."""


def far_from_station(
    indication: Column,
    labels: Labels,
    temperature: Column | None,
    settings: RowSettings,
    step: float = 0.0,
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
    settings : RowSettings
    step : float
        Step of the readings [m].

    Returns
    -------
    ndarray of bool, shape (n,)
    """
    none = np.zeros(len(indication), dtype=bool)
    members = np.bincount(labels)
    if np.median(members[members > 0]) < settings.fewest:
        return none
    by_station = Grouped(labels)
    centers, usual, farthest = by_station.scatter(indication)
    scatter = MAD_TO_SD * float(np.nanmedian(usual))
    if farthest <= settings.far_least + step:
        return none
    off = np.abs(indication - centers[labels])
    beyond = wild_beyond(off, scatter, median(np.abs(centers)), step, settings)
    least = max(min(beyond, settings.off_station * scatter), settings.far_least + step)
    limit = np.full(len(indication), least)
    if temperature is not None:
        warming = temperature - by_station.median(temperature)[labels]
        limit += settings.per_kelvin * np.abs(warming * indication)
    far = (off > limit) & (members[labels] >= settings.fewest)
    first = int(far.argmax())
    is_step = len(far) - first >= settings.fewest and far[first:].mean() > settings.as_a_whole
    return none if far.any() and is_step else np.asarray(far)
