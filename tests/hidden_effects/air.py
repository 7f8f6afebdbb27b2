"""An oracle's air: ideal-gas moist air with the vapor's own heat capacity, nothing from the core."""

import numpy as np
from numpy.typing import NDArray

Column = NDArray[np.float64]

_GAS = 8.314462618  # J/(mol K), CODATA 2018
_DRY, _WATER = 28.9655e-3, 18.01528e-3  # kg/mol
_HEAT_DRY, _HEAT_WATER = 3.5045, 4.043  # molar heat capacity over the gas constant, near 25 degC


def saturation_pressure(temperature: Column) -> Column:
    """Buck 1981, J. Appl. Meteorol. 20, 1527, eq. (8), fw4: [Pa] at degC."""
    return 611.21 * np.exp((18.678 - temperature / 234.5) * temperature / (257.14 + temperature))


def speed_of_sound(temperature: Column, humidity: Column | float = 0.0, pressure: float = 101325.0) -> Column:
    """Ideal gas of dry air and vapor [m/s]."""
    water = humidity * saturation_pressure(temperature) / pressure
    mass = (1 - water) * _DRY + water * _WATER
    heat = (1 - water) * _HEAT_DRY + water * _HEAT_WATER
    return np.sqrt(heat / (heat - 1) * _GAS * (temperature + 273.15) / mass)
