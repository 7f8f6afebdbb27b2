"""Eight effects outside the catalogue: what must be called unknown, not by a name."""

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from hidden_effects.designs import DAY, Rows

Column = NDArray[np.float64]
Shape = np.random.Generator


def bump_in_temperature(rows: Rows, random: Shape) -> Column:
    low, high = np.quantile(rows.temperature, [0.3, 0.7])
    center, width = random.uniform(low, high), random.uniform(0.1, 0.2) * np.ptp(rows.temperature)
    return np.exp(-0.5 * ((rows.temperature - center) / width) ** 2)


def kink_in_temperature(rows: Rows, random: Shape) -> Column:
    low, high = np.quantile(rows.temperature, [0.4, 0.7])
    return np.maximum(rows.temperature - random.uniform(low, high), 0.0)


def ripple_in_temperature(rows: Rows, random: Shape) -> Column:
    turns = random.uniform(1.5, 2.5) / np.ptp(rows.temperature)
    return np.sin(2 * np.pi * turns * rows.temperature + random.uniform(0, 6))


def standing_wave(rows: Rows, random: Shape) -> Column:
    return np.sin(2 * np.pi * rows.distance / random.uniform(0.9, 2.0) + random.uniform(0, 6))


def resonant_distance(rows: Rows, random: Shape) -> Column:
    return 1 / (1 + ((rows.distance - random.uniform(1.0, 3.0)) / 0.4) ** 2)


def slow_breathing(rows: Rows, random: Shape) -> Column:
    """A period of the building, unlike the day's."""
    turns = random.uniform(1.3, 2.7)
    return np.sin(2 * np.pi * turns * np.linspace(0, 1, len(rows)) + random.uniform(0, 6))


def humid_threshold(rows: Rows, random: Shape) -> Column:
    """Dew on the membrane above some humidity."""
    dew = np.quantile(rows.humidity, random.uniform(0.4, 0.7))
    return 1 / (1 + np.exp(-(rows.humidity - dew) / 0.03))


def second_daily_wave(rows: Rows, random: Shape) -> Column:
    return np.sin(4 * np.pi * rows.seconds / DAY + random.uniform(0, 6))


UNKNOWN: dict[str, tuple[Callable[[Rows, Shape], Column], str]] = {
    "bump_in_temperature": (bump_in_temperature, "abc"),
    "kink_in_temperature": (kink_in_temperature, "abc"),
    "ripple_in_temperature": (ripple_in_temperature, "abc"),
    "standing_wave": (standing_wave, "c"),
    "resonant_distance": (resonant_distance, "c"),
    "slow_breathing": (slow_breathing, "bc"),
    "humid_threshold": (humid_threshold, "bc"),
    "second_daily_wave": (second_daily_wave, "c"),
}
"""Shape of each kind, of any scale, and the designs that can show it."""
