"""The study's tables as printed: numbers with their digits."""

from dataclasses import dataclass
from importlib import resources
from pathlib import Path

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from echocal.errors import DataError
from echocal.observations import Observations, read_observations
from echocal.study.rounding import Printed

__all__ = ["DISTANCE", "READING_SPEED", "Table", "Tables", "observations"]

DISTANCE = 2.0
"""Reference distance of the study [m]."""

READING_SPEED = "343"
"""Fixed speed that the study's sensor converts with [m/s], as a law's expression."""

FILES = {"table1": 7, "table2": 3}


@dataclass(frozen=True)
class Table:
    """Columns of numbers as printed."""

    columns: dict[str, tuple[Printed, ...]]

    def values(self, name: str) -> NDArray[np.float64]:
        """Return a column's numbers, shape (n,)."""
        return np.array([printed.value for printed in self.columns[name]])

    def half(self, name: str) -> NDArray[np.float64]:
        """Half a unit of the last printed digit, shape (n,)."""
        return np.array([printed.half for printed in self.columns[name]])

    @property
    def temperature(self) -> NDArray[np.float64]:
        """Temperatures [degC], shape (n,)."""
        return self.values("temperature_C")

    def range(self, count: int) -> NDArray[np.float64]:
        """Evenly spaced temperatures [degC] from the first row's to the last's, shape (count,)."""
        return np.linspace(float(self.temperature[0]), float(self.temperature[-1]), count)

    def __len__(self) -> int:
        return len(self.columns["temperature_C"])


@dataclass(frozen=True)
class Tables:
    """Table 1 (calculation) and Table 2 (calculation beside Tinkercad)."""

    table1: Table
    table2: Table

    @classmethod
    def load(cls, folder: Path | None = None) -> "Tables":
        """Read ``table1.csv`` and ``table2.csv``.

        Parameters
        ----------
        folder : Path, optional
            Where they lie; by default the tables that the package ships.

        Raises
        ------
        DataError
            If a table cannot be read.
        """
        place = folder if folder is not None else resources.files("echocal.study") / "data"
        tables = []
        for name, width in FILES.items():
            try:
                with (place / f"{name}.csv").open(encoding="utf-8") as file:
                    frame = pd.read_csv(file, comment="#", dtype=str)
                table = Table({str(name): tuple(map(Printed, frame[name])) for name in frame})
                numbers = [table.values(column) for column in table.columns]
            except (OSError, ValueError, TypeError) as error:
                message = f"cannot read {name}.csv of the study: {error}"
                raise DataError(message) from None
            if len(numbers) != width:
                message = f"{name}.csv of the study has {len(numbers)} columns, not {width}"
                raise DataError(message)
            tables.append(table)
        return cls(*tables)


def observations(
    temperature: NDArray[np.float64],
    reading: NDArray[np.float64],
    distance: NDArray[np.float64] | float = DISTANCE,
) -> Observations:
    """Readings [m] of the study's sensor as observations.

    Parameters
    ----------
    temperature : ndarray, shape (n,)
        Temperatures [degC].
    reading : ndarray, shape (n,)
        Readings [m], made with 343 m/s.
    distance : ndarray or float
        Reference distance [m].
    """
    columns = {
        "temperature_C": temperature,
        "reading_m": reading,
        "distance_m": np.broadcast_to(distance, reading.shape).copy(),
    }
    return read_observations(columns, reading_speed=READING_SPEED)
