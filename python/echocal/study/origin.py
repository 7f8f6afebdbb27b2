"""Which law made Table 1, and which single change explains the Tinkercad column: by `calibrate`."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from echocal.calibrate import Calibration, Estimate, calibrate
from echocal.model import Model
from echocal.observations import read_observations
from echocal.study.tables import DISTANCE, READING_SPEED, Table, Tables, observations

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


CAUSES = {
    "zero_error.offset": "constant offset",
    "clock_error.frequency_error": "constant factor",
    "fixed_delay.delay": "latency",
    "temperature_offset.offset": "thermometer off",
}
"""Single changes to try on the Tinkercad column, by parameter, each in plain words."""

SHOWN = {"m": (1e3, "mm"), "s": (1e6, "µs"), "1": (1e2, "%"), "K": (1.0, "K")}


@dataclass(frozen=True)
class Alternative:
    """A single change that may explain the Tinkercad column."""

    cause: str  # name of the parameter
    estimate: Estimate  # its value with standard uncertainty
    residual_standard_deviation: float  # what the change leaves [m]

    def __str__(self) -> str:
        factor, unit = SHOWN[self.estimate.unit]
        value, spread = self.estimate.value * factor, self.estimate.standard_uncertainty * factor
        return f"{value:.2f} ± {spread:.2f} {unit}"


def fit_table_law(table: Table) -> Calibration:
    """Fit the linear law behind Table 1's speeds, robustly: one odd row must not move it."""
    columns = {
        "echo_s": time(table.values("actual_speed_m_s")),
        "temperature_C": table.temperature,
        "distance_m": np.full(len(table), DISTANCE),
    }
    data = read_observations(columns)
    return calibrate(data, Model(STATED_LAW), ["law.intercept", "law.slope"], loss="cauchy")


def table_law(tables: Tables) -> str:
    """Return the law behind Table 1's speeds, to the digits of the study's own equation."""
    found = fit_table_law(tables.table1)
    return f"{found['law.intercept'].value:.1f}{found['law.slope'].value:+.1f}*T"


def explain(tables: Tables, fit: Sequence[str], *, loss: str = "linear") -> Calibration:
    """Calibrate changes that explain Tinkercad's readings of 2 m, against the law of Table 1."""
    table = tables.table2
    data = observations(table.temperature, table.values("measured_distance_tinkercad_m"))
    return calibrate(data, Model(table_law(tables)), fit, loss=loss)


def alternatives(tables: Tables) -> list[Alternative]:
    """Fit each single change to the Tinkercad column, the one that leaves least first."""
    found = {cause: explain(tables, [cause]) for cause in CAUSES}
    listed = [Alternative(cause, fit[cause], fit.residual_standard_deviation) for cause, fit in found.items()]
    return sorted(listed, key=lambda alternative: alternative.residual_standard_deviation)
