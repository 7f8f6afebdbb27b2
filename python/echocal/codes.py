"""What a device measures, as integers: ticks of a timer, codes of a thermometer and of other sensors."""

from collections.abc import Mapping
from dataclasses import astuple, dataclass, fields
from numbers import Real
from typing import Any, TypeVar

import numpy as np

from echocal.errors import UsageError

__all__ = [
    "EchoCodes",
    "FurtherCodes",
    "HumidityCodes",
    "TemperatureCodes",
    "codes_of",
    "count",
    "numbers",
    "value_at",
]

_MOST_SHIFT = 24  # of codes of 32 bits 8 are left


@dataclass(frozen=True)
class EchoCodes:
    """Ticks of the timer that takes the time of the echo: time of flight = lsb * code.

    Parameters
    ----------
    lsb : float
        Tick [us]; 0.5 for Timer1 of an Arduino UNO at an eighth of its clock.
    longest : float, optional
        Longest echo time that the firmware accepts [us]; default: the latest echo from the largest
        requested distance. The time-out pulse of a module without an echo is never accepted by default.
    shortest : float, optional
        Shortest echo time that it accepts [us]; default: the earliest echo from
        `echocal.echoes.BLANKING_M`, the least distance that an HC-SR04 measures.
    bits : int
        Bits of the timer: 16, or 32 for a ``uint32_t``.
    """

    lsb: float = 1.0
    longest: float | None = None
    shortest: float | None = None
    bits: float = 16


@dataclass(frozen=True)
class TemperatureCodes:
    """Integer codes of a thermometer: temperature = zero + lsb * code.

    Parameters
    ----------
    lsb : float
        Step of one code [degC]; 0.0625 for a DS18B20. Negative if the codes fall when the temperature rises.
    low, high : float
        Range that the firmware accepts [degC].
    zero : float
        Temperature of code 0 [degC].
    shift : int
        Lowest bits of the code that the function drops: it takes the middle of a step of 2^shift codes for
        all of them. The header states what that costs. Codes below 0 cannot be shifted.
    """

    lsb: float = 0.0625
    low: float = -20.0
    high: float = 60.0
    zero: float = 0.0
    shift: float = 0


@dataclass(frozen=True)
class HumidityCodes:
    """Integer codes of a hygrometer: relative humidity = zero + lsb * code.

    Parameters
    ----------
    lsb : float
        Step of one code [1]; 0.01 for whole percents. Negative if the codes fall when the humidity rises.
    low, high : float
        Range that the firmware accepts [1].
    zero : float
        Relative humidity of code 0 [1].
    shift : int
        Lowest bits of the code that the function drops, as for `TemperatureCodes`.
    """

    lsb: float = 0.01
    low: float = 0.0
    high: float = 1.0
    zero: float = 0.0
    shift: float = 0


@dataclass(frozen=True)
class FurtherCodes:
    """Integer codes of one further quantity of the air, the device or the echo: value = zero + lsb * code.

    Parameters
    ----------
    quantity : str
        Name of the quantity, such as ``"supply_voltage"``, ``"wind_speed"``, ``"angle"``, ``"amplitude"``,
        ``"pressure"``; its unit is that of `echocal.quantities`.
    lsb : float
        Step of one code. Negative if the codes fall when the quantity rises.
    low, high : float
        Range that the firmware accepts.
    zero : float
        Value of code 0.
    shift : int
        Lowest bits of the code that the function drops, as for `TemperatureCodes`.
    """

    quantity: str
    lsb: float
    low: float
    high: float
    zero: float = 0.0
    shift: float = 0


Codes = TypeVar("Codes", EchoCodes, TemperatureCodes, HumidityCodes)


def codes_of(name: str, kind: type[Codes], request: Any) -> Codes:
    """Return codes of a kind, from such codes or from a tuple of numbers.

    Raises `UsageError` if it is neither.
    """
    try:
        codes = request if isinstance(request, kind) else kind(*map(float, request))
        open_ = {field.name for field in fields(kind) if field.default is None}
        given = zip(fields(kind), astuple(codes), strict=True)
        if all(isinstance(value, Real) or (value is None and one.name in open_) for one, value in given):
            return codes
    except (TypeError, ValueError):
        pass
    order = ", ".join(field.name for field in fields(kind))
    raise UsageError(f"{name} is {request!r}; give {kind.__name__}({order}), or the numbers as a tuple")


def numbers(
    name: str, codes: TemperatureCodes | HumidityCodes | FurtherCodes
) -> tuple[float, float, float, float, int]:
    """Return step, ends, value of code 0 and dropped bits, as the core takes them.

    Raises `UsageError` if the number of dropped bits is no whole number.
    """
    shift = count(f"the shift of {name}", codes.shift, _MOST_SHIFT, least=0)
    return float(codes.lsb), float(codes.low), float(codes.high), float(codes.zero), shift


def value_at(axis: Mapping[str, Any], code: Any) -> Any:
    """Return what the function takes a code for: the middle of its step, where bits are dropped.

    In the unit of the axis, a condition of ``report["device"]``.

    Examples
    --------
    >>> value_at({"lsb": 0.25, "zero": -10.0, "shift": 2}, 41)
    0.375
    """
    if "values" in axis:
        return np.asarray(axis["values"])[code - axis["codes"]["minimum"]]
    step = 1 << axis.get("shift", 0)
    return axis["zero"] + axis["lsb"] * ((code & -step) + (step - 1) / 2)


def count(name: str, value: float, most: int, *, least: int | None = None) -> int:
    """Return a whole number.

    Raises `UsageError` if it is none, or outside `least` .. `most`.
    """
    whole = isinstance(value, Real) and not isinstance(value, bool) and float(value).is_integer()
    if not whole or abs(value) > most or (least is not None and value < least):
        raise UsageError(
            f"{name} is {value!r}; give a whole number" + ("" if least is None else f" of {least} .. {most}")
        )
    return int(value)
