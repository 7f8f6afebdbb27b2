"""What a user buys: thermometers and firmware, each as the log that it writes. Prices are assumptions."""

from dataclasses import dataclass

import numpy as np
import pandas as pd

import echocal
from compensation.world import EACH, REFERENCE, Column, Truth, Unit
from echocal.virtual_bench import air
from echocal.virtual_bench.campaign.campaign import Random
from echocal.virtual_bench.thermometers import following

SENSOR_EURO = 4.0
SENSOR_SOURCE = "2.27 to 7.20 $ in three catalogues, listed at flux.ai/vasy_skral/hc-sr04~afv"
SHIELD_EURO = 4.0

_MICRO, _PERCENT = 1e6, 100.0
_ADC_STEPS, _ADC_VOLTS, _VOLTS_PER_KELVIN = 1024, 5.0, 0.01
_REFERENCE_ERROR = 0.01  # of the 5 V that the USB port gives: assumed
_SUNNY, _SHIELDED = 8.0, 2.5  # K per kW/m2 in still air


@dataclass(frozen=True)
class Thermometer:
    """A thermometer and what comes with it.

    Attributes
    ----------
    label : str
    euro : float
        Price without the HC-SR04 and the board.
    source : str
        Of the price and of the errors.
    offset, gain : float
        Standard deviations of the error at 25 degC [K] and of the error of the scale.
    step : float
        Of the reading [K].
    lag : float
        Median time constant [s].
    sun : float
        What a radiation of 1 kW/m2 adds in still air [K].
    humidity : float
        Standard deviation of the error of the relative humidity; 0: it has none.
    pressure : float
        The same of the pressure [Pa]; 0: it has none.
    volts : float or None
        Output at 0 degC of an analog part that the board's converter reads [V].
    kind : str
        "air", or where the temperature comes from else: "none", "hand", "path".
    """

    label: str
    euro: float
    source: str
    offset: float = 0.0
    gain: float = 0.0
    step: float = 0.0
    lag: float = 90.0
    sun: float = _SUNNY
    humidity: float = 0.0
    pressure: float = 0.0
    volts: float | None = None
    kind: str = "air"


_MAGAZINE = "price: Linux Magazine 279 (2024), Sensor Shootout; errors: data sheet"
_HTU = {"offset": 0.2, "gain": 2e-3, "step": 0.01, "lag": 60.0, "humidity": 0.02}
THERMOMETERS = {
    "none": Thermometer("none: 343 m/s", 0.0, "", kind="none"),
    "hand": Thermometer("potentiometer, set once by hand", 0.5, "assumed", offset=1.0, kind="hand"),
    "lm35": Thermometer(
        "LM35, 10 bits", 2.0, "price assumed; errors: data sheet", offset=0.5, gain=5e-3, volts=0.0
    ),
    "tmp36": Thermometer(
        "TMP36, 10 bits", 2.0, "price assumed; errors: data sheet", offset=1.0, gain=5e-3, volts=0.5
    ),
    "ds18b20": Thermometer(
        "DS18B20", 3.6, "price: z-wave.pt; errors: data sheet", offset=0.25, gain=3e-3, step=0.0625
    ),
    "dht22": Thermometer(
        "DHT22",
        4.2,
        "price of the AM2320: Linux Magazine 279 (2024), Sensor Shootout; errors: data sheet",
        offset=0.4,
        gain=3e-3,
        step=0.1,
        lag=180.0,
        humidity=0.03,
    ),
    "bme280": Thermometer(
        "BME280", 5.6, _MAGAZINE, offset=0.7, gain=5e-3, step=0.01, lag=120.0, humidity=0.03, pressure=100.0
    ),
    "htu31d": Thermometer("HTU31D", 7.1, _MAGAZINE, **_HTU),
    "shield": Thermometer(
        "HTU31D in a home-made shield",
        7.1 + SHIELD_EURO,
        _MAGAZINE + "; shield 4 $: Tarara & Hoheisel 2007",
        **_HTU | {"sun": _SHIELDED, "lag": 120.0},
    ),
    "path": Thermometer(
        "second HC-SR04, plate at 1 m", SENSOR_EURO + 2.0, "as the HC-SR04, plate assumed", kind="path"
    ),
}
FIRMWARE = {
    "capture": "timer capture, 0.5 us",
    "pulse_in": "`pulseIn()`",
    "whole_cm": "`pulseIn() / 58`, whole centimeters",
}


