"""What a user buys: parts of the bench and firmware, each as the log that it writes. Prices are assumed."""

from dataclasses import dataclass, replace

import numpy as np
import pandas as pd

import echocal
from compensation.world import EACH, REFERENCE, Column, Truth, Unit
from echocal.virtual_bench import air
from echocal.virtual_bench.campaign.campaign import Random
from echocal.virtual_bench.instruments import HIH4030, PARTS, AnalogThermometer, Thermometer

SENSOR_EURO = 4.0
SENSOR_SOURCE = "2.27 to 7.20 $ in three catalogues, listed at flux.ai/vasy_skral/hc-sr04~afv"
SHIELD_EURO = 4.0

_MICRO, _PERCENT = 1e6, 100.0
_CODES, _VOLTS = 1024, 5.0  # of the board's converter, which compares with its own supply
_SUPPLY_ERROR = 0.01  # of the 5 V that the USB port gives: assumed
_BY_HAND = 1.0  # K, standard deviation: how well somebody reads a household thermometer; assumed
_SET_UP = 0.5  # K, the same of the thermometer beside which the path of the second sensor is set up; assumed
_SHIELDED = 2.4  # K at 1000 W/m2, middle of 1.9 to 2.8 K: Teichmann et al. 2024, doi:10.3390/s24051564


@dataclass(frozen=True)
class Bought:
    """What is bought beside the HC-SR04 and the board."""

    label: str
    euro: float
    source: str = ""  # of the price
    part: Thermometer | None = None  # of the bench
    humidity: float | None = None  # standard deviation of the error of its own humidity, where it has one
    hygrometer: bool = False  # whether a HIH-4030 is on another input of the converter


_DHT22 = replace(PARTS["dht22"], late_readings=0)  # each time it is read twice, and the first is thrown away
_SHIELDED_DHT22 = replace(_DHT22, sun=_SHIELDED, time_constant=2 * _DHT22.time_constant)
_DHT22_PRICE = "that of the AM2320 in Linux Magazine 279 (2024), Sensor Shootout"
_DHT22_HUMIDITY = 0.025  # AM2302 data sheet (Aosong): 2 % RH, 5 % at most; half of the latter
THERMOMETERS = {
    "none": Bought("none: 343 m/s", 0.0),
    "hand": Bought("potentiometer, set once by hand", 0.5, "assumed", PARTS["potentiometer"]),
    "lm35": Bought("LM35, 10 bits", 2.0, "assumed", PARTS["lm35"]),
    "tmp36": Bought("TMP36, 10 bits", 2.0, "assumed", PARTS["tmp36"]),
    "ds18b20": Bought("DS18B20", 3.6, "z-wave.pt", PARTS["ds18b20"]),
    "dht22": Bought("DHT22", 4.2, _DHT22_PRICE, _DHT22, _DHT22_HUMIDITY),
    "path": Bought("second HC-SR04, plate at 1 m", SENSOR_EURO + 2.0, "as the HC-SR04, plate assumed"),
    "shield": Bought(
        "DHT22 in a home-made shield",
        4.2 + SHIELD_EURO,
        _DHT22_PRICE + "; shield 4 $: Tarara & Hoheisel 2007, HortScience 42, 1372",
        _SHIELDED_DHT22,
        _DHT22_HUMIDITY,
    ),
    "hih4030": Bought("DS18B20 and HIH-4030", 3.6 + 15.0, "z-wave.pt, assumed", PARTS["ds18b20"], None, True),
}
FIRMWARE = {
    "capture": "timer capture, 0.5 us",
    "pulse_in": "`pulseIn()`",
    "whole_cm": "`pulseIn() / 58`, whole centimeters",
}


