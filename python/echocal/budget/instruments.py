"""What datasheets and standards state of thermometers, hygrometers, barometers and tapes: limits of error."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

__all__ = ["INSTRUMENTS", "TAPES", "Limits"]

Column = NDArray[np.float64]


@dataclass(frozen=True)
class Limits:
    """Limits of error of an instrument: its error is within them, and nothing more is known.

    Attributes
    ----------
    name : str
        As people call the instrument.
    quantity : str
        What it measures.
    ranges : tuple of (float, float, float)
        Lower end, upper end and half-width of the limits there [SI, temperatures in degC and K]; the first
        range that holds a value counts.
    resolution : float
        Step of its indication [SI]; 0 where it is not stated.
    source : str
        Where the limits are from.

    Examples
    --------
    >>> INSTRUMENTS["thermometer"]["DS18B20"].half_width([20.0, -20.0, -40.0]).tolist()
    [0.5, 1.0, 2.0]
    """

    name: str
    quantity: str
    ranges: tuple[tuple[float, float, float], ...]
    resolution: float
    source: str

    def half_width(self, values: object) -> Column:
        """Half-width of the limits at some values [SI]; NaN outside of the ranges."""
        at = np.asarray(values, dtype=np.float64)
        found = np.full(at.shape, np.nan)
        for low, high, half in reversed(self.ranges):
            found = np.where((low <= at) & (at <= high), half, found)
        return found


def _thermometer(name: str, source: str, resolution: float, *ranges: tuple[float, float, float]) -> Limits:
    return Limits(name, "temperature", ranges, resolution, source)


def _hygrometer(name: str, half: float, resolution: float, source: str) -> Limits:
    return Limits(name, "relative_humidity", ((0.0, 1.0, half),), resolution, source)


_SHT3 = "Sensirion, Datasheet SHT3x-DIS, tables 1 and 2: typical accuracy"
_SHT4 = "Sensirion, Datasheet SHT4x, tables 1 and 2: typical accuracy"
_BME = "Bosch, BME280 datasheet BST-BME280-DS002, tables 2 to 4: absolute accuracy"
_DHT = "Aosong, AM2302/DHT22 product manual: accuracy"
_DHT11 = "Aosong, DHT11 product manual: accuracy"
_DS = "Maxim, DS18B20 datasheet (19-7487, revision 6): thermometer error"
_LM35 = "Texas Instruments, LM35 (SNIS159): limits over the rated range"
_TMP36 = "Analog Devices, TMP35/36/37, grade G: maximum over the rated range"

INSTRUMENTS: Mapping[str, Mapping[str, Limits]] = {
    "thermometer": {
        one.name: one
        for one in (
            _thermometer("DHT22", _DHT, 0.1, (-40.0, 80.0, 0.5)),
            _thermometer("DHT11", _DHT11, 1.0, (0.0, 50.0, 2.0)),
            _thermometer(
                "DS18B20", _DS, 0.0625, (-10.0, 85.0, 0.5), (-30.0, 100.0, 1.0), (-55.0, 125.0, 2.0)
            ),
            _thermometer("LM35", _LM35, 0.0, (-55.0, 150.0, 1.5)),
            _thermometer("LM35A", _LM35, 0.0, (-55.0, 150.0, 1.0)),
            _thermometer("LM35D", _LM35, 0.0, (0.0, 100.0, 2.0)),
            _thermometer("TMP36", _TMP36, 0.0, (-40.0, 125.0, 4.0)),
            _thermometer("SHT31", _SHT3, 0.01, (0.0, 90.0, 0.2)),
            _thermometer("SHT40", _SHT4, 0.01, (0.0, 60.0, 0.2)),
            _thermometer("SHT41", _SHT4, 0.01, (0.0, 60.0, 0.2)),
            _thermometer("SHT45", _SHT4, 0.01, (0.0, 60.0, 0.1)),
            _thermometer("BME280", _BME, 0.01, (0.0, 65.0, 1.0), (-20.0, 0.0, 1.25), (-40.0, -20.0, 1.5)),
        )
    },
    "hygrometer": {
        one.name: one
        for one in (
            _hygrometer("DHT22", 0.05, 1e-3, _DHT + " (2 % typical, 5 % at most)"),
            _hygrometer("DHT11", 0.05, 0.01, _DHT11),
            _hygrometer("SHT31", 0.02, 1e-4, _SHT3),
            _hygrometer("SHT40", 0.018, 1e-4, _SHT4),
            _hygrometer("SHT41", 0.018, 1e-4, _SHT4),
            _hygrometer("SHT45", 0.01, 1e-4, _SHT4),
            _hygrometer("BME280", 0.03, 8e-5, _BME),
        )
    },
    "barometer": {"BME280": Limits("BME280", "pressure", ((3e4, 11e4, 100.0),), 0.18, _BME)},
}
"""Limits by what the instrument is and by its name."""

TAPES: Mapping[str, tuple[float, float]] = {
    "I": (0.1e-3, 0.1e-3),
    "II": (0.3e-3, 0.2e-3),
    "III": (0.6e-3, 0.4e-3),
}
"""Maximum permissible error of tapes by class, a + b L: a [m] and b [m per m], L in whole meters, rounded up
(Directive 2014/32/EU, annex X, chapter I; OIML R 35-1:2007)."""
