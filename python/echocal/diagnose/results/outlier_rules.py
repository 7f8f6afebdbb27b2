"""Rules by which a correction finds the outliers that the diagnosis left out, in other rows too."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from echocal.diagnose.preprocess.off_station import OFF_STATION
from echocal.diagnose.preprocess.outliers import FAR, robust
from echocal.diagnose.results.fates import USED, Fates
from echocal.diagnose.settings import Settings
from echocal.model import Model
from echocal.observations import Observations
from echocal.observations.correction import corrected_distance
from echocal.observations.marks import RowRule, apart_from_neighbors, marked

__all__ = ["outlier_rules", "unmet"]

Column = NDArray[np.float64]

_OUTLIERS = (FAR, OFF_STATION, "crosstalk", "multipath")


def outlier_rules(
    observations: Observations, reference: Column | None, fates: Fates, model: Model, settings: Settings
) -> list[RowRule]:
    """Rules that the used rows meet in no row, and most of the left-out outliers do.

    A row is compared with its neighbors: by its error where the reference distance is known, and by
    its distance, which tells a resting target without one.

    Parameters
    ----------
    observations : Observations
        The table as it was read.
    reference : ndarray, shape (n,), or None
        Reference distances [m].
    model : Model
        Of the diagnosis.
    """
    if fates.counts.keys().isdisjoint(_OUTLIERS):
        return []
    used, off = fates.fate == USED, np.isin(fates.fate.astype(str), _OUTLIERS)
    distance = corrected_distance(observations, model)
    compared = (
        {"": distance} if reference is None else {"reference_distance": distance - reference, "": distance}
    )
    rules = []
    for quantity, values in compared.items():
        apart = np.abs(apart_from_neighbors(values))
        own = apart[used & np.isfinite(apart)]
        if not len(own):
            continue
        limit = max(settings.faults.far.deviations * robust(own)[1], float(own.max()))
        if np.mean(apart[off & np.isfinite(apart)] > limit) > 0.5:
            rules.append(RowRule(reason=FAR, kind="far from neighbors", quantity=quantity, deviation=limit))
    return rules


def unmet(
    observations: Observations, reference: Column | None, fates: Fates, model: Model, rules: Sequence[RowRule]
) -> list[str]:
    """What a correction must be told of outliers that were left out and that no rule finds; else nothing.

    Parameters
    ----------
    observations, reference, fates, model
        As in `outlier_rules`.
    rules : sequence of RowRule
        All that the model keeps.
    """
    off = np.isin(fates.fate.astype(str), _OUTLIERS)
    if not off.any():
        return []
    distance = corrected_distance(observations, model)
    found, _ = marked(observations, distance, reference, tuple(rules))
    lost = int((off & (found == "") & np.isfinite(distance)).sum())
    return [f"{FAR} ({lost} of {int(off.sum())} such rows)"] if lost else []
