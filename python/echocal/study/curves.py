"""The study's sensor in true air, over the temperatures of its tables."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from echocal.study.sensor import REFERENCE_LAW, STATED_LAW, reading_in
from echocal.study.tables import Tables

__all__ = ["HUMIDITIES", "Curves"]

HUMIDITIES = {"dry air": 0.0, "50 % RH": 0.5, "100 % RH": 1.0}


@dataclass(frozen=True)
class Curves:
    """Readings [m] of the sensor at 2 m.

    Attributes
    ----------
    temperature : ndarray, shape (n,)
        Temperatures [degC].
    stated : ndarray, shape (n,)
        By the study's equation.
    air : dict of str to ndarray, shape (n,)
        In true air, by humidity.
    """

    temperature: NDArray[np.float64]
    stated: NDArray[np.float64]
    air: dict[str, NDArray[np.float64]]

    @classmethod
    def of(cls, tables: Tables) -> "Curves":
        """Compute the curves over the range of Table 1."""
        temperature = tables.table1.range(201)
        air = {
            name: reading_in(REFERENCE_LAW, temperature, relative_humidity=humidity)
            for name, humidity in HUMIDITIES.items()
        }
        return cls(temperature, reading_in(STATED_LAW, temperature), air)
