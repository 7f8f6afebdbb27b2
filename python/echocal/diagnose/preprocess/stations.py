"""Stations: placements of the target."""

import numpy as np
from numpy.typing import NDArray

from echocal.diagnose.preprocess.usable import some
from echocal.diagnose.settings.rows import RowSettings
from echocal.observations import Observations

__all__ = ["far_as_a_whole", "moved", "stations"]

Labels = NDArray[np.int64]
Mask = NDArray[np.bool_]


def stations(
    observations: Observations, reference: NDArray[np.float64], rows: Labels, settings: RowSettings
) -> Labels:
    """Station of each of some rows: as recorded, else one for each reference distance.

    If nearly every row has a distance of its own, an error per station is the same as noise of
    single rows. Then all rows are one station.
    """
    import pandas as pd  # takes long to import

    labels = observations.labels.get("stand")
    source = some(reference, rows) if labels is None else labels[rows]
    groups = pd.factorize(source, sort=True)[0].astype(np.int64)
    return groups if 1 + groups.max() <= len(rows) // settings.rows_per_station else np.zeros_like(groups)


def moved(observations: Observations, rows: Labels) -> Mask:
    """Rows, from the second of some rows on, before which the target was placed anew."""
    labels = observations.labels.get("stand")
    if labels is None:
        return np.zeros(max(len(rows) - 1, 0), dtype=bool)
    return np.asarray(labels[rows][1:] != labels[rows][:-1])


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
    most = (far_ones > settings.as_a_whole * members) & (members >= settings.fewest)
    return np.asarray(most[labels])
