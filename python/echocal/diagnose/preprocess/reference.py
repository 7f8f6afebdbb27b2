"""The reference distance of every row, from the table or from the user."""

import warnings
from numbers import Real
from typing import Any

import numpy as np
from numpy.typing import NDArray

from echocal.errors import DataWarning, UsageError
from echocal.keywords import keyword
from echocal.observations import Observations
from echocal.observations.fields import row
from echocal.observations.units import NAMES

__all__ = ["reference_of", "refuse_contradiction", "refuse_distance"]

_APART = 0.02  # of the distance: more than a ruler, a tape or the thermal expansion of a stand explains


def refuse_distance(given: Any) -> None:
    """Refuse an impossible reference distance."""
    low, high = NAMES["distance_m"][0].physical
    if given is not None and not (isinstance(given, Real) and low < float(given) <= high):
        message = f"reference distance is {given} m; give {low:g} < distance <= {high:g}, in meters"
        if isinstance(given, Real) and high < float(given) <= 100 * high:
            message += f" ({given:g} cm is {given / 100:g} m)"
        raise UsageError(message)


def reference_of(
    observations: Observations, given: float | None, constant: bool
) -> NDArray[np.float64] | None:
    """Reference distance of every row [m]; None if it is constant and unknown.

    Raises
    ------
    UsageError
        If it is given and declared unknown, or if it is missing.
    """
    if given is not None and constant:
        raise UsageError("give either a reference distance or constant_distance, not both")
    if constant:
        return None
    if given is not None:
        return np.full(len(observations), float(given))
    if observations.reference_distance is None:
        message = (
            "the table has no reference distance: map a column to distance_m, give "
            f"{keyword('reference_distance')} in m, or give {keyword('constant_distance', True)} if the "
            "target did not move"
        )
        raise UsageError(message)
    return observations.reference_distance


def refuse_contradiction(observations: Observations, given: float | None, constant: bool) -> None:
    """Refuse a distance that the reference distances of the table deny, and doubt a constancy that they deny.

    A distance that is constant at each ``stand`` may differ between them. Where steps of the level are known,
    the reference distances may follow them, so a constancy is not refused.

    Raises
    ------
    UsageError
        If the given distance differs by more than 2 %.

    Warns
    -----
    DataWarning
        If a constant distance varies by more than 2 %.
    """
    known = observations.reference_distance
    if known is None or not (constant or given is not None):
        return
    column = observations.source_names.get("reference_distance", "reference_distance")
    ignored = keyword("columns", {column: "ignore"})
    way = f"leave the option out, or if the column is no distance to the target: {ignored}"
    usable = np.flatnonzero(observations.usable & np.isfinite(known))
    if given is not None:
        apart = usable[np.abs(known[usable] - given) > _APART * given]
        if len(apart):
            message = (
                f"{keyword('reference_distance')} says {given:g} m, and column '{column}' says "
                f"{known[apart[0]]:g} m at {row(apart[0])} ({len(apart)} of {len(usable)} rows differ by "
                f"more than 2 %); {way}"
            )
            raise UsageError(message)
        return
    stand = observations.labels.get("stand", np.zeros(len(known), dtype=np.int64))
    for own in np.unique(stand[usable]):
        rows = usable[stand[usable] == own]
        low, high = rows[known[rows].argmin()], rows[known[rows].argmax()]
        if known[high] - known[low] > _APART * known[high]:
            message = (
                f"{keyword('constant_distance')} says that the target did not move, and column '{column}' "
                f"says {known[low]:g} m at {row(low)} and {known[high]:g} m at {row(high)}. The column is "
                "not used. If the target moved, leave the option out"
            )
            warnings.warn(message, DataWarning, stacklevel=4)
            return
