"""What datasheets and standards state of thermometers, hygrometers, barometers and tapes: limits of error."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from echocal.arrays import Column


@dataclass(frozen=True)
class Limits:
    """Limits of error of an instrument: its error is within them, and nothing more is known.

    Examples
    --------
    >>> INSTRUMENTS["thermometer"]["DS18B20"].half_width([20.0, -20.0, 130.0]).tolist()
    [0.5, 2.0, nan]
    """

    name: str  # as people call the instrument
    quantity: str  # what it measures
    ranges: tuple[tuple[float, float, float], ...]
    """Lower end, upper end and half-width of the limits there [SI, temperatures in degC and K]; the first
    range that holds a value counts."""
    resolution: float  # step of its indication [SI]; 0 where it is not stated
    source: str  # where the limits are from

    def half_width(self, values: object) -> Column:
        """Half-width of the limits at some values [SI]; NaN outside of the ranges."""
        at = np.asarray(values, dtype=np.float64)
        found = np.full(at.shape, np.nan)
        for low, high, half in reversed(self.ranges):
            found = np.where((low <= at) & (at <= high), half, found)
        return found


def _thermometer(name: str, source: str, resolution: float, *ranges: tuple[float, float, float]) -> Limits:
    return Limits(name, "temperature", ranges, resolution, source)


def _hygrometer(
    name: str, half: float, resolution: float, source: str, *within: tuple[float, float, float]
) -> Limits:
    return Limits(name, "relative_humidity", (*within, (0.0, 1.0, half)), resolution, source)


_SHT3 = "Sensirion, Datasheet SHT3x-DIS, tables 1 and 2: typical accuracy"
# Seen of the SHT4x: page 1 of version 6 (February 2023), 0.1 K and 1 % of the SHT45; and the maker's
# figures as learn.adafruit.com/adafruit-sht40-temperature-humidity-sensor has them: typically 0.2 K (SHT45:
# 0.1 K) from 0 to 75 degC, 1.8 % (SHT45: 1 %) from 25 to 75 %, and up to 3 % (SHT40) or 2 % (SHT41) from 0
# to 100 %. Tables 1 and 2 of the datasheet were not seen, nor what the SHT45 has beyond 25 to 75 %.
_SHT4 = "Sensirion, Datasheet SHT4x, version 6: typical accuracy"
# Seen of the BME280: table 2 of BST-BME280-DS001-10 (revision 1.1, May 2015), 3 % from 20 to 80 % at 25
# degC; its page 2, by which it performs as the BMP280, which has 1 hPa from 0 to 65 degC by the README of
# the maker's BMP280_driver. Tables 3 and 4 were not seen: 1 K from 0 to 65 degC is what sellers tell, and
# the limits below 0 degC are not confirmed.
_BME = "Bosch, BME280 datasheet BST-BME280-DS001: absolute accuracy"
_BME_H = f"{_BME} (table 2: from 20 to 80 % at 25 °C)"
_BME_P = f"{_BME} (from 0 to 65 °C)"
_DHT = "Aosong, AM2302/DHT22 product manual: accuracy"
_DHT11 = "Aosong, DHT11 product manual: accuracy"
# The DC electrical characteristics of REV 042208 (page 19), and those of a later edition of 20 pages, have
# these two ranges. A range of 1 K from -30 to 100 degC was found in no edition.
_DS = "Maxim, DS18B20 datasheet, REV 042208, DC electrical characteristics: thermometer error"
_LM35 = "Texas Instruments, LM35 (SNIS159): limits over the rated range"
# Seen of the TMP36: page 1 of Rev. F, typically 1 K at 25 degC and 2 K over the rated range. The maximum of
# table 1 was not seen; the limits are twice what is typical.
_TMP36 = "Analog Devices, TMP35/36/37, Rev. F: twice the typical accuracy over the rated range"

INSTRUMENTS: Mapping[str, Mapping[str, Limits]] = {
    "thermometer": {
        one.name: one
        for one in (
            _thermometer("DHT22", _DHT, 0.1, (-40.0, 80.0, 0.5)),
            _thermometer("DHT11", _DHT11, 1.0, (0.0, 50.0, 2.0)),
            _thermometer("DS18B20", _DS, 0.0625, (-10.0, 85.0, 0.5), (-55.0, 125.0, 2.0)),
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
            _hygrometer("SHT40", 0.03, 1e-4, _SHT4, (0.25, 0.75, 0.018)),
            _hygrometer("SHT41", 0.02, 1e-4, _SHT4, (0.25, 0.75, 0.018)),
            _hygrometer("SHT45", 0.01, 1e-4, _SHT4),
            _hygrometer("BME280", 0.03, 8e-5, _BME_H),
        )
    },
    "barometer": {"BME280": Limits("BME280", "pressure", ((3e4, 11e4, 100.0),), 0.18, _BME_P)},
}
"""Limits by what the instrument is and by its name."""

TAPES: Mapping[str, tuple[float, float]] = {
    "I": (0.1e-3, 0.1e-3),
    "II": (0.3e-3, 0.2e-3),
    "III": (0.6e-3, 0.4e-3),
}
"""Maximum permissible error of tapes by class, a + b L: a [m] and b [m per m], L in whole meters, rounded up
(Directive 2014/32/EU, annex X, chapter I; OIML R 35-1:2007)."""
