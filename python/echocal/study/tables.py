"""The study's tables as printed: numbers with their digits, and what can follow from their rounding."""

from collections.abc import Callable
from dataclasses import dataclass
from decimal import Decimal
from importlib import resources
from pathlib import Path

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from echocal.errors import DataError
from echocal.observations import Observations, read_observations

DISTANCE = 2.0
"""Reference distance of the study [m]."""

READING_SPEED = "343"
"""Fixed speed that the study's sensor converts with [m/s], as a law's expression."""

FILES = {"table1": 7, "table2": 3}
Array = NDArray[np.float64]
SLACK = 1e-9  # of half a digit: a number that lies on the edge rounds either way


@dataclass(frozen=True)
class Printed:
    """A number as printed: every value that rounds to it is meant.

    Examples
    --------
    >>> printed = Printed("2.071")
    >>> printed.low, printed.high
    (2.0705, 2.0715)
    >>> printed.holds(2.0713), printed.holds(2.0716)
    (True, False)
    """

    text: str  # the number as printed, e.g. ``"2.071"`` or ``"6.13e-6"``.

    @property
    def value(self) -> float:
        """The number itself."""
        return float(self.text)

    @property
    def half(self) -> float:
        """Half a unit of the last printed digit."""
        exponent = Decimal(self.text).as_tuple().exponent
        return float(Decimal(1).scaleb(int(exponent)) / 2)

    @property
    def low(self) -> float:
        """Smallest value that rounds to it."""
        return float(Decimal(self.text) - Decimal(repr(self.half)))

    @property
    def high(self) -> float:
        """Largest value that rounds to it."""
        return float(Decimal(self.text) + Decimal(repr(self.half)))

    def holds(self, value: float) -> bool:
        """Whether a value rounds to it."""
        return self.meets(value, value)

    def meets(self, low: float, high: float) -> bool:
        """Whether some value between two bounds rounds to it."""
        slack = SLACK * self.half
        return low <= self.high + slack and high >= self.low - slack


def reach(function: Callable[[Array], float], center: Array, half: Array) -> tuple[float, float]:
    """Find the range of a function over everything that rounds to its printed arguments.

    Follows the signs of the derivatives to a corner of the box, until they no longer change. Both ends are
    values that the function takes in the box, so what lies between them is reachable; where the function is
    monotone in each argument, as here over half a digit, they are its extremes. `center` are the arguments
    as printed, `half` half a unit of the last printed digit of each, shape (n,).

    Examples
    --------
    >>> reach(lambda x: float(x.sum()), np.array([1.0, 2.0]), np.array([0.5, 0.5]))
    (2.0, 4.0)
    """
    return _corner(function, center, half, -1.0), _corner(function, center, half, 1.0)


def _corner(function: Callable[[Array], float], center: Array, half: Array, sign: float) -> float:
    best = at = center
    for _ in range(10):
        slopes = np.array([_slope(function, at, half, index) for index in range(len(center))])
        at = center + sign * np.sign(slopes) * half
        if sign * (function(at) - function(best)) <= 0.0:
            break
        best = at
    return function(best)


def _slope(function: Callable[[Array], float], at: Array, half: Array, index: int) -> float:
    step = np.zeros_like(at)
    step[index] = 0.1 * half[index]
    return function(at + step) - function(at - step)


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

        By default those that the package ships. Raises `DataError` if a table cannot be read.
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
                raise DataError(f"cannot read {name}.csv of the study: {error}") from None
            if len(numbers) != width:
                raise DataError(f"{name}.csv of the study has {len(numbers)} columns, not {width}")
            tables.append(table)
        return cls(*tables)


def observations(
    temperature: NDArray[np.float64],
    reading: NDArray[np.float64],
    distance: NDArray[np.float64] | float = DISTANCE,
) -> Observations:
    """Readings [m] of the study's sensor as observations.

    The readings are made with 343 m/s; temperatures are in degC.
    """
    columns = {
        "temperature_C": temperature,
        "reading_m": reading,
        "distance_m": np.broadcast_to(distance, reading.shape).copy(),
    }
    return read_observations(columns, reading_speed=READING_SPEED)
