"""What a logger wrote down: where noise, rows and columns go wrong."""

from dataclasses import dataclass, field

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from hidden_effects.designs import Rows
from hidden_effects.world import World, linear

Column = NDArray[np.float64]


@dataclass
class Log:
    """Columns as logged: the reading with its noise [m], the temperature [degC], the rest as true."""

    world: World
    reading: Column
    temperature: Column
    humidity: Column | None = None
    extra: dict[str, Column] = field(default_factory=dict)

    @property
    def rows(self) -> Rows:
        return self.world.rows

    @property
    def speed(self) -> Column:
        """Speed that the device reckons with [m/s]."""
        return linear(self.world.recorded)

    def table(self, shown: set[str], reference: Column) -> pd.DataFrame:
        """The table that a user would have."""
        table = self.world.table(self.reading, shown, reference)
        table["temperature_C"] = self.temperature
        if self.humidity is not None and "humidity_percent" in table:
            table["humidity_percent"] = self.humidity
        return table.assign(**self.extra)
