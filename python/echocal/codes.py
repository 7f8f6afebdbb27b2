"""What a device measures, as integers: ticks of a timer, codes of a thermometer and of a hygrometer."""

from dataclasses import dataclass

__all__ = ["EchoCodes", "HumidityCodes", "TemperatureCodes"]


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
