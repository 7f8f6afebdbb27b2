"""The reference distance of every row, from the table or from the user."""

from numbers import Real
from typing import Any

import numpy as np
from numpy.typing import NDArray

from echocal.errors import UsageError
from echocal.observations import Observations
from echocal.observations.units import NAMES

__all__ = ["reference_of", "refuse_distance"]


def refuse_distance(given: Any) -> None:
    """Refuse an impossible reference distance."""
    low, high = NAMES["distance_m"][0].physical
    if given is not None and not (isinstance(given, Real) and low < float(given) <= high):
        message = f"reference distance is {given} m; give {low:g} < distance <= {high:g}"
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
            "the table has no reference distance: map a column to distance_m, give --reference-distance M, "
            "or give --constant-distance if the target did not move"
        )
        raise UsageError(message)
    return observations.reference_distance
