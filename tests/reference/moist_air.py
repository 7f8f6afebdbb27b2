"""Independent oracles for the speed of sound in moist air (test-only dependencies).

Two formulations that share no code with echocal:

* ``hapropssi``: CoolProp's humid air, ASHRAE RP-1485 (Herrmann, Kretzschmar and Gatley 2009,
  doi:10.1080/10789669.2009.10390874).
* ``iapws``: IAPWS G8-10, humid air as a Helmholtz mixture of Lemmon et al. 2000 dry air
  (doi:10.1063/1.1285884) and IAPWS-95 steam (doi:10.1063/1.1461829), by the package ``iapws``.

Both are compared at equal *water mole fraction*: below 0.01 degC they define relative humidity over
ice, echocal and meteorology (WMO No. 8) over supercooled water.
"""

from __future__ import annotations

import numpy as np
from CoolProp import PT_INPUTS, AbstractState, iphase_gas
from CoolProp.CoolProp import PropsSI
from CoolProp.HumidAirProp import HAPropsSI
from iapws import IAPWS95
from iapws.humidAir import Air, HumidAir

ZERO_CELSIUS = 273.15  # [K]
AIR_MOLAR_MASS = Air.M  # [g/mol]
WATER_MOLAR_MASS = IAPWS95.M  # [g/mol]
GAS_CONSTANT_IAPWS = 8.314472  # [J/(mol K)], IAPWS G8-10
_humid_air = HumidAir()


def water_vapor_mole_fraction(temperature: float, relative_humidity: float, pressure: float) -> float:
    """CIPM-81/91 [1]: Davis 1992 (doi:10.1088/0026-1394/29/1/008), equations A1.1 and A1.2."""
    kelvin = temperature + ZERO_CELSIUS
    saturation = np.exp(1.2378847e-5 * kelvin**2 - 1.9121316e-2 * kelvin + 33.93711047 - 6343.1645 / kelvin)
    enhancement = 1.00062 + 3.14e-8 * pressure + 5.6e-7 * temperature**2
    return float(relative_humidity * enhancement * saturation / pressure)


def hapropssi(temperature: float, water: float, pressure: float) -> float:
    """Speed of sound of CoolProp's humid air [m/s]; exactly dry air is refused there, hence 1e-12."""
    return float(
        HAPropsSI(
            "speed_of_sound",
            "T",
            temperature + ZERO_CELSIUS,
            "P",
            pressure,
            "psi_w",
            max(water, 1e-12),
        )
    )


def iapws(temperature: float, water: float, pressure: float) -> float:
    """Speed of sound of IAPWS G8-10 humid air [m/s].

    The package's own constructor also solves for saturation, which is slow and over ice; the density
    is therefore solved here (Newton on its Helmholtz energy) and its property function asked.
    """
    kelvin = temperature + ZERO_CELSIUS
    air = 1.0 - water
    air_mass_fraction = air / (1.0 - (1.0 - air) * (1.0 - WATER_MOLAR_MASS / AIR_MOLAR_MASS))
    molar_mass = 1e-3 * (water * WATER_MOLAR_MASS + air * AIR_MOLAR_MASS)
    density = pressure * molar_mass / (GAS_CONSTANT_IAPWS * kelvin)
    for _ in range(5):
        energy = _humid_air._fav(kelvin, density, air_mass_fraction)
        slope = 2.0 * density * energy["fird"] + density**2 * energy["firdd"]
        density -= (density**2 * energy["fird"] - 1e-3 * pressure) / slope
    energy = _humid_air._fav(kelvin, density, air_mass_fraction)
    return float(_humid_air._prop(kelvin, density, energy)["w"])


def dry_air(temperature: float, pressure: float) -> float:
    """Speed of sound of dry air [m/s], Lemmon et al. 2000, by CoolProp."""
    return float(PropsSI("A", "T", temperature + ZERO_CELSIUS, "P", pressure, "Air"))


def hapropssi_at_humidity(temperature: float, relative_humidity: float, pressure: float) -> float:
    """As `hapropssi`, at CoolProp's own water for a relative humidity (over ice below 0.01 degC)."""
    kelvin = temperature + ZERO_CELSIUS
    return float(HAPropsSI("speed_of_sound", "T", kelvin, "P", pressure, "R", relative_humidity))


def gerg(temperature: float, pressure: float, carbon_dioxide: float) -> float:
    """Speed of sound of dry air with CO2 in the place of oxygen [m/s], GERG-2008 by CoolProp."""
    oxygen, argon = 0.20979 - carbon_dioxide, 0.00934
    state = AbstractState("HEOS", "Nitrogen&Oxygen&Argon&CarbonDioxide")
    state.set_mole_fractions([1.0 - oxygen - argon - carbon_dioxide, oxygen, argon, carbon_dioxide])
    state.specify_phase(iphase_gas)
    state.update(PT_INPUTS, pressure, temperature + ZERO_CELSIUS)
    return float(state.speed_sound())
