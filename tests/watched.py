"""Logs of a sensor for the tests of the watch, from their own arithmetic."""

from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.signal import lfilter

Column = NDArray[np.float64]

WAIT = 600.0
START = np.datetime64("2026-01-01T00:00:00")


def noise(random: np.random.Generator, rows: int, rho: float = 0.0, theta: float = 0.0) -> Column:
    """White noise, an autoregression or one beneath white noise, with innovations of 1 mm."""
    white = random.standard_normal(rows + 300)
    return 1e-3 * np.asarray(lfilter([1.0, -theta], [1.0, -rho], white))[300:]


def temperatures(random: np.random.Generator, rows: int) -> Column:
    hours = np.arange(rows) * WAIT / 3600.0
    slow = lfilter([0.03], [1.0, -0.999], random.standard_normal(rows))
    return np.asarray(15.0 + 6.0 * np.sin(2.0 * np.pi * hours / 24.0) + 3.0 * slow)


def log(random: np.random.Generator, rows: int, *, error: Column | float = 0.0) -> list[dict[str, Any]]:
    """Rows of a sensor that follows the linear law, at random distances, with an error [m]."""
    temperature = temperatures(random, rows)
    distance = random.uniform(0.5, 3.0, rows)
    reading = distance + noise(random, rows) + error
    echo = 2e6 * reading / (331.4 + 0.6 * temperature)
    times = START + np.arange(rows) * np.timedelta64(int(WAIT), "s")
    return [
        {
            "time": str(t),
            "echo_us": repr(float(e)),
            "temperature_C": repr(float(c)),
            "distance_m": repr(float(d)),
        }
        for t, e, c, d in zip(times, echo, temperature, distance, strict=True)
    ]


def csv(rows: list[dict[str, Any]]) -> str:
    return "\n".join([",".join(rows[0]), *(",".join(map(str, row.values())) for row in rows)]) + "\n"
