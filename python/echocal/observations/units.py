"""The names that a table's columns may have, and what each means in SI units.

The accepted units are a short closed list of exact affine conversions, so that a message can
print all of them; a units library would accept far more than a message can explain.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field
from math import inf, pi
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

__all__ = ["FORMS", "NAMES", "Form", "Unit"]

Number = TypeVar("Number", float, NDArray[np.float64])


@dataclass(frozen=True)
class Unit:
    """A unit: SI value = (value - zero) * numerator / denominator."""

    numerator: float = 1.0
    denominator: float = 1.0
    zero: float = 0.0

    def to_si(self, values: Number) -> Number:
        """Convert values of this unit to SI."""
        # two operations keep decimals exact: 73.3 cm is 0.733 m to the last bit
        if self.zero != 0.0:
            values = values - self.zero
        if self.numerator != 1.0:
            values = values * self.numerator
        return values if self.denominator == 1.0 else values / self.denominator

    def from_si(self, value: float) -> float:
        """Convert a value in SI to this unit."""
        return value * self.denominator / self.numerator + self.zero


@dataclass(frozen=True)
class Form:
    """A quantity that a column may hold, and how it may be written."""

    role: str
    """First part of the column's name; the unit follows after an underscore."""
    quantity: str
    """Where the values go: an influence quantity, or a field of `Observations`."""
    units: Mapping[str, Unit]
    words: tuple[str, ...]
    """What people call it: ``"distance reading in m"``."""
    physical: tuple[float, float] = (-inf, inf)
    """Rows outside cannot be used [SI]."""
    typical: tuple[float, float] | None = None
    """A median outside is another unit by the look of it [SI]; None: as `physical`."""
    positive: bool = False
    """Whether the lower bound itself is impossible."""
    also: tuple[str, ...] = field(default=(), kw_only=True)
    """Names of other forms that a column of this one may be by mistake."""
    label: bool = field(default=False, kw_only=True)
    """Whether values are labels rather than measurements."""

    @property
    def names(self) -> tuple[str, ...]:
        """Every accepted column name."""
        return tuple(f"{self.role}_{unit}" if unit else self.role for unit in self.units)


_LENGTH = {"m": Unit(), "cm": Unit(1, 100), "mm": Unit(1, 1000), "inch": Unit(25.4, 1000)}
_BOTH_WAYS = {name: Unit(unit.numerator, 2 * unit.denominator) for name, unit in _LENGTH.items()}
_TIME = {"us": Unit(1, 1e6), "ms": Unit(1, 1e3), "s": Unit()}
_ONE_WAY = {name: Unit(2, unit.denominator) for name, unit in _TIME.items()}
_CLOCK = {"": Unit(), **_TIME, "min": Unit(60), "h": Unit(3600)}
_TEMPERATURE = {"C": Unit(), "K": Unit(zero=273.15), "F": Unit(5, 9, zero=32)}
_PRESSURE = {"Pa": Unit(), "hPa": Unit(100), "kPa": Unit(1000), "mbar": Unit(100)}
_FRACTION = {"": Unit(), "percent": Unit(1, 100)}

_ECHO = (0.0, 0.5)  # 86 m out and back: beyond any ranger in air
_ECHOES = (5e-5, 0.5)  # 9 mm: below any ranger's blanking distance
_RANGE = (0.0, 100.0)
_RANGES = (5e-3, 100.0)
_AIR = (-95.0, 100.0)  # coldest air on record -89.2 degC (WMO); DS18B20 errors are 85 and -127
_ROOM = (-60.0, 55.0)
_HUMID = (0.015, 1.0)  # a median below 1.5 % is a fraction by the look of it


def _echo(role: str, units: Mapping[str, Unit], *words: str) -> Form:
    return Form(role, "echo_time", units, words, _ECHO, _ECHOES, positive=True)


def _length(role: str, quantity: str, units: Mapping[str, Unit], *words: str) -> Form:
    return Form(role, quantity, units, words, _RANGE, _RANGES, positive=True)


def _humidity(role: str, units: Mapping[str, Unit], also: str, typical: tuple[float, float] | None) -> Form:
    words = (role.replace("_", " "),)
    return Form(role, "relative_humidity", units, words, (0.0, 1.0), typical, also=(also,))


def _label(role: str, *words: str) -> Form:
    return Form(role, role, {"": Unit()}, words, label=True)


FORMS: tuple[Form, ...] = (
    _echo("echo", _TIME, "echo time", "time of flight"),
    _echo("time_of_flight", _TIME),
    _echo("transit", _ONE_WAY, "transit time", "one-way time"),
    _length("reading", "reading", _LENGTH, "distance reading", "indication"),
    _length("two_way_reading", "reading", _BOTH_WAYS, "two-way reading"),
    _length("distance", "reference_distance", _LENGTH, "reference distance"),
    _length("two_way_distance", "reference_distance", _BOTH_WAYS, "two-way distance"),
    Form("temperature", "temperature", _TEMPERATURE, ("air temperature",), _AIR, _ROOM),
    _humidity("humidity", {"percent": Unit(1, 100)}, "relative_humidity", _HUMID),
    _humidity("relative_humidity", _FRACTION, "humidity_percent", None),
    Form("pressure", "pressure", _PRESSURE, ("air pressure",), (25e3, 120e3)),
    Form("co2", "co2_mole_fraction", {"ppm": Unit(1, 1e6), "mole_fraction": Unit()}, (), (0.0, 1.0)),
    Form("time", "elapsed_time", _CLOCK, ("elapsed time",)),
    Form("supply", "supply_voltage", {"V": Unit(), "mV": Unit(1, 1000)}, ("supply voltage",), (0.0, 60.0)),
    Form("angle", "angle", {"deg": Unit(pi, 180), "rad": Unit()}, (), (-pi / 2, pi / 2)),
    Form("wind", "wind_speed", {"m_s": Unit(), "km_h": Unit(1, 3.6)}, ("wind speed",), (0.0, 120.0)),
    # pyranometers read slightly below zero at night
    Form("radiation", "radiation", {"W_m2": Unit()}, ("irradiance",), (-50.0, 2000.0)),
    Form("amplitude", "amplitude", _FRACTION, (), (0.0, 1.0)),
    _label("stand"),
    _label("group", "burst"),
    _label("order"),
)
"""Every quantity that a table may hold."""

NAMES: dict[str, tuple[Form, str]] = {
    name: (form, unit) for form in FORMS for name, unit in zip(form.names, form.units, strict=True)
}
"""Form and unit by column name."""
