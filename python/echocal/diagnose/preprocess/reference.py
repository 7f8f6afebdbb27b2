"""The reference distance of every row, as the table or the user gives it."""

from numbers import Real
from typing import Any

import numpy as np
from numpy.typing import NDArray

from echocal.errors import UsageError
from echocal.observations import Observations
from echocal.observations.units import NAMES

__all__ = ["reference_of", "refuse_distance"]


def refuse_distance(given: Any) -> None:
    """Refuse a reference distance that no target can have."""
    low, high = NAMES["distance_m"][0].physical
    if given is not None and not (isinstance(given, Real) and low < float(given) <= high):
        message = f"reference distance is {given} m; give {low:g} < distance <= {high:g}"
        raise UsageError(message)


def reference_of(
    observations: Observations, given: float | None, constant: bool
) -> NDArray[np.float64] | None:
    """Reference distance of every row [m]; None where the user says that it is constant and unknown.

    Raises
    ------
    UsageError
        If it is said to be known and to be unknown, or nobody says what it is.
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
            "or say --constant-distance where the target never moved"
        )
        raise UsageError(message)
    return observations.reference_distance
