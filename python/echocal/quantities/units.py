"""Units in which a column may be written, and how they convert to SI.

The accepted units are a short closed list of exact affine conversions, so that a message can
print all of them; a units library would accept far more than a message can explain.
"""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from math import pi
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

Number = TypeVar("Number", float, NDArray[np.float64])


@dataclass(frozen=True)
class Unit:
    """A unit: SI value = (value - zero) * numerator / denominator.

    Parameters
    ----------
    numerator, denominator : float
        Factor to SI, in two parts so that decimals stay exact.
    zero : float
        Value of this unit that is 0 in SI.
    words : tuple of str
        Other ways to write the unit, in lower case: ``("meter", "meters")``.
    """

    numerator: float = 1.0
    denominator: float = 1.0
    zero: float = 0.0
    words: tuple[str, ...] = ()

    def to_si(self, values: Number) -> Number:
        """Convert values of this unit to SI."""
        # two operations keep decimals exact: 73.3 cm is 0.733 m to the last bit
        if self.zero != 0.0:
            values = values - self.zero
        if self.numerator != 1.0:
            values = values * self.numerator
        return values if self.denominator == 1.0 else values / self.denominator

    def from_si(self, value: Number) -> Number:
        """Convert a value in SI to this unit."""
        return value * self.denominator / self.numerator + self.zero

    def below(self, height: float) -> "Unit":
        """The same unit for values that are counted upward to a height [m], below which SI counts.

        Examples
        --------
        >>> Unit(1, 100).below(2.6).to_si(120.0)
        1.4
        """
        return replace(self, numerator=-self.numerator, zero=height * self.denominator / self.numerator)

    @property
    def is_si(self) -> bool:
        """Whether values of this unit are values in SI."""
        return (self.numerator, self.denominator, self.zero) == (1.0, 1.0, 0.0)


Units = Mapping[str, Unit]
"""Units by the symbol at the end of a column's name; the empty symbol needs none."""

LENGTH: Units = {
    "m": Unit(words=("meter", "meters", "metres")),
    "cm": Unit(1, 100, words=("centimeter", "centimeters", "centimetres")),
    "mm": Unit(1, 1000, words=("millimeter", "millimeters", "millimetres")),
    "inch": Unit(25.4, 1000, words=("in", "inches")),
    "ft": Unit(304.8, 1000, words=("foot", "feet")),
}
TWO_WAY_LENGTH: Units = {s: replace(unit, denominator=2 * unit.denominator) for s, unit in LENGTH.items()}
TIME: Units = {
    "us": Unit(1, 1e6, words=("µs", "μs", "microsecond", "microseconds")),
    "ms": Unit(1, 1e3, words=("millisecond", "milliseconds")),
    "s": Unit(words=("second", "seconds")),
}
ONE_WAY_TIME: Units = {s: replace(unit, numerator=2.0) for s, unit in TIME.items()}
CLOCK: Units = {
    "": Unit(words=("iso 8601",)),
    **TIME,
    "min": Unit(60, words=("minute", "minutes")),
    "h": Unit(3600, words=("hour", "hours")),
}
TEMPERATURE: Units = {
    "C": Unit(words=("degc", "°c", "celsius")),
    "K": Unit(zero=273.15, words=("kelvin",)),
    "F": Unit(5, 9, zero=32, words=("degf", "°f", "fahrenheit")),
}
PRESSURE: Units = {
    "Pa": Unit(words=("pascal",)),
    "hPa": Unit(100, words=("hectopascal",)),
    "kPa": Unit(1000, words=("kilopascal",)),
    "mbar": Unit(100),
}
PERCENT: Units = {"percent": Unit(1, 100, words=("%",))}
FRACTION: Units = {"": Unit(words=("1", "fraction")), **PERCENT}
MOLE_FRACTION: Units = {"ppm": Unit(1, 1e6), "mole_fraction": Unit()}
VOLTAGE: Units = {"V": Unit(words=("volt", "volts")), "mV": Unit(1, 1000)}
ANGLE: Units = {"deg": Unit(pi, 180, words=("degree", "degrees", "°")), "rad": Unit()}
SPEED: Units = {"m_s": Unit(words=("m/s",)), "km_h": Unit(1, 3.6, words=("km/h",))}
# daylight has 105 to 120 lm/W, clear or overcast: Littlefair 1985, Lighting Res. Technol. 17, 162
ILLUMINANCE: Units = {"lux": Unit(1, 110, words=("lx",))}
NUMBER: Units = {"": Unit(words=("1", "number"))}
IRRADIANCE: Units = {"W_m2": Unit(words=("w/m2", "w/m^2", "w/m²"))}


def printed(unit: str) -> str:
    """Unit as a plot and a page print it; empty for a pure number.

    Examples
    --------
    >>> printed("degC"), printed("W/(m^2 s)"), printed("1")
    ('°C', 'W/(m² s)', '')
    """
    return "" if unit == "1" else unit.replace("degC", "°C").replace("^2", "²").replace("^3", "³")


def in_cf(unit: str) -> str:
    """Unit as the CF conventions write it: powers without a slash.

    Examples
    --------
    >>> in_cf("W/(m^2 s)"), in_cf("m/s"), in_cf("degC")
    ('W m-2 s-1', 'm s-1', 'degC')
    """
    above, _, below = unit.partition("/")
    factors = [factor.replace("^", "") for factor in above.split()]
    for factor in below.strip("()").split():
        symbol, _, power = factor.partition("^")
        factors.append(f"{symbol}-{power or 1}")
    return " ".join(factors)
