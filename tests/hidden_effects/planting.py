"""Plant one effect in a table, with noise that is richer than the engine's equations.

The base simulation of every table is the linear law, so what the air really does beside it is
kept out: nature here follows the linear law plus the planted effect (by finite changes of the
oracle's own chain), and the oracle's humid air only where humidity is what is planted.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from hidden_effects.air import speed_of_sound

Column = NDArray[np.float64]


@dataclass(frozen=True)
class Rows:
    """Where a table is measured."""

    distance: Column
    temperature: Column
    humidity: Column
    seconds: Column
    stand: NDArray[np.int64]


def bench(random: np.random.Generator) -> Rows:
    """Five distances, at each a sweep up and down in temperature, with drifting humidity; 400 rows."""
    distances = np.sort(random.uniform(0.3, 3.8, 5))
    up = np.linspace(0.0, 1.0, 40)
    sweep = np.concatenate([up, up[::-1]])
    low, high = random.uniform(2, 8), random.uniform(38, 48)
    n = 80 * len(distances)
    wet = 0.5 + 0.3 * np.sin(np.linspace(0, random.uniform(8, 20), n) + random.uniform(0, 6))
    return Rows(
        np.repeat(distances, 80),
        np.tile(low + (high - low) * sweep, len(distances)),
        np.clip(wet + random.normal(0, 0.05, n), 0.05, 0.95),
        np.arange(n) * 20.0,
        np.repeat(np.arange(len(distances)), 80),
    )


def _reading(rows: Rows, **changes: Column | float) -> Column:
    """The oracle's chain: true air, path, time, timer, firmware; one change at a time."""
    air = rows.temperature + changes.get("warmer", 0.0)
    speed = 331.4 + changes.get("faster", 0.0) + (0.6 + changes.get("steeper", 0.0)) * air
    speed = speed + changes.get("moist", 0.0)
    time = 2 * (rows.distance + changes.get("longer", 0.0)) / speed + changes.get("later", 0.0)
    time = time * (1 + changes.get("clock", 0.0))
    firmware = changes.get("fixed", 331.4 + 0.6 * rows.temperature)
    return firmware * time / 2


def _moist(rows: Rows, humidity: Column | float) -> Column:
    return speed_of_sound(rows.temperature, humidity) - speed_of_sound(rows.temperature)


EFFECTS: dict[str, Callable[[Rows, float], Column]] = {
    "fixed_delay": lambda r, x: _reading(r, later=x * 3e-5),
    "zero_error": lambda r, x: _reading(r, longer=x * 5e-3),
    "speed_intercept": lambda r, x: _reading(r, faster=x),
    "speed_slope": lambda r, x: _reading(r, steeper=0.02 * x),
    "temperature_offset": lambda r, x: _reading(r, warmer=x),
    "temperature_gain": lambda r, x: _reading(r, warmer=0.03 * x * r.temperature),
    "humidity": lambda r, _: _reading(r, moist=_moist(r, r.humidity)),
    "unrecorded_humidity": lambda r, x: _reading(r, moist=_moist(r, 0.2 + 0.7 * abs(np.tanh(x)))),
    "fixed_speed": lambda r, x: _reading(r, fixed=343.0 + 3.0 * x),
    "clock_error": lambda r, x: _reading(r, clock=3e-3 * x),
}
"""Reading [m] of every row for each effect, at a size in units of its usual magnitude."""


def tape(rows: Rows, random: np.random.Generator, size: float = 1e-3) -> Column:
    """Error of the reference distance, one per stand [m]."""
    return random.normal(0, size, rows.stand.max() + 1)[rows.stand]


def noise(rows: Rows, random: np.random.Generator, kind: str = "normal", sd: float = 1.5e-3) -> Column:
    """Noise of the readings [m]: ``normal``, ``heavy`` (Student t, 4 degrees) or ``memory`` (AR(1))."""
    n = len(rows.distance)
    if kind == "heavy":
        return sd / np.sqrt(2.0) * random.standard_t(4, n)
    shocks = random.normal(0, sd, n)
    if kind == "memory":
        rho = random.uniform(0.3, 0.9)
        for i in range(1, n):
            shocks[i] = rho * shocks[i - 1] + np.sqrt(1 - rho**2) * shocks[i]
    return shocks


def table(
    rows: Rows, reading: Column, *, humidity: bool = True, reference: Column | None = None
) -> pd.DataFrame:
    """The table that a user would have."""
    columns = {
        "time_s": rows.seconds,
        "distance_m": rows.distance if reference is None else reference,
        "temperature_C": rows.temperature,
        "reading_m": reading,
    }
    if humidity:
        columns["humidity_percent"] = 100 * rows.humidity
    return pd.DataFrame(columns)
