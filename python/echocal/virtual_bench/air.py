"""Air of the bench: a second set of laws, so that nothing is tested on the equations that it came from.

The molecules are rigid rotors whose vibrations are Einstein oscillators, and they attract each other a
little. The core has Cramer's polynomial in its place; of the speed the two share no constant but the gas
constant. Both take the absorption from ISO 9613-1, for no second law of it is known.
"""

import numpy as np
from numpy.typing import ArrayLike, NDArray

Column = NDArray[np.float64]

_R = 8.314462618  # J/(mol K), CODATA 2018
_KELVIN = 273.15
_REFERENCE_KELVIN = 293.15  # K, ISO 9613-1:1993, 4.2
_REFERENCE_PRESSURE = 101325.0  # Pa, ISO 9613-1:1993, 4.2
_DRY = {"N2": 0.78084, "O2": 0.20946, "Ar": 0.00934}  # mole fractions, US Standard Atmosphere 1976
_MASS = {"N2": 28.0134e-3, "O2": 31.9988e-3, "Ar": 39.948e-3, "CO2": 44.0095e-3, "H2O": 18.0153e-3}  # kg/mol
_RIGID = {"N2": 3.5, "O2": 3.5, "Ar": 2.5, "CO2": 3.5, "H2O": 4.0}  # isobaric heat over R without vibration
_CENTIMETER_KELVIN = 1.438776877  # cm K, hc/k, CODATA 2018
_WAVENUMBERS = {  # 1/cm, of the vibrations
    "N2": (2329.9,),  # Huber & Herzberg 1979, Constants of diatomic molecules: we - 2 wexe
    "O2": (1556.2,),
    "Ar": (),
    "CO2": (667.0, 667.0, 1333.0, 2349.0),  # Shimanouchi 1972, NSRDS-NBS 39
    "H2O": (1595.0, 3657.0, 3756.0),
}
_VIRIAL = {  # cm3/mol, cm3/mol, K: B = a - b exp(c / T), Kaye & Laby 1995, 16th ed., table 3.5
    "N2": (185.4, 141.8, 88.7),
    "O2": (152.8, 117.0, 108.8),
    "Ar": (154.2, 119.3, 105.1),
    "H2O": (33.0, 15.2, 1300.7),
}


def saturation_pressure(temperature: ArrayLike) -> Column:
    """Compute the vapor pressure over water [Pa] at a temperature [degC].

    Buck 1996, CR-1A User's Manual, appendix 1, without the enhancement factor (0.4 % of the vapor); the form
    is that of Buck 1981, doi:10.1175/1520-0450(1981)020<1527:NEFCVP>2.0.CO;2. Below 0 degC the humidity is
    over water, too.
    """
    celsius = np.asarray(temperature, dtype=float)
    return np.asarray(611.21 * np.exp((18.678 - celsius / 234.5) * celsius / (257.14 + celsius)))


def _heat(molecule: str, kelvin: Column) -> Column:
    """Isobaric heat capacity over R of an ideal gas of one molecule."""
    total = np.full_like(kelvin, _RIGID[molecule])
    for wavenumber in _WAVENUMBERS[molecule]:
        x = _CENTIMETER_KELVIN * wavenumber / kelvin
        total = total + x**2 * np.exp(-x) / (1 - np.exp(-x)) ** 2
    return total


def _water(temperature: ArrayLike, relative_humidity: ArrayLike, pressure: ArrayLike) -> Column:
    """Mole fraction of the water vapor."""
    vapor = np.asarray(relative_humidity) * saturation_pressure(temperature)
    return np.asarray(vapor / np.asarray(pressure, dtype=float))


def _attraction(kelvin: Column, ratio: Column, water: Column) -> Column:
    """The acoustic second virial coefficient [m3/mol], `ratio` that of the heats.

    Trusler 1991, Physical Acoustics and Metrology of Fluids, chapter 1. Pairs of unlike gases of the air
    count as the mean of the like ones; those of air and water, whose terms nearly cancel, are left out.
    """
    total = np.zeros_like(kelvin)
    for gas, (a, b, c) in _VIRIAL.items():
        first = b * np.exp(c / kelvin)  # B = a - first, and its derivatives times T and T^2
        slope, bend = first * c / kelvin, -first * c / kelvin * (c / kelvin + 2)
        pairs = water**2 if gas == "H2O" else _DRY[gas] * (1 - water) ** 2
        total = total + pairs * (2 * (a - first) + 2 * (ratio - 1) * slope + (ratio - 1) ** 2 / ratio * bend)
    return np.asarray(1e-6 * total)


