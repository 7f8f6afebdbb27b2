"""An oracle's thermometer: a body with heat capacity, in air, in the sun, on a warm board."""

import numpy as np
from numpy.typing import NDArray

Column = NDArray[np.float64]


def lagging(air: Column, seconds: Column, time_constant: float) -> Column:
    """Temperature of a body that follows the air with one time constant, the air linear between rows.

    Exact response of dB/dt = (A - B)/tau to a ramp; in balance at the first row.
    """
    body = np.empty_like(air)
    body[0] = air[0]
    for i in range(1, len(air)):
        step = seconds[i] - seconds[i - 1]
        decay = np.exp(-step / time_constant)
        ramp = (air[i] - air[i - 1]) / step
        start = body[i - 1] - air[i - 1] + ramp * time_constant
        body[i] = air[i] - ramp * time_constant + start * decay
    return body


def warming(seconds: Column, rise: float, time_constant: float) -> Column:
    """Rise [K] of a board that was switched on at the first row."""
    return rise * (1 - np.exp(-(seconds - seconds[0]) / time_constant))


def in_the_sun(radiation: Column, seconds: Column, kelvin: float, time_constant: float) -> Column:
    """Error [K] of a housing that warms by `kelvin` at 1000 W/m2, with its own inertia."""
    return lagging(kelvin * radiation / 1000.0, seconds, time_constant)
