"""Speed of sound of the bench: ideal gases whose molecules vibrate as Einstein oscillators."""

import numpy as np
from numpy.typing import ArrayLike, NDArray

__all__ = ["speed_of_sound"]

_R = 8.314462618  # J/(mol K), CODATA 2018
_KELVIN = 273.15
_NITROGEN, _OXYGEN, _ARGON = 0.78084, 0.20946, 0.00934  # mole fractions of dry air, US Std. Atm. 1976
_MASS = {"N2": 28.0134e-3, "O2": 31.9988e-3, "Ar": 39.948e-3, "CO2": 44.0095e-3, "H2O": 18.0153e-3}
_RIGID = {"N2": 3.5, "O2": 3.5, "Ar": 2.5, "CO2": 3.5, "H2O": 4.0}  # heat capacity over R, no vibration
_MODES = {  # vibrational temperatures [K], Herzberg's wavenumbers times hc/k
    "N2": (3374.0,),
    "O2": (2256.0,),
    "Ar": (),
    "CO2": (960.0, 960.0, 1930.0, 3380.0),
    "H2O": (2294.0, 5261.0, 5403.0),
}

Column = NDArray[np.float64]


def speed_of_sound(
    temperature: ArrayLike,
    relative_humidity: ArrayLike = 0.0,
    pressure: ArrayLike = 101325.0,
    co2_mole_fraction: ArrayLike = 4e-4,
    frequency: float = 0.0,
) -> Column:
    """Speed of sound of moist air.

    Parameters
    ----------
    temperature : array_like
        Air temperature [degC].
    relative_humidity : array_like
        Relative humidity [1].
    pressure : array_like
        Pressure [Pa].
    co2_mole_fraction : array_like
        Mole fraction of carbon dioxide [1].
    frequency : float
        Frequency [Hz]; not used here.

    Returns
    -------
    ndarray
        Speed of sound [m/s], in the common shape.

    Examples
    --------
    >>> round(float(speed_of_sound(20.0)), 1)
    343.3
    """
    warm = np.asarray(temperature, dtype=np.float64)
    co2 = np.asarray(co2_mole_fraction, dtype=np.float64)
    kelvin = warm + _KELVIN
    water = np.asarray(relative_humidity) * _saturation_pressure(warm) / np.asarray(pressure)
    dry = 1.0 - water
    parts = {"N2": _NITROGEN * (1 - co2) * dry, "O2": _OXYGEN * (1 - co2) * dry}
    parts |= {"Ar": _ARGON * (1 - co2) * dry, "CO2": co2 * dry, "H2O": water}
    whole = sum(parts.values())
    mass = sum(share * _MASS[molecule] for molecule, share in parts.items()) / whole
    heat = sum(share * _heat(molecule, kelvin) for molecule, share in parts.items()) / whole
    return np.asarray(np.sqrt(heat / (heat - 1.0) * _R * kelvin / mass))


def _saturation_pressure(temperature: Column) -> Column:
    """Buck 1981, J. Appl. Meteorol. 20, 1527, eq. (8), fw4: [Pa] at degC."""
    return np.asarray(611.21 * np.exp((18.678 - temperature / 234.5) * temperature / (257.14 + temperature)))


def _heat(molecule: str, kelvin: Column) -> Column:
    """Isobaric heat capacity over R of an ideal gas."""
    total = _RIGID[molecule] + 0.0 * kelvin
    for mode in _MODES[molecule]:
        x = mode / kelvin
        total = total + x**2 * np.exp(-x) / (1 - np.exp(-x)) ** 2
    return np.asarray(total)
