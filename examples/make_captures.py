"""Make captures.parquet: what the receiver of an HC-SR04 puts out, sampled by a microcontroller.

Speed of sound and echo are those of make_warehouse.py; nothing comes from echocal. A converter of 10 bits
takes 200,000 samples a second behind an amplifier that inverts. Three distances, from 5 to 35 degC, and
turbulent air. The microcontroller begins to sample 58 us before the burst: a fixed delay that is to be found.

    python examples/make_captures.py examples/captures.parquet
"""

import sys

import numpy as np
import pyarrow as pa
import pyarrow.parquet
from make_warehouse import SAMPLING, Column, speed_of_sound, template

DISTANCES = (0.500, 1.000, 1.500)  # [m]
COLDEST, WARMEST, ROWS = 5.0, 35.0, 60  # [degC]
HUMIDITY = 0.5
TURBULENCE, THERMOMETER = 2e-4, 0.1  # scatter of the speed of sound [1], of the thermometer [K]
RATE, COUNT = 200e3, 2100  # samples per second [Hz], samples of a capture
EARLY = 58e-6  # [s]
MIDDLE, STRENGTH, NOISE = 640, 120.0, 1.5  # codes; strength of the echo at 0.5 m


def received(time: Column) -> Column:
    """The echo at times [s] after it began."""
    shape = template()
    return np.interp(time, np.arange(shape.size) / SAMPLING, shape, left=0.0, right=0.0)


def capture(distance: float, temperature: float, chance: np.random.Generator) -> Column:
    """Codes of one capture."""
    air = np.array([temperature]), np.array([HUMIDITY]), np.array([101325.0])
    speed = float(speed_of_sound(*air)[0]) * (1.0 + TURBULENCE * chance.standard_normal())
    arrival = EARLY + 2.0 * distance / speed
    signal = STRENGTH * 0.5 / distance * received(np.arange(COUNT) / RATE - arrival)
    return np.clip(np.round(MIDDLE - signal + NOISE * chance.standard_normal(COUNT)), 0, 1023)


def main() -> None:
    """Write the file that the command line names."""
    chance = np.random.default_rng(0)
    temperatures = np.linspace(COLDEST, WARMEST, ROWS)
    rows = [(DISTANCES[row % 3], float(t)) for row, t in enumerate(temperatures)]
    captures = [capture(d, t, chance).astype(np.int16) for d, t in rows]
    table = pa.table(
        {
            "distance_m": [d for d, _ in rows],
            "temperature_C": np.round(temperatures + THERMOMETER * chance.standard_normal(ROWS), 1),
            "humidity_percent": [100.0 * HUMIDITY] * len(rows),
            "waveform": pa.array(captures, pa.list_(pa.int16())),
        }
    )
    made = {
        "sample_rate_Hz": f"{RATE:.0f}",
        "made_by": "make_captures.py, simulated; no part of echocal was used",
    }
    pyarrow.parquet.write_table(table.replace_schema_metadata(made), sys.argv[1], compression="zstd")


if __name__ == "__main__":
    main()