@dataclass(frozen=True)
class Device:
    """A device that was set up at the beginning of a campaign.

    Attributes
    ----------
    unit : Unit
    random : Random
        Of the device: its thermometer has the same errors in every campaign.
    first : Truth
        The campaign in which it was set up.
    """

    unit: Unit
    random: Random
    first: Truth

    def log(self, truth: Truth, name: str, firmware: str = "capture", *, ideal: bool = False) -> pd.DataFrame:
        """Write the log of a campaign: what methods may see, and the reference distance."""
        chosen, wrong = THERMOMETERS[name], self._errors(name)
        pulse = self._clocked(truth, truth.ideal if ideal else truth.pulse)
        columns = {"time_s": np.round(truth.seconds, 2), "echo_us": self._counted(pulse, firmware)}
        recorded = self._temperature(truth, name)
        if recorded is not None:
            columns["temperature_C"] = recorded
        if chosen.humidity and recorded is not None:  # the vapor is that of the air, the warmth the sensor's
            vapor = truth.humidity * air.saturation_pressure(truth.temperature)
            local = vapor / air.saturation_pressure(recorded) + chosen.humidity * wrong[2]
            columns["humidity_percent"] = np.round(_PERCENT * np.clip(local, 0.0, 1.0), 1)
        if chosen.pressure:
            columns["pressure_hPa"] = np.round(0.01 * (truth.pressure + chosen.pressure * wrong[3]), 1)
        return pd.DataFrame(columns | {"distance_m": truth.tape, "stand": 1 + truth.placement})

    def _errors(self, name: str) -> Column:
        return self.random(f"device {name}").normal(size=6)

    def _clocked(self, truth: Truth, pulse: Column) -> Column:
        """Length of a pulse [us] by the board's own clock."""
        return _MICRO * pulse * (1 + self.unit.clock + self.unit.clock_drift * (truth.temperature - 25.0))

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

    def _temperature(self, truth: Truth, name: str) -> Column | None:
        """Return the temperature that the log has [degC]; None without a thermometer."""
        chosen, wrong = THERMOMETERS[name], self._errors(name)
        if chosen.kind == "none":
            return None
        if chosen.kind == "hand":
            set_up = np.round(self.first.temperature[0] + chosen.offset * wrong[0], 1)
            return np.full(len(truth.seconds), set_up)
        if chosen.kind == "path":
            return self._sonic(truth)
        warmed = truth.temperature + chosen.sun * 1e-3 * truth.radiation / (1 + truth.wind)
        slow = following(warmed, truth.seconds, chosen.lag * np.exp(0.3 * wrong[4]))
        read = slow + chosen.offset * wrong[0] + chosen.gain * wrong[1] * (slow - 25.0)
        if chosen.volts is None:
            return np.round(np.round(read / chosen.step) * chosen.step, 4)
        volts = (chosen.volts + _VOLTS_PER_KELVIN * read) / (1 + _REFERENCE_ERROR * wrong[5])
        codes = np.floor(np.maximum(volts, 0.0) / _ADC_VOLTS * _ADC_STEPS)
        return np.round((codes / _ADC_STEPS * _ADC_VOLTS - chosen.volts) / _VOLTS_PER_KELVIN, 2)

    def _sonic(self, truth: Truth) -> Column:
        """Temperature from the echo of a plate at a known distance, at a humidity of 50 %.

        Its delay was set once, beside a household thermometer that errs by half a kelvin.
        """
        grid = np.linspace(-60.0, 80.0, 561)
        times = _MICRO * 2 * REFERENCE / np.asarray(echocal.speed_of_sound(grid, relative_humidity=0.5))
        begun = np.median(self._echoes(self.first)[: 2 * EACH])
        delay = begun - np.interp(self.first.temperature[0] + 0.5 * self._errors("path")[0], grid, times)
        burst = pd.Series(self._echoes(truth)).groupby(truth.burst)
        measured = burst.transform("median").to_numpy() - delay
        return np.round(np.interp(measured, times[::-1], grid[::-1]), 2)

    def _echoes(self, truth: Truth) -> Column:
        return self._counted(self._clocked(truth, truth.second), "capture")
