"""Codes of known thermometers and hygrometers, as their datasheets publish them."""

from collections.abc import Mapping
from dataclasses import dataclass

from echocal.codes import HumidityCodes, TemperatureCodes
from echocal.errors import UsageError

__all__ = ["SENSORS", "Sensor", "sensor_of"]


@dataclass(frozen=True)
class Sensor:
    """A part, and what its codes stand for.

    Attributes
    ----------
    temperature : TemperatureCodes
        Codes of its thermometer [degC].
    humidity : HumidityCodes or None
        Codes of its hygrometer [1]; None if it has none.
    source : str
        Where the formulas are published.
    note : str
        What the codes are, where a driver has to make them.
    """

    temperature: TemperatureCodes
    humidity: HumidityCodes | None
    source: str
    note: str = ""


# Bits are dropped where all combinations of the codes would be too many to prove. The steps that are left,
# 0.04 to 0.05 degC and 0.4 to 0.5 %, are a quarter or less of the sensors' own limits of error.
_SHT_T = TemperatureCodes(175 / 65_535, -20.0, 60.0, -45.0, 4)
_HTU_T = TemperatureCodes(175.72 / 65_536, -20.0, 60.0, -46.85, 4)
_HTU_H = HumidityCodes(1.25 / 65_536, 0.0, 1.0, -0.06, 8)
_CROP = "above 100 % the codes go on: pass at most the last accepted humidity code"
_SIGNED = "two's complement: the sensor sends a sign and a magnitude, which drivers convert"

SENSORS: Mapping[str, Sensor] = {
    "AHT20": Sensor(
        TemperatureCodes(200 / 2**20, -20.0, 60.0, -50.0, 8),
        HumidityCodes(1 / 2**20, 0.0, 1.0, 0.0, 12),
        "Aosong, AHT20 product manual, section 6: signal conversion",
        "the 20 bits of each reading, in a uint32_t",
    ),
    "BME280": Sensor(
        TemperatureCodes(0.01, -20.0, 60.0),
        HumidityCodes(0.01 / 1024, 0.0, 1.0, 0.0, 9),
        "Bosch, BST-BME280-DS001, section 4.2.3: compensation formulas",
        "what the compensation formulas of the maker return: 0.01 degC, and 1/1024 %, which is 102,400 in "
        "saturated air: pass at most the last accepted humidity code",
    ),
    "DHT11": Sensor(
        TemperatureCodes(1.0, 0.0, 50.0),
        HumidityCodes(0.01, 0.2, 0.9),
        "Aosong, DHT11 product manual, section 5",
    ),
    "DHT22": Sensor(
        TemperatureCodes(0.1, -20.0, 60.0),
        HumidityCodes(0.001, 0.0, 1.0),
        "Aosong, AM2302 product manual, section 7",
        _SIGNED,
    ),
    "DS18B20": Sensor(TemperatureCodes(), None, "Maxim, DS18B20 datasheet 19-7487, table 1"),
    "HTU21D": Sensor(
        _HTU_T, _HTU_H, "TE Connectivity, HTU21D datasheet HPC199_6, conversion of signals", _CROP
    ),
    "SHT3X": Sensor(
        _SHT_T,
        HumidityCodes(1 / 65_535, 0.0, 1.0, 0.0, 8),
        "Sensirion, Datasheet SHT3x-DIS, section 4.13",
    ),
    "SHT4X": Sensor(
        _SHT_T,
        HumidityCodes(1.25 / 65_535, 0.0, 1.0, -0.06, 8),
        "Sensirion, Datasheet SHT4x, section 4.6",
        _CROP,
    ),
    "SI7021": Sensor(_HTU_T, _HTU_H, "Silicon Labs, Si7021-A20 datasheet, sections 5.1.1 and 5.1.2", _CROP),
    "TMP117": Sensor(
        TemperatureCodes(0.0078125, -20.0, 60.0),
        None,
        "Texas Instruments, TMP117, SNOSD82, section 7.6",
    ),
}
"""Sensors by name."""

_ALSO = {"AM2302": "DHT22", "SHT30": "SHT3X", "SHT31": "SHT3X", "SHT35": "SHT3X"}
_ALSO |= {"SHT40": "SHT4X", "SHT41": "SHT4X", "SHT45": "SHT4X"}


def sensor_of(name: str) -> Sensor:
    """Return the codes of a part.

    Parameters
    ----------
    name : str
        Its name, in any case: a key of `SENSORS`, or a part of one of these families such as ``"SHT31"``.

    Returns
    -------
    Sensor
        Its codes.

    Raises
    ------
    UsageError
        If the name is not known.

    Examples
    --------
    >>> sensor_of("sht31").temperature.zero
    -45.0
    """
    key = name.upper()
    found = SENSORS.get(_ALSO.get(key, key))
    if found is None:
        known = ", ".join(sorted({*SENSORS, *_ALSO}))
        raise UsageError(
            f"no codes of a sensor '{name}' are known; known are {known}. Give the steps of its codes"
        )
    return found
