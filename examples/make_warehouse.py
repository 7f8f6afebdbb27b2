"""Make warehouse.csv: an HC-SR04 in a warehouse, simulated as a waveform.

Nothing here comes from echocal, so that echocal has to find what is in the data: the speed of
sound is that of a mixture of ideal gases, the echo is a burst through two resonators that a
comparator sees in noise, and the microcontroller counts 4 us ticks.

    python examples/make_warehouse.py > examples/warehouse.csv
"""

import sys

import numpy as np
from numpy.typing import NDArray

Column = NDArray[np.float64]

ROWS, STEP = 480, 1800.0  # ten days, a row every half hour
STANDS = np.array([0.500, 1.200, 2.500])  # distances of the target [m], set in turn for eight hours
FREQUENCY, SAMPLING = 40e3, 2e6  # [Hz]
QUALITY = 18.0  # of each transducer, from about 2.2 kHz between the points at -3 dB
# of the largest amplitude; the amplifier's gain grows with time and makes up for spreading and absorption
THRESHOLD, NOISE = 0.15, 0.004
ELECTRONICS = 12e-6  # trigger to burst [s]
TICK = 4e-6  # [s]


def speed_of_sound(temperature: Column, relative_humidity: Column, pressure: Column) -> Column:
    """Speed of sound in moist air [m/s]: sqrt(gamma R T / M) of a mixture of ideal gases.

    Saturation pressure after Alduchov and Eskridge 1996, doi:10.1175/1520-0450(1996)035<0601:IMFAOS>2.0.CO;2,
    eq. 21; molar masses and heat capacities at 300 K from the CRC Handbook of Chemistry and Physics.
    """
    saturation = 610.94 * np.exp(17.625 * temperature / (243.04 + temperature))
    water = relative_humidity * saturation / pressure
    shares = {"N2": 0.7808, "O2": 0.2095, "Ar": 0.0093, "CO2": 0.0004}
    mass = {"N2": 28.0134e-3, "O2": 31.9988e-3, "Ar": 39.948e-3, "CO2": 44.0095e-3}
    heat = {"N2": 29.12, "O2": 29.39, "Ar": 20.79, "CO2": 37.22}
    dry_mass = sum(shares[gas] * mass[gas] for gas in shares)
    dry_heat = sum(shares[gas] * heat[gas] for gas in shares)
    molar_mass = dry_mass + water * (18.0153e-3 - dry_mass)
    heat_capacity = dry_heat + water * (33.60 - dry_heat)
    gamma = heat_capacity / (heat_capacity - 8.314462618)
    return np.asarray(np.sqrt(gamma * 8.314462618 * (temperature + 273.15) / molar_mass))


def template() -> Column:
    """Received echo of eight cycles through two resonant transducers, largest amplitude 1."""
    time = np.arange(0.0, 1.2e-3, 1.0 / SAMPLING)
    burst = np.sign(np.sin(2 * np.pi * FREQUENCY * time)) * (time < 8 / FREQUENCY)
    ringing = np.exp(-np.pi * FREQUENCY * time / QUALITY) * np.sin(2 * np.pi * FREQUENCY * time)
    once = np.convolve(burst, ringing)[: time.size]
    twice = np.convolve(once, ringing)[: time.size]
    return np.asarray(twice / np.abs(twice).max())


def echo_times(distance: Column, speed: Column, chance: np.random.Generator) -> Column:
    """Echo times [s] that the microcontroller counts, one burst for each row."""
    shape = template()
    times = np.empty_like(distance)
    for row, (path, c) in enumerate(zip(2 * distance, speed, strict=True)):
        received = shape + NOISE * chance.standard_normal(shape.size)
        crossing = np.argmax(received > THRESHOLD) / SAMPLING
        ticks = (path / c + crossing + ELECTRONICS) / TICK + chance.random()
        times[row] = np.floor(ticks) * TICK
    return times


def main() -> None:
    """Write the table to stdout."""
    chance = np.random.default_rng(0)
    elapsed = STEP * np.arange(ROWS)
    day = 2 * np.pi * elapsed / 86400.0
    weather = 4.0 * np.sin(day / 7.3) + np.cumsum(0.08 * chance.standard_normal(ROWS))
    temperature = 21.0 - 7.0 * np.cos(day - 0.6) + weather
    relative_humidity = np.clip(0.62 + 0.2 * np.cos(day - 0.3) + 0.12 * np.sin(day / 4.1), 0.2, 0.97)
    pressure = 101100.0 + 900.0 * np.sin(day / 5.7)
    stand = (np.arange(ROWS) // 16) % STANDS.size
    distance = STANDS[stand]
    echo = echo_times(distance, speed_of_sound(temperature, relative_humidity, pressure), chance)
    start = np.datetime64("2024-06-03T00:00:00")
    out = sys.stdout
    out.write(
        "# Simulated as a waveform by make_warehouse.py beside this file; no part of echocal was used\n"
    )
    out.write("time,stand,distance_m,temperature_C,humidity_percent,pressure_hPa,echo_us\n")
    for row in range(ROWS):
        time = start + np.timedelta64(int(elapsed[row]), "s")
        air = f"{temperature[row]:.1f},{100 * relative_humidity[row]:.1f},{pressure[row] / 100:.1f}"
        out.write(f"{time}Z,{stand[row] + 1},{distance[row]:.3f},{air},{echo[row] * 1e6:.0f}\n")


if __name__ == "__main__":
    main()
