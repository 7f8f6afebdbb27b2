"""Which law made Table 1, and which single change explains the Tinkercad column: by `calibrate`."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from echocal.calibrate import Calibration, Estimate, calibrate
from echocal.model import Model
from echocal.observations import read_observations
from echocal.study.sensor import STATED_LAW, time
from echocal.study.tables import DISTANCE, Table, Tables, observations

__all__ = ["CAUSES", "Alternative", "alternatives", "explain", "fit_table_law", "table_law"]

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
    """A single change that may explain the Tinkercad column.

    Attributes
    ----------
    cause : str
        Name of the parameter.
    estimate : Estimate
        Its value with standard uncertainty.
    residual_standard_deviation : float
        What the change leaves [m].
    """

    cause: str
    estimate: Estimate
    residual_standard_deviation: float

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
    """Calibrate changes that explain Tinkercad's readings of 2 m, against the law of Table 1.

    Parameters
    ----------
    tables : Tables
        The tables.
    fit : sequence of str
        Parameters of the changes.
    loss : str
        See `calibrate`.
    """
    table = tables.table2
    data = observations(table.temperature, table.values("measured_distance_tinkercad_m"))
    return calibrate(data, Model(table_law(tables)), fit, loss=loss)


def alternatives(tables: Tables) -> list[Alternative]:
    """Fit each single change to the Tinkercad column, the one that leaves least first."""
    found = {cause: explain(tables, [cause]) for cause in CAUSES}
    listed = [Alternative(cause, fit[cause], fit.residual_standard_deviation) for cause, fit in found.items()]
    return sorted(listed, key=lambda alternative: alternative.residual_standard_deviation)