@dataclass(frozen=True)
class Device:
    """A device; its parts have the same errors in every campaign."""

    unit: Unit
    random: Random
    first: Truth  # the campaign in which it was set up

    def log(self, truth: Truth, name: str, firmware: str = "capture", *, ideal: bool = False) -> pd.DataFrame:
        """Write the log of a campaign: what methods may see, and the reference distance."""
        pulse = self._clocked(truth, truth.ideal if ideal else truth.pulse)
        columns = {"time_s": np.round(truth.seconds, 2), "echo_us": self._counted(pulse, firmware)}
        if name == "path":
            columns["temperature_C"] = self._sonic(truth)
        elif THERMOMETERS[name].part is not None:
            columns |= self._recorded(truth, name)
        return pd.DataFrame(columns | {"distance_m": truth.tape, "stand": 1 + truth.placement})

    def _clocked(self, truth: Truth, pulse: Column) -> Column:
        """Length of a pulse [us] by the board's own clock."""
        warm = truth.around.temperature - 25.0
        return _MICRO * pulse * (1 + self.unit.clock + self.unit.clock_drift * warm)

    def _counted(self, pulse: Column, firmware: str) -> Column:
        """Count a pulse [us] as a firmware does.

        `pulseIn()` of Arduino loses 5.98 us to each interrupt of the timer that counts milliseconds, one
        every 1024 us: measured with the Arduino core on the emulated UNO.
        """
        if firmware == "capture":
            return np.floor(2 * pulse) / 2
        begun = self.random(f"interrupts {len(pulse)}").uniform(size=len(pulse))
        looped = np.floor(pulse - 5.98 * np.floor(pulse / 1024.0 + begun))
        return looped if firmware == "pulse_in" else 58.0 * np.floor(looped / 58.0)

    def _recorded(self, truth: Truth, name: str) -> dict[str, Column]:
        """Return temperature [degC] and humidity [%] as the log has them."""
        bought, own, around = THERMOMETERS[name], self.random(f"parts {name}"), truth.around
        part = bought.part.drawn(own)  # type: ignore[union-attr]
        hygrometer, supply, wrong = HIH4030.drawn(own), 1 + _SUPPLY_ERROR * own.normal(), own.normal()
        if name == "hand":
            set_to = np.round(self.first.around.temperature[0] + _BY_HAND * wrong, 1)
            return {"temperature_C": np.full(len(truth.seconds), set_to)}
        noise = self.random(f"noise {name} {len(truth.seconds)}")
        sky = {"time": truth.seconds, "radiation": around.radiation}
        read = part.record(around.temperature, **sky, random=noise)
        if isinstance(part, AnalogThermometer):
            volts = _VOLTS * _coded(part.voltage(read, _VOLTS * supply) / (_VOLTS * supply))
            read = np.round((volts - part.at_zero) / part.slope, 2)
        found = {"temperature_C": np.round(read, 4)}
        body = part.body(around.temperature, **sky)  # the vapor is that of the air, the warmth the part's
        vapor = around.relative_humidity * air.saturation_pressure(around.temperature)
        local = np.clip(vapor / air.saturation_pressure(body), 0.0, 1.0)
        if bought.humidity is not None:
            found["humidity_percent"] = np.round(_PERCENT * np.clip(local + bought.humidity * wrong, 0, 1), 1)
        if bought.hygrometer:
            shown = (_coded(hygrometer.voltage(local, body) / _VOLTS) - hygrometer.at_zero) / hygrometer.slope
            known = shown / (hygrometer.sensitivity + hygrometer.sensitivity_slope * read)
            found["humidity_percent"] = np.round(_PERCENT * np.clip(known, 0.0, 1.0), 1)
        return found

    def _sonic(self, truth: Truth) -> Column:
        """Temperature from the echo of a plate at a known distance, at a humidity of 50 %.

        Its delay was set once, beside a household thermometer.
        """
        grid = np.linspace(-60.0, 80.0, 561)
        times = _MICRO * 2 * REFERENCE / np.asarray(echocal.speed_of_sound(grid, relative_humidity=0.5))
        begun, wrong = np.median(self._echoes(self.first)[: 2 * EACH]), self.random("path").normal()
        delay = begun - np.interp(self.first.around.temperature[0] + _SET_UP * wrong, grid, times)
        burst = pd.Series(self._echoes(truth)).groupby(truth.burst)
        measured = burst.transform("median").to_numpy() - delay
        return np.round(np.interp(measured, times[::-1], grid[::-1]), 2)

    def _echoes(self, truth: Truth) -> Column:
        return self._counted(self._clocked(truth, truth.second), "capture")


def _coded(share: Column) -> Column:
    """Convert a voltage, as a share of the supply, to what its code stands for."""
    return np.floor(np.clip(share, 0.0, 1.0 - 1.0 / _CODES) * _CODES) / _CODES
