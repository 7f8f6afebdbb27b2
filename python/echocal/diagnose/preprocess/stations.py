"""Stations: placements of the target."""

import numpy as np
from numpy.typing import NDArray

from echocal.diagnose.preprocess.usable import some
from echocal.diagnose.settings.rows import RowSettings
from echocal.observations import Observations

__all__ = ["stations"]

Labels = NDArray[np.int64]


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