def speed_of_sound(
    temperature: ArrayLike,
    relative_humidity: ArrayLike = 0.0,
    pressure: ArrayLike = 101325.0,
    co2_mole_fraction: ArrayLike = 4e-4,
    frequency: float = 0.0,
    *,
    group: bool = False,
) -> Column:
    """Compute the speed of sound of moist air as a mixture of nearly ideal gases.

    Parameters
    ----------
    temperature, relative_humidity, pressure, co2_mole_fraction : array_like
        Of the air [degC], [0..1], [Pa], [mol/mol]; broadcast together.
    frequency : float
        Of the sound [Hz]. Above 0 the vibrations of oxygen and nitrogen lag behind, which makes
        the sound faster (Morfey & Howell 1980, doi:10.1121/1.385080).
    group : bool
        Whether to tell the speed of an envelope instead of the one of a phase.

    Returns
    -------
    ndarray
        Speed [m/s].

    Examples
    --------
    >>> from echocal.virtual_bench import air
    >>> round(float(air.speed_of_sound(20.0, 0.5)), 1)
    344.0
    """
    kelvin = np.asarray(temperature, dtype=float) + _KELVIN
    water = _water(temperature, relative_humidity, pressure)
    co2, dry = np.asarray(co2_mole_fraction, dtype=float), 1 - water
    parts = {gas: part * (1 - co2) * dry for gas, part in _DRY.items()} | {"CO2": co2 * dry, "H2O": water}
    whole = np.asarray(sum(parts.values()))
    mass = np.asarray(sum(x * _MASS[m] for m, x in parts.items())) / whole
    heat = np.asarray(sum(x * _heat(m, kelvin) for m, x in parts.items())) / whole
    ratio, ideal = heat / (heat - 1), _R * kelvin / mass
    real = 1 + np.asarray(pressure, dtype=float) / (_R * kelvin) * _attraction(kelvin, ratio, water)
    slowness = 1 / np.sqrt(ratio * ideal * real)
    if frequency:
        for part, at in _relaxations(temperature, relative_humidity, pressure, frequency):
            # The slowness of a group is d(omega slowness) / d omega.
            steeper = 2 / (1 + (frequency / at) ** 2) if group else 0.0
            slowness = slowness - part / (2 * np.pi * at) * (1 + steeper)
    return np.asarray(1 / slowness)


def _relaxations(
    temperature: ArrayLike, relative_humidity: ArrayLike, pressure: ArrayLike, frequency: float
) -> list[tuple[Column, Column]]:
    """Absorption [Np/m] by oxygen and nitrogen, and their frequencies [Hz]: ISO 9613-1:1993, (3) to (5)."""
    kelvin = np.asarray(temperature, dtype=float) + _KELVIN
    ratio = kelvin / _REFERENCE_KELVIN
    bars = np.asarray(pressure, dtype=float) / _REFERENCE_PRESSURE
    water = 100 * _water(temperature, relative_humidity, pressure)
    oxygen = bars * (24 + 4.04e4 * water * (0.02 + water) / (0.391 + water))
    nitrogen = bars * ratio**-0.5 * (9 + 280 * water * np.exp(-4.170 * (ratio ** (-1 / 3) - 1)))
    common = frequency**2 * ratio**-2.5
    return [
        (common * strength * np.exp(-theta / kelvin) / (at + frequency**2 / at), at)
        for strength, theta, at in ((0.01275, 2239.1, oxygen), (0.1068, 3352.0, nitrogen))
    ]


def absorption(
    temperature: ArrayLike,
    relative_humidity: ArrayLike = 0.0,
    pressure: ArrayLike = 101325.0,
    frequency: float = 40e3,
) -> Column:
    """Compute the absorption of sound by air: ISO 9613-1:1993, eq. (5).

    Parameters
    ----------
    temperature, relative_humidity, pressure : array_like
        Of the air [degC], [0..1], [Pa]; broadcast together.
    frequency : float
        Of the sound [Hz].

    Returns
    -------
    ndarray
        Attenuation [dB/m].
    """
    ratio = (np.asarray(temperature, dtype=float) + _KELVIN) / _REFERENCE_KELVIN
    bars = np.asarray(pressure, dtype=float) / _REFERENCE_PRESSURE
    classical = 1.84e-11 * frequency**2 * ratio**0.5 / bars
    relaxing = _relaxations(temperature, relative_humidity, pressure, frequency)
    return np.asarray(8.686 * (classical + sum(part for part, _ in relaxing)))
