"""The study's sensor in any air: 2 m, converted with 343 m/s, by the core's own laws."""

import numpy as np
from numpy.typing import ArrayLike, NDArray

from echocal.model import Model
from echocal.study.tables import DISTANCE, READING_SPEED

__all__ = ["REFERENCE_LAW", "STATED_LAW", "error", "reading", "reading_in", "speed", "time"]

Array = NDArray[np.float64]

STATED_LAW = "331.4+0.6*T"
"""The study's equation."""

REFERENCE_LAW = "virial"
"""The law for true air: the one that holds over 0..50 degC at every humidity."""


def speed(law: str, temperature: ArrayLike, **air: ArrayLike) -> Array:
    """Speed of sound [m/s] by a law."""
    return np.asarray(Model(law).speed_of_sound(DISTANCE, temperature=temperature, **air))


def time(speeds: ArrayLike) -> Array:
    """Echo time [s] over the study's distance at given speeds [m/s]."""
    given = np.asarray(speeds, dtype=np.float64)
    flat = [Model(repr(float(value))).time_of_flight(DISTANCE) for value in given.ravel()]
    return np.array(flat, dtype=np.float64).reshape(given.shape)


def reading(times: ArrayLike) -> Array:
    """Reading [m] of the study's sensor for echo times [s]."""
    return np.asarray(Model(READING_SPEED).distance(times))


def reading_in(law: str, temperature: ArrayLike, **air: ArrayLike) -> Array:
    """Reading [m] of the study's sensor at its distance, in air whose speed follows a law."""
    return reading(Model(law).time_of_flight(DISTANCE, temperature=temperature, **air))


def error(readings: ArrayLike) -> Array:
    """Relative error of readings [%], signed: positive reads too far."""
    return (np.asarray(readings, dtype=np.float64) / DISTANCE - 1.0) * 100.0
