"""Hygrometers of the bench."""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike, NDArray

__all__ = ["HIH4030", "AnalogHygrometer"]

Column = NDArray[np.float64]


@dataclass(frozen=True)
class AnalogHygrometer:
    """A hygrometer with a voltage that is proportional to its supply.

    Attributes
    ----------
    name : str
        Its kind.
    at_zero, slope : float
        Voltage as a share of the supply: at 0, and per unit of relative humidity, at 25 degC [1].
    sensitivity, sensitivity_slope : float
        What it shows is the relative humidity times ``sensitivity + sensitivity_slope * temperature``
        [1], [1/degC].
    tolerance : float
        Standard deviation of the offsets of parts [1]; half of the data sheet's limit.
    offset : float
        Offset of this part [1].
    """

    name: str
    at_zero: float
    slope: float
    sensitivity: float = 1.0
    sensitivity_slope: float = 0.0
    tolerance: float = 0.0
    offset: float = 0.0

    def drawn(self, random: np.random.Generator) -> "AnalogHygrometer":
        """Return one part of this kind."""
        return replace(self, offset=float(random.normal(0.0, self.tolerance)))

    def voltage(self, relative_humidity: ArrayLike, temperature: ArrayLike, supply: float = 5.0) -> Column:
        """Voltage at the output [V]: air of a relative humidity [1] and a temperature [degC], a supply [V].

        Examples
        --------
        >>> round(float(HIH4030.voltage(0.5, 25.0)), 3)
        2.351
        """
        warm = np.asarray(temperature, dtype=np.float64)
        shown = (
            np.asarray(relative_humidity) * (self.sensitivity + self.sensitivity_slope * warm) + self.offset
        )
        return np.asarray(np.clip(supply * (self.at_zero + self.slope * shown), 0.0, supply))


HIH4030 = AnalogHygrometer(
    "HIH-4030",
    at_zero=0.16,  # HIH-4030/31 data sheet 009021-5 (Honeywell): V = supply (0.0062 RH/% + 0.16) at 25 degC
    slope=0.62,
    sensitivity=1.0546,  # the same: true RH = RH / (1.0546 - 0.00216 T)
    sensitivity_slope=-0.00216,
    tolerance=0.0175,  # the same: 3.5 % RH
)
"""Honeywell HIH-4030, analog, 5 V."""
