"""Rows that went wrong, and columns that are not what they say."""

import numpy as np

from hidden_effects.causes.registry import cause
from hidden_effects.log import Log

Random = np.random.Generator


def some(log: Log, random: Random, least: float = 0.01, most: float = 0.06) -> np.ndarray:
    """A few rows, two at least."""
    count = max(2, int(len(log.rows) * random.uniform(least, most)))
    return random.choice(len(log.rows), count, replace=False)


@cause("row", size="fixed")
def mistyped_rows(log: Log, _: float, random: Random) -> None:
    """Two neighboring digits of the millimeters change places."""
    for row in some(log, random):
        digits = list(f"{round(log.reading[row] * 1e3):04d}")
        at = int(random.integers(0, 3))
        digits[at], digits[at + 1] = digits[at + 1], digits[at]
        log.reading[row] = int("".join(digits)) / 1e3


@cause("row", size="fixed", needs="distances")
def shifted_rows(log: Log, _: float, random: Random) -> None:
    """A copied line: from some row on readings stand one line too low."""
    start = int(random.uniform(0.2, 0.8) * len(log.rows))
    late = int(random.integers(1, 4))
    log.reading[start + late :] = log.reading[start:-late].copy()


@cause("row", size="fixed")
def stuck_reading(log: Log, _: float, random: Random) -> None:
    start = int(random.uniform(0.1, 0.7) * len(log.rows))
    log.reading[start : start + max(4, len(log.rows) // 8)] = log.reading[start]


@cause("row", size="fixed")
def timeout(log: Log, _: float, random: Random) -> None:
    rows = some(log, random)
    log.reading[rows] = log.speed[rows] * 38e-3 / 2


@cause("row", size="fixed", needs="distances")
def blanking_distance(log: Log, _: float, random: Random) -> None:
    near = log.rows.distance <= np.quantile(log.rows.distance, 0.06)
    log.reading[near] = random.uniform(0.5, 1.5) + random.normal(0, 0.02, near.sum())


@cause("row", size="fixed")
def crosstalk(log: Log, _: float, random: Random) -> None:
    rows = some(log, random)
    log.reading[rows] = log.reading[rows] * random.uniform(0.1, 0.9, len(rows))


@cause("row", size="fixed")
def multipath(log: Log, _: float, random: Random) -> None:
    rows = some(log, random)
    twice = random.random(len(rows)) < 0.4
    log.reading[rows] = log.reading[rows] * np.where(twice, 2.0, random.uniform(1.02, 1.4, len(rows)))


@cause("row", size="fixed", needs="distances")
def censored_range(log: Log, _: float, random: Random) -> None:
    log.reading = np.minimum(log.reading, np.quantile(log.reading, random.uniform(0.8, 0.95)))


@cause("row", size="fixed", needs="humidity")
def swapped_columns(log: Log, _: float, random: Random) -> None:
    rows = slice(int(random.uniform(0.3, 0.9) * len(log.rows)), None)
    humidity = log.rows.humidity * 100
    log.temperature, log.humidity = log.temperature.copy(), humidity.copy()
    log.humidity[rows] = log.temperature[rows]
    log.temperature[rows] = humidity[rows]


@cause("gross", size="fixed")
def fahrenheit_celsius(log: Log, _: float, random: Random) -> None:
    rows = slice(None) if random.random() < 0.5 else some(log, random)
    log.temperature = log.temperature.copy()
    log.temperature[rows] = 32 + 1.8 * log.temperature[rows]


@cause("gross", size="fixed")
def round_trip_factor(log: Log, _: float, __: Random) -> None:
    log.reading = 2 * log.reading


@cause("gross", size="fixed")
def unit_mixup(log: Log, _: float, random: Random) -> None:
    log.reading = log.reading * random.choice([2.54, 1 / 2.54, 10.0, 0.1, 100.0])
