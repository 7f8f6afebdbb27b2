"""Codes of a thermistor in a voltage divider, on a converter."""

import itertools
import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from echocal.codes import count
from echocal.errors import UsageError
from echocal.keywords import exact

__all__ = ["ThermistorCodes", "thermistor_of"]

_ZERO = 273.15  # K
_ROOM = 25.0  # degC
_MOST_BITS = 16
_SIDES = ("ground", "supply")


@dataclass(frozen=True)
class ThermistorCodes:
    """Codes of a converter that measures a thermistor (NTC) in a voltage divider, relative to its supply.

    One of three descriptions is given: `beta` with `r25`; `coefficients`; or `table`. A code stands for the
    middle of its step: voltage / supply = (code + 0.5) / 2^bits.

    Parameters
    ----------
    divider : float
        Resistance of the other resistor of the divider [ohm].
    beta : float, optional
        Beta [K]: 1/T = 1/298.15 + ln(R / r25) / beta.
    r25 : float, optional
        Resistance at 25 degC [ohm].
    coefficients : tuple of float, optional
        A [1/K], B [1/K] and C [1/K]: 1/T = A + B ln R + C (ln R)^3, with R in ohm (Steinhart and Hart,
        Deep-Sea Research 15, 1968, 497).
    table : tuple of (float, float), optional
        Temperatures [degC] and resistances [ohm]; between them 1/T is a straight line in ln R.
    bits : int
        Bits of the converter.
    side : {"ground", "supply"}
        Where the thermistor is in the divider.
    low, high : float
        Range that the firmware accepts [degC].

    Examples
    --------
    >>> codes = ThermistorCodes(10e3, beta=3950, r25=10e3)
    >>> first, values = codes.scale()
    >>> round(values[512 - first], 2)  # the middle of the converter: r25
    24.96
    """

    divider: float
    beta: float | None = None
    r25: float | None = None
    coefficients: tuple[float, float, float] | None = None
    table: tuple[tuple[float, float], ...] | None = None
    bits: int = 10
    side: str = "ground"
    low: float = -20.0
    high: float = 60.0

    def __post_init__(self) -> None:
        count("bits of the converter", self.bits, _MOST_BITS, least=4)
        if self.side not in _SIDES:
            raise UsageError(f"the thermistor's side is '{self.side}'; give ground or supply")
        _positive("divider", self.divider)
        given = [self.beta is not None or self.r25 is not None, self.coefficients is not None]
        if sum([*given, self.table is not None]) != 1:
            raise UsageError(
                "a thermistor has beta and r25, or coefficients a, b and c, or a table: give one of them"
            )
        if given[0]:
            _positive("beta", self.beta)
            _positive("r25", self.r25)
        if self.table is not None:
            self._check_table(self.table)

    def _check_table(self, table: tuple[tuple[float, float], ...]) -> None:
        pairs = list(itertools.pairwise(table))
        falls = all(one[0] < two[0] and one[1] > two[1] > 0 for one, two in pairs)
        if not pairs or not falls or table[0][0] <= -_ZERO:
            raise UsageError(
                "a thermistor's table needs two rows: temperatures that rise, resistances that fall"
            )
        if table[0][0] > self.low or table[-1][0] < self.high:
            raise UsageError(
                f"the thermistor's table is from {table[0][0]:g} to {table[-1][0]:g} degC, and "
                f"{self.low:g} to {self.high:g} degC are to be accepted: give more rows or a smaller range"
            )

    def temperature(self, resistance: float) -> float:
        """Temperature [degC] at a resistance [ohm]."""
        log = math.log(resistance)
        if self.table is not None:
            return _between(self.table, log)
        if self.coefficients is not None:
            a, b, c = self.coefficients
            inverse = a + b * log + c * log**3
        else:
            assert self.beta is not None
            assert self.r25 is not None
            inverse = 1.0 / (_ROOM + _ZERO) + (log - math.log(self.r25)) / self.beta
        return 1.0 / inverse - _ZERO if inverse > 0.0 else math.inf

    def scale(self) -> tuple[int, list[float]]:
        """Return the first accepted code, and the temperatures of the accepted codes [degC].

        Raises
        ------
        UsageError
            If no code is in the range.
        """
        steps = 1 << self.bits
        ratios = (((code + 0.5) / steps) for code in range(steps))
        through = (r / (1.0 - r) if self.side == "ground" else (1.0 - r) / r for r in ratios)
        values = [self.temperature(self.divider * one) for one in through]
        inside = [code for code, value in enumerate(values) if self.low <= value <= self.high]
        if len(inside) < 2 or inside[-1] - inside[0] + 1 != len(inside):
            raise UsageError(
                f"a thermistor with {self.text()} has {len(inside)} codes in one piece from "
                f"{self.low:g} to {self.high:g} degC: look at its data, or give another range of temperatures"
            )
        return inside[0], values[inside[0] : inside[-1] + 1]

    def text(self) -> str:
        """What it is, as the command reads it."""
        words: dict[str, Any] = {"divider": exact(self.divider), "bits": self.bits, "side": self.side}
        if self.table is not None:
            words["table"] = "/".join(f"{exact(at)}:{exact(value)}" for at, value in self.table)
        elif self.coefficients is not None:
            words |= dict(zip("abc", map(exact, self.coefficients), strict=True))
        else:
            words |= {"beta": exact(self.beta), "r25": exact(self.r25)}
        return ",".join(f"{name}={value}" for name, value in words.items())

    def words(self) -> str:
        """What it is, as headers state it."""
        return (
            f"a thermistor ({self.text()}; resistances in ohm, beta in K), ratio of voltages = "
            f"(code + 0.5) / {1 << self.bits}"
        )


