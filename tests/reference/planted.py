"""Tables that a fault or a noise is planted in, and the search for it."""

import warnings

import numpy as np

import echocal
from echocal.diagnose.faults import Faults, FaultSettings, find_faults
from echocal.diagnose.findings.facts import Columns
from echocal.diagnose.preprocess.base import Base
from echocal.diagnose.settings import Settings
from echocal.observations.plan import EVERYTHING

ROWS = 400


def clean(random: np.random.Generator) -> Columns:
    """A ranger that its simulation describes, with normal noise of 1 mm."""
    distance = random.uniform(0.4, 3.9, ROWS).round(3)
    row = np.arange(ROWS)
    return {
        "reading_m": distance + random.normal(0.0, 1e-3, ROWS),
        "distance_m": distance,
        "temperature_C": 14 + 9 * np.sin(row / 40) + random.normal(0.0, 0.1, ROWS),
        "humidity_percent": 55 + 20 * np.sin(row / 17) + random.normal(0.0, 2.0, ROWS),
        "time_s": 60.0 * row,
    }


def search(table: Columns, settings: FaultSettings | None = None) -> tuple[echocal.Observations, Faults]:
    """The table as it was read, and what the search for faults makes of it."""
    law = "linear" if "temperature_C" in table else "343"
    with warnings.catch_warnings(action="ignore"):  # what is wrong with the table is what it is for
        data = echocal.read_observations(table, reading_speed=law, trust=(EVERYTHING,))
        constant = "distance_m" not in table
        faults = find_faults(data, Base.of(law), None, constant, Settings(faults=settings or FaultSettings()))
    return data, faults


def accepted(table: Columns, settings: FaultSettings | None = None) -> list[str]:
    """Ids of faults that the table was repaired of."""
    return [f.cause for f in search(table, settings)[1].accepted if f.facts.kind != "noise"]
