"""What a device measures, as integers: ticks of a timer, codes of a thermometer and of a hygrometer."""

from dataclasses import astuple, dataclass, fields
from numbers import Real
from typing import Any, TypeVar

from echocal.errors import UsageError

__all__ = ["EchoCodes", "HumidityCodes", "TemperatureCodes", "codes_of"]


@dataclass(frozen=True)
class EchoCodes:
    """Ticks of the timer that takes the time of the echo: time of flight = lsb * code.

    Parameters
    ----------
    lsb : float
        Tick [us]; 0.5 for Timer1 of an Arduino UNO at an eighth of its clock.
    longest : float
        Longest echo time that the firmware accepts [us].
    """

    lsb: float = 1.0
    longest: float = 38_000.0


@dataclass(frozen=True)
class TemperatureCodes:
    """Integer codes of a thermometer: temperature = zero + lsb * code.

    Parameters
    ----------
    lsb : float
        Step of one code [degC]; 0.0625 for a DS18B20, negative where codes fall as it gets warmer.
    low, high : float
        Range that the firmware accepts [degC].
    zero : float
        Temperature of code 0 [degC].
    """

    lsb: float = 0.0625
    low: float = -20.0
    high: float = 60.0
    zero: float = 0.0


@dataclass(frozen=True)
class HumidityCodes:
    """Integer codes of a hygrometer: relative humidity = zero + lsb * code.

    Parameters
    ----------
    lsb : float
        Step of one code [1]; 0.01 for whole percents.
    low, high : float
        Range that the firmware accepts [1].
    zero : float
        Relative humidity of code 0 [1].
    """

    lsb: float = 0.01
    low: float = 0.0
    high: float = 1.0
    zero: float = 0.0


Codes = TypeVar("Codes", EchoCodes, TemperatureCodes, HumidityCodes)


def codes_of(name: str, kind: type[Codes], wish: Any) -> Codes:
    """Return codes of a kind, which a tuple of numbers may stand for.

    Raises
    ------
    UsageError
        If it is neither.
    """
    try:
        codes = wish if isinstance(wish, kind) else kind(*map(float, wish))
        if all(isinstance(value, Real) for value in astuple(codes)):
            return codes
    except (TypeError, ValueError):
        pass
    order = ", ".join(field.name for field in fields(kind))
    message = f"{name} is {wish!r}; give {kind.__name__}({order}), or the numbers as a tuple"
    raise UsageError(message)
