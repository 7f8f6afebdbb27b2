"""A step of the readings that is only that of the tape beside which they were taken."""

import numpy as np
from numpy.typing import NDArray

from echocal.observations.quantization_grid import FINEST_STEP, QuantizationGrid

__all__ = ["printed_grid", "step_of_the_tape"]

Column = NDArray[np.float64]

_DIGIT = 1e-6  # part of a step by which a printed value may miss it
_COARSEST = -2  # power of ten [m]: no device gives decimeters, but stations stand at them
_FEWEST = 3  # different readings: one or two have any step


def step_of_the_tape(readings: Column, reference: Column, step: float, by_chance: float) -> bool:
    """Whether differences of readings are multiples of a step only because those of the stations are.

    Readings that a device rounds to a step err by another part of this step at each station, unless the
    stations stand in this step, too. So where all errors lie within a small part of the step, and no two of
    them differ by a step, the tape explains the step as well.

    Parameters
    ----------
    readings, reference : ndarray, shape (n,)
        [m]; finite.
    step : float
        Of the differences of the readings [m].
    by_chance : float
        Probability of so little scatter where the stations do not stand in this step.
    """
    stations = len(np.unique(reference))
    part = float(np.ptp(readings - reference)) / step
    if part >= 1.0:
        return False
    return stations * part ** (stations - 1) < by_chance  # that so many points of a circle lie in such an arc


def printed_grid(readings: Column, reference: Column) -> QuantizationGrid | None:
    """Find the decimal step in which repeated readings are given: 1 cm, 1 mm or less.

    The values themselves are multiples of it, not only their differences. Only the repetitions at a distance
    are evidence of a step, for the values of any table have an end.
    """
    distinct = np.unique(readings)
    if len(distinct) == len(readings) or len(distinct) < _FEWEST:
        return None
    repeated = len(readings) - len(np.unique(reference + 1j * readings))
    for power in range(_COARSEST, int(np.floor(np.log10(FINEST_STEP))), -1):
        step = 10.0**power
        if repeated and np.abs(distinct / step - np.round(distinct / step)).max() < _DIGIT:
            return QuantizationGrid(step, len(distinct), len(readings), repeated)
    return None