def thermistor_of(text: str, low: float, high: float) -> ThermistorCodes:
    """Read a thermistor from ``KEY=VALUE,...``.

    Raises
    ------
    UsageError
        If a key is not known or a value is none.
    """
    keys = ("divider", "beta", "r25", "a", "b", "c", "table", "bits", "side")
    given: dict[str, str] = {}
    for part in text.split(","):
        key, _, value = part.partition("=")
        if key not in keys or not value or key in given:
            raise UsageError(f"'{part}' of the thermistor is no KEY=VALUE; keys are {', '.join(keys)}")
        given[key] = value
    return ThermistorCodes(**_read(given), low=low, high=high)


def _read(given: Mapping[str, str]) -> dict[str, Any]:
    found: dict[str, Any] = {"divider": None}
    found |= {key: _number(key, given[key]) for key in ("divider", "beta", "r25") if key in given}
    if {"a", "b", "c"} & given.keys():
        if absent := [key for key in "abc" if key not in given]:
            raise UsageError(f"the thermistor has no {' and no '.join(absent)}: give a, b and c")
        found["coefficients"] = tuple(_number(key, given[key]) for key in "abc")
    if "table" in given:
        found["table"] = tuple(map(_row, given["table"].split("/")))
    if "bits" in given:
        found["bits"] = count("bits of the converter", _number("bits", given["bits"]), _MOST_BITS, least=4)
    if "side" in given:
        found["side"] = given["side"]
    return found


def _row(text: str) -> tuple[float, float]:
    at, separator, value = text.partition(":")
    if not separator:
        raise UsageError(f"'{text}' of the thermistor's table is no DEGC:OHM; rows are DEGC:OHM/DEGC:OHM/...")
    return _number("table", at), _number("table", value)


def _number(key: str, text: str) -> float:
    try:
        return float(text)
    except ValueError:
        raise UsageError(f"'{text}' in the thermistor's {key} is no number") from None


def _between(table: tuple[tuple[float, float], ...], log: float) -> float:
    """Temperature [degC] where ln R is `log`; infinite or below absolute zero outside of the table."""
    for (cool, most), (warm, least) in itertools.pairwise(table):
        upper, lower = math.log(most), math.log(least)
        if lower <= log <= upper:
            share = (log - lower) / (upper - lower)
            inverse = (1.0 - share) / (warm + _ZERO) + share / (cool + _ZERO)
            return 1.0 / inverse - _ZERO
    return -math.inf if log > math.log(table[0][1]) else math.inf


def _positive(name: str, value: float | None) -> None:
    if value is None or not (math.isfinite(value) and value > 0.0):
        raise UsageError(
            f"the thermistor's {name} is {value}; give a positive number [{'K' if name == 'beta' else 'ohm'}]"
        )
