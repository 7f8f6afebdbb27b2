"""The oracle's chain from air to table; a cause changes one stage of it.

The base simulation that tables are diagnosed against is the linear law of a study. Where nothing
is planted nature follows that law exactly; what air really does beside it comes from `gas`, and
only where it is planted.
"""

from dataclasses import dataclass, field

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from hidden_effects import gas
from hidden_effects.designs import Rows

Column = NDArray[np.float64]

COLUMNS = {
    "pressure": "pressure_Pa",
    "supply": "supply_V",
    "wind": "wind_m_s",
    "radiation": "radiation_W_m2",
    "angle": "angle_deg",
}
"""Columns that a log may hold, by the quantity they record."""


def linear(temperature: Column) -> Column:
    """The study's law [m/s]: 331.4 + 0.6 T."""
    return 331.4 + 0.6 * temperature


@dataclass
class World:
    """One campaign; stages that causes may change.

    `air` is what sound feels, `recorded` what the thermometer says, `path` one way [m], `later`
    a delay [s], `clock` counted over true time, `firmware` the speed the device reckons with,
    `added` what ends up on the reading [m], `reference` the distance noted down.
    """

    rows: Rows
    air: Column = field(init=False)
    recorded: Column = field(init=False)
    path: Column = field(init=False)
    reference: Column = field(init=False)
    real_air: bool = False
    faster: Column | float = 0.0
    later: Column | float = 0.0
    clock: Column | float = 1.0
    added: Column | float = 0.0
    device: Column | float | None = None
    law_error: Column | float = 1.0
    hidden: set[str] = field(default_factory=set)

    def __post_init__(self) -> None:
        self.air = self.rows.temperature.copy()
        self.recorded = self.rows.temperature.copy()
        self.path = self.rows.distance.copy()
        self.reference = self.rows.distance.copy()

    def speed(self) -> Column:
        """Speed of sound on the path [m/s]."""
        dry = gas.speed(self.air) if self.real_air else linear(self.air)
        return np.asarray(dry + self.faster)

    def reading(self) -> Column:
        """What the device shows [m], without noise."""
        echo = self.clock * (2 * self.path / self.speed() + self.later)
        firmware = linear(self.recorded) if self.device is None else self.device
        return np.asarray(firmware * self.law_error * echo / 2 + self.added)

    def shift(self) -> Column:
        """What is wrong with the readings [m]: the signal that a diagnosis looks for."""
        return self.reading() - self.reference

    def table(self, reading: Column, shown: set[str], reference: Column | None = None) -> pd.DataFrame:
        """The table that a user would have."""
        rows = self.rows
        columns: dict[str, Column] = {"reading_m": reading, "temperature_C": self.recorded}
        columns["distance_m"] = self.reference if reference is None else reference
        if "time" in rows.offers:
            columns["time_s"] = rows.seconds
            if "humidity" not in self.hidden:
                columns["humidity_percent"] = 100 * rows.humidity
        for name in sorted(shown - self.hidden):
            value: Column = getattr(rows, name)
            columns[COLUMNS[name]] = np.degrees(value) if name == "angle" else value
        return pd.DataFrame(columns)
