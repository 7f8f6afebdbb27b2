"""Logs of a fleet for the tests: sensors with a fixed delay and sensors without, at five distances."""

from collections.abc import Sequence

import numpy as np
import polars as pl

import echocal

START = np.datetime64("2025-03-01T00:00", "ms")
DELAY = 40e-6  # s


def log(random: np.random.Generator, delay: float = 0.0, rows: int = 120) -> pl.DataFrame:
    """Log of one sensor, without its key."""
    celsius = 15.0 + 8.0 * np.sin(np.arange(rows) * 2 * np.pi / 48) + random.normal(0.0, 0.5, rows)
    distance = np.resize([0.4, 0.8, 1.5, 2.5, 3.5], rows)
    echo = 2 * distance / echocal.speed_of_sound(celsius, 0.5) + delay + random.normal(0.0, 6e-6, rows)
    return pl.DataFrame(
        {
            "time": START + (np.arange(rows) * 600_000).astype("timedelta64[ms]"),
            "echo_us": 1e6 * echo,
            "temperature_C": celsius,
            "distance_m": distance,
            "relative_humidity": np.full(rows, 0.5),
        }
    )


def fleet(random: np.random.Generator, delays: Sequence[float], rows: int = 120) -> pl.DataFrame:
    """Logs of several sensors, in the order of time, with the keys 1, 2, ..."""
    logs = [
        log(random, delay, rows).with_columns(pl.lit(n, pl.Int64).alias("sensor_id"))
        for n, delay in enumerate(delays, start=1)
    ]
    return pl.concat(logs).sort("time", "sensor_id")
