"""An oracle's gas: molecules whose vibrations are Einstein oscillators, nothing from the core."""

import numpy as np
from numpy.typing import NDArray

from hidden_effects.air import saturation_pressure

Column = NDArray[np.float64]
Value = Column | float

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


def _heat(molecule: str, kelvin: Value) -> Value:
    """Isobaric heat capacity over R of an ideal gas."""
    total: Value = _RIGID[molecule] + 0.0 * kelvin
    for mode in _MODES[molecule]:
        x = mode / kelvin
        total = total + x**2 * np.exp(-x) / (1 - np.exp(-x)) ** 2
    return total


def speed(temperature: Value, humidity: Value = 0.0, pressure: Value = 101325.0, co2: Value = 4e-4) -> Value:
    """Speed of sound of moist air [m/s] at [degC], relative humidity 0..1, [Pa], mole fraction."""
    kelvin = temperature + _KELVIN
    water = humidity * saturation_pressure(np.asarray(temperature, dtype=float)) / pressure
    dry = 1 - water
    parts = {"N2": _NITROGEN * (1 - co2) * dry, "O2": _OXYGEN * (1 - co2) * dry}
    parts |= {"Ar": _ARGON * (1 - co2) * dry, "CO2": co2 * dry, "H2O": water}
    whole = sum(parts.values())
    mass = sum(x * _MASS[m] for m, x in parts.items()) / whole
    heat = sum(x * _heat(m, kelvin) for m, x in parts.items()) / whole
    return np.asarray(np.sqrt(heat / (heat - 1) * _R * kelvin / mass))


def attenuation(temperature: Value, humidity: Value, frequency: float = 40e3) -> Value:
    """Amplitude lost per meter [dB/m] at 101.325 kPa: ISO 9613-1:1993 eq. (3)-(5), typed anew."""
    kelvin = temperature + _KELVIN
    ratio = kelvin / 293.15
    water = 100 * humidity * saturation_pressure(np.asarray(temperature, dtype=float)) / 101325.0
    oxygen = 24 + 4.04e4 * water * (0.02 + water) / (0.391 + water)
    nitrogen = ratio**-0.5 * (9 + 280 * water * np.exp(-4.170 * (ratio ** (-1 / 3) - 1)))
    relaxing = 0.01275 * np.exp(-2239.1 / kelvin) / (oxygen + frequency**2 / oxygen)
    relaxing = relaxing + 0.1068 * np.exp(-3352.0 / kelvin) / (nitrogen + frequency**2 / nitrogen)
    return np.asarray(8.686 * frequency**2 * (1.84e-11 * ratio**0.5 + ratio**-2.5 * relaxing))
