"""Where tables are measured: a study's sweep, a bench, a field log, and conditions never seen."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.signal import lfilter

Column = NDArray[np.float64]
DAY = 86400.0


@dataclass(frozen=True)
class Rows:
    """True conditions of every row, in SI units and degC."""

    design: str
    distance: Column
    temperature: Column
    humidity: Column
    seconds: Column
    stand: NDArray[np.int64]
    pressure: Column
    supply: Column
    wind: Column
    radiation: Column
    angle: Column

    def __len__(self) -> int:
        return len(self.distance)

    @property
    def offers(self) -> frozenset[str]:
        """What a cause may need of a design."""
        timed = {"time", "humidity"} if self.design != "a" else set()
        stands = {"stands", "distances"} if self.design == "b" else set()
        field = {"distances", "weather", "days"} if self.design == "c" else set()
        return frozenset(timed | stands | field)


def remembering(n: int, keep: float, random: np.random.Generator) -> Column:
    """Autoregression of first order with unit variance, stationary from the first row."""
    shocks = random.normal(size=n)
    shocks[1:] *= np.sqrt(1 - keep**2)
    return np.asarray(lfilter([1.0], [1.0, -keep], shocks))


def _surroundings(n: int, hours: Column, random: np.random.Generator) -> dict[str, Column]:
    """Quantities that a log may hold beside temperature and humidity; each walks slowly."""

    def walk(center: float, sd: float, memory: float) -> Column:
        return center + sd * remembering(n, np.exp(-1 / (memory * n)), random)

    sun = np.maximum(0.0, np.sin(2 * np.pi * (hours - 6) / 24))
    return {
        "pressure": walk(random.uniform(96e3, 102e3), 900.0, 0.1),
        "supply": np.clip(walk(5.0, 0.15, 0.2) - random.uniform(0, 0.2) * np.linspace(0, 1, n), 4.2, 5.5),
        "wind": np.abs(walk(0.0, random.uniform(1.5, 4.0), 0.005)),
        "radiation": 900.0 * sun * np.clip(walk(0.7, 0.25, 0.02), 0.05, 1.0),
        "angle": np.abs(walk(0.0, np.radians(4.0), 0.05)),
    }


def study(random: np.random.Generator) -> Rows:
    """Design a: one distance near 2 m, 0 to 50 degC, 26 rows, nothing else recorded."""
    n = 26
    more = _surroundings(n, np.full(n, 12.0), random)
    distance = np.full(n, round(random.uniform(1.8, 2.2), 2))
    zeros = np.zeros(n, dtype=np.int64)
    wet = np.full(n, random.uniform(0.2, 0.8))
    return Rows("a", distance, np.linspace(0.0, 50.0, n), wet, np.arange(n) * 600.0, zeros, **more)


def bench(random: np.random.Generator) -> Rows:
    """Design b: five distances, at each the temperature swept up and down; 400 rows, timed."""
    stands, each = 5, 80
    n = stands * each
    distances = np.round(np.sort(random.uniform(0.3, 3.9, stands)), 3)
    up = np.linspace(0.0, 1.0, each // 2) ** random.uniform(0.8, 1.25)
    low, high = random.uniform(0, 8), random.uniform(36, 50)
    sweep = np.tile(low + (high - low) * np.concatenate([up, up[::-1]]), stands)
    seconds = np.arange(n) * random.uniform(10.0, 40.0)
    wave = np.sin(np.linspace(0, random.uniform(8, 25), n) + random.uniform(0, 6))
    wet = np.clip(0.5 + 0.3 * wave + random.normal(0, 0.04, n), 0.05, 0.95)
    stand = np.repeat(np.arange(stands), each)
    more = _surroundings(n, np.full(n, 12.0), random)
    return Rows(
        "b", np.repeat(distances, each), sweep + random.normal(0, 0.1, n), wet, seconds, stand, **more
    )


def field(random: np.random.Generator, n: int = 5000) -> Rows:
    """Design c: a log of weeks, diurnal temperature with weather, a new distance in every row."""
    step = random.uniform(200.0, 900.0)
    seconds = np.arange(n) * step
    hours = seconds / 3600.0 % 24
    weather = remembering(n, np.exp(-step / (1.5 * DAY)), random)
    swing = random.uniform(4, 10) * np.sin(2 * np.pi * (hours - 9) / 24)
    temperature = random.uniform(8, 22) + swing + random.uniform(2, 5) * weather
    wet = 0.6 - 0.02 * swing - 0.08 * weather + random.normal(0, 0.06, n)
    more = _surroundings(n, hours, random)
    distance = random.uniform(0.3, 4.0, n)
    zeros = np.zeros(n, dtype=np.int64)
    return Rows("c", distance, temperature, np.clip(wet, 0.05, 1.0), seconds, zeros, **more)


def elsewhere(random: np.random.Generator) -> Rows:
    """Conditions that no design saw: other distances at other temperatures, 400 rows of days."""
    rows = field(random, 400)
    colder = np.clip(rows.temperature + random.uniform(-15, 15), -10, 45)
    return Rows(**{**rows.__dict__, "temperature": colder})


DESIGNS = {"a": study, "b": bench, "c": field}
