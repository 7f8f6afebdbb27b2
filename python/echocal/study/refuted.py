"""REFUTED formulas of the study, kept by name so that their error can be shown.

Neither is physics, and nothing outside the study module may use them: `echocal.Model` has laws
for humid air under any pressure.
"""

import numpy as np
from numpy.typing import ArrayLike, NDArray

__all__ = ["refuted_humidity", "refuted_pressure"]

HUMIDITY_COEFFICIENT = 0.00016
STANDARD_PRESSURE = 101325.0  # Pa


def refuted_humidity(dry_speed: ArrayLike, relative_humidity: ArrayLike) -> NDArray[np.float64]:
    """REFUTED: speed of sound [m/s] in humid air as section III.B of the study has it.

    Parameters
    ----------
    dry_speed : array_like
        Speed in dry air [m/s].
    relative_humidity : array_like
        "RH" of the study, which it means in percent in one sentence and as 0 to 1 in the next.
    """
    return np.asarray(dry_speed) * (1.0 + HUMIDITY_COEFFICIENT * np.asarray(relative_humidity))


def refuted_pressure(speed: ArrayLike, pressure: ArrayLike) -> NDArray[np.float64]:
    """REFUTED: speed of sound [m/s] "proportional to the square root of absolute pressure".

    Parameters
    ----------
    speed : array_like
        Speed at standard pressure [m/s].
    pressure : array_like
        Pressure [Pa].
    """
    return np.asarray(speed) * np.sqrt(np.asarray(pressure) / STANDARD_PRESSURE)
