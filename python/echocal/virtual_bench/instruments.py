"""Thermometers and hygrometers of the bench: from the air to what is recorded.

A body follows the air with one time constant. Its own current and the sun warm it. Its reading has
the offset and the gain of one part, noise and steps. Numbers of a part that its data sheet does not give are
marked as taken from another part or as set by hand.
"""

from dataclasses import dataclass, replace
from typing import Self

import numpy as np
from numpy.typing import ArrayLike, NDArray

from echocal.errors import UsageError

Column = NDArray[np.float64]

_FULL_SUN = 1000.0  # W/m2
_TO92 = 60.0
"""Time constant in still air [s]: SMT160-30 data sheet, TO-18, 60 s (13.5 s at 3 m/s). The data sheets of the
parts in the similar TO-92 give it only as a drawing."""
_BARE_SUN = 5.0
"""Warming in full sun [K], without a screen; 1 to 10 K in Nakamura and Mahrt 2005, J. Atmos. Oceanic Technol.
22, 1046, doi:10.1175/JTECH1762.1. Within an unventilated screen 1.9 to 2.8 K: Teichmann et al. 2024,
Sensors 24, 1564, doi:10.3390/s24051564."""


@dataclass(frozen=True)
class Thermometer:
    """A thermometer, as one part of its kind."""

    name: str
    """Its kind."""
    tolerance: float = 0.0
    """Standard deviation of the offsets of parts at 25 degC [K]; half of the data sheet's limit."""
    gain_tolerance: float = 0.0
    """Standard deviation of the gains of parts [1]."""
    step: float = 0.0
    """Step of the record [K]; 0 for none."""
    noise: float = 0.0
    """Standard deviation of a reading [K]."""
    time_constant: float = 0.0
    """Of the body in the air [s]; 0 for a body that follows at once."""
    self_heating: float = 0.0
    """Warming by its own current [K]."""
    sun: float = 0.0
    """Warming at 1000 W/m2 [K]."""
    late_readings: int = 0
    # low, high: range [degC]; a record stays within it
    """Readings by which the record is late."""
    low: float = -273.15
    high: float = 1000.0
    offset: float = 0.0
    """Offset of this part at 25 degC [K]."""
    gain: float = 1.0
    """Gain of this part [1]."""

    def drawn(self, random: np.random.Generator) -> Self:
        """Return one part of this kind, with an offset and a gain within its tolerances."""
        offset, gain = random.normal(0.0, (self.tolerance, self.gain_tolerance))
        return replace(self, offset=float(offset), gain=1.0 + float(gain))

    def ideal(self) -> Self:
        """Return a part without noise, lag, heating, offset and gain; its steps stay."""
        slow = replace(self, noise=0.0, self_heating=0.0, sun=0.0, late_readings=0)
        return replace(slow, time_constant=0.0, offset=0.0, gain=1.0)

    def body(
        self, temperature: ArrayLike, time: ArrayLike | None = None, *, radiation: ArrayLike = 0.0
    ) -> Column:
        """Temperature of the body [degC]; parameters as in `record`."""
        air = np.atleast_1d(np.asarray(temperature, dtype=np.float64))
        warmed = air + self.self_heating + self.sun * np.asarray(radiation, dtype=np.float64) / _FULL_SUN
        if time is None or self.time_constant == 0.0:
            return warmed
        return following(warmed, _seconds(time, warmed.shape), self.time_constant)

    def record(
        self,
        temperature: ArrayLike,
        time: ArrayLike | None = None,
        *,
        radiation: ArrayLike = 0.0,
        random: np.random.Generator | None = None,
    ) -> Column:
        """What is recorded.

        Raises `UsageError` if shapes differ or times do not ascend.

        Parameters
        ----------
        temperature : array_like, shape (n,)
            Temperature of the air [degC].
        time : array_like, shape (n,), optional
            Times of the readings [s], ascending; default: so far apart that the body has the air's
            temperature. It is in balance at the first.
        radiation : array_like, shape (n,) or ()
            Irradiance of the sun [W/m2].
        random : numpy.random.Generator, optional
            Draws the noise; default: no noise.

        Returns
        -------
        ndarray, shape (n,)
            Temperature [degC].

        Examples
        --------
        >>> TMP36.ideal().record([21.3, 40.0])
        array([21.3, 40. ])
        >>> DHT22.ideal().record(21.34)
        array([21.3])
        >>> DS18B20.record([20.0, 30.0, 30.0], [0.0, 1.0, 61.0])
        array([20.0625, 20.125 , 26.375 ])
        """
        known = self.body(temperature, time, radiation=radiation)
        known = 25.0 + self.offset + self.gain * (known - 25.0)
        if random is not None:
            known = known + random.normal(0.0, self.noise, known.shape)
        if self.step:
            known = self.step * np.round(known / self.step)
        late = min(self.late_readings, len(known) - 1)
        known = np.concatenate([known[:1].repeat(late), known[: len(known) - late]])
        return np.asarray(np.clip(known, self.low, self.high))


@dataclass(frozen=True)
class AnalogThermometer(Thermometer):
    """A thermometer with a voltage at its output."""

    slope: float = 0.01  # volts in a kelvin [V/K]
    at_zero: float = 0.0  # voltage at 0 degC [V]
    ratiometric: bool = False
    """Whether the voltage is proportional to the supply; `slope` and `at_zero` then hold at 5 V."""

    def voltage(self, recorded: ArrayLike, supply: float = 5.0) -> Column:
        """Voltage at the output [V] for what `record` gives [degC], at a supply [V].

        Examples
        --------
        >>> float(TMP36.voltage(25.0))
        0.75
        >>> float(POTENTIOMETER.voltage(25.0, supply=4.8))
        2.4
        """
        volts = self.at_zero + self.slope * np.asarray(recorded, dtype=np.float64)
        return np.asarray(np.clip(volts * (supply / 5.0 if self.ratiometric else 1.0), 0.0, supply))


def following(air: Column, seconds: Column, time_constant: float) -> Column:
    """Temperature of a body that follows the air, which is linear between the rows.

    The exact solution of dB/dt = (A - B) / tau for a ramp, from balance at the first row.
    """
    body = [float(air[0])]
    for before, after, step in zip(
        air[:-1].tolist(), air[1:].tolist(), np.diff(seconds).tolist(), strict=True
    ):
        lag = (after - before) / step * time_constant if step > 0.0 else 0.0
        gone = np.exp(-step / time_constant)
        body.append(after - lag + (body[-1] - before + lag) * gone if step > 0.0 else body[-1])
    return np.asarray(body)


def _seconds(time: ArrayLike, shape: tuple[int, ...]) -> Column:
    seconds = np.atleast_1d(np.asarray(time, dtype=np.float64))
    if seconds.shape != shape or seconds.ndim != 1:
        message = f"time has shape {seconds.shape} and temperature {shape}: one time for each temperature"
        raise UsageError(message)
    gaps = np.flatnonzero(~np.isfinite(seconds))
    if len(gaps):
        message = f"time has no value in row {gaps[0] + 1}: one that lags needs the time of each reading"
        raise UsageError(message)
    falls = np.flatnonzero(np.diff(seconds) < 0.0)
    if len(falls):
        row = int(falls[0])
        raise UsageError(
            f"time falls from {seconds[row]:g} s to {seconds[row + 1]:g} s (row {row + 2}): it must ascend"
        )
    return seconds


TMP36 = AnalogThermometer(
    "TMP36",
    tolerance=1.0,  # TMP35/36/37 data sheet Rev. H, F grade: 1 K typical, 2 K at most at 25 degC
    gain_tolerance=0.005,  # the same: 2 K typical over -40 to 125 degC
    time_constant=_TO92,
    self_heating=0.04,  # the same: 50 uA at 5 V and 162 K/W in TO-92
    sun=_BARE_SUN,
    low=-40.0,
    high=125.0,
    slope=0.01,
    at_zero=0.5,
)
"""Analog Devices TMP36 in TO-92: 10 mV/K, 750 mV at 25 degC."""

LM35 = AnalogThermometer(
    "LM35",
    tolerance=0.75,  # LM35 data sheet SNIS159H, LM35D: 0.6 K typical, 1.5 K at most at 25 degC
    gain_tolerance=0.01,  # the same: 9.8 to 10.2 mV/K
    time_constant=_TO92,
    self_heating=0.08,  # the same, in still air
    sun=_BARE_SUN,
    low=2.0,  # the same: with one supply
    high=100.0,
    slope=0.01,
)
"""Texas Instruments LM35D in TO-92 with one supply: 10 mV/K, 2 degC or more."""

POTENTIOMETER = AnalogThermometer("potentiometer", low=0.0, high=50.0, slope=0.1, ratiometric=True)
"""A potentiometer that stands for 0 to 50 degC, as in the study. It follows what somebody sets it to."""

DHT22 = Thermometer(
    "DHT22",
    tolerance=0.25,  # AM2302 data sheet (Aosong): 0.5 K
    step=0.1,  # the same
    noise=0.1,  # the same: repeatability 0.2 K, taken for two standard deviations
    time_constant=120.0,  # set by hand: the housing holds more than a TO-92
    self_heating=0.1,  # set by hand: 1.5 mA at 5 V while it measures
    sun=_BARE_SUN,
    late_readings=1,  # AM2302 manual: a reading gives the result of the measurement before
    low=-40.0,
    high=80.0,
)
"""Aosong DHT22 (AM2302)."""

DS18B20 = Thermometer(
    "DS18B20",
    tolerance=0.25,  # DS18B20 data sheet 19-7487: 0.5 K from -10 to 85 degC
    step=0.0625,  # the same, 12 bits
    noise=0.03,  # set by hand: half a step
    time_constant=_TO92,
    self_heating=0.05,  # set by hand: 1 mA at 5 V during conversions of 0.75 s, one in several seconds
    sun=_BARE_SUN,
    low=-55.0,
    high=125.0,
)
"""Maxim DS18B20 in TO-92, 12 bits."""

PARTS = {part.name.lower(): part for part in (TMP36, LM35, POTENTIOMETER, DHT22, DS18B20)}
"""Thermometers by name in small letters."""


@dataclass(frozen=True)
class AnalogHygrometer:
    """A hygrometer with a voltage that is proportional to its supply."""

    name: str  # its kind
    # at_zero, slope: voltage as a share of the supply: at 0, and per unit of relative humidity, at 25 degC
    # [1]
    at_zero: float
    slope: float
    # sensitivity, sensitivity_slope: what it shows is the relative humidity times ``sensitivity +
    # sensitivity_slope * temperature`` [1], [1/degC]
    sensitivity: float = 1.0
    sensitivity_slope: float = 0.0
    tolerance: float = 0.0  # standard deviation of the offsets of parts [1]; half of the data sheet's limit
    offset: float = 0.0  # offset of this part [1]

    def drawn(self, random: np.random.Generator) -> "AnalogHygrometer":
        """Return one part of this kind."""
        return replace(self, offset=float(random.normal(0.0, self.tolerance)))

    def voltage(self, relative_humidity: ArrayLike, temperature: ArrayLike, supply: float = 5.0) -> Column:
        """Voltage at the output [V]: air of a relative humidity [1] and a temperature [degC], a supply [V].

        Examples
        --------
        >>> round(float(HIH4030.voltage(0.5, 25.0)), 3)
        2.351
        """
        warm = np.asarray(temperature, dtype=np.float64)
        shown = (
            np.asarray(relative_humidity) * (self.sensitivity + self.sensitivity_slope * warm) + self.offset
        )
        return np.asarray(np.clip(supply * (self.at_zero + self.slope * shown), 0.0, supply))


HIH4030 = AnalogHygrometer(
    "HIH-4030",
    at_zero=0.16,  # HIH-4030/31 data sheet 009021-5 (Honeywell): V = supply (0.0062 RH/% + 0.16) at 25 degC
    slope=0.62,
    sensitivity=1.0546,  # the same: true RH = RH / (1.0546 - 0.00216 T)
    sensitivity_slope=-0.00216,
    tolerance=0.0175,  # the same: 3.5 % RH
)
"""Honeywell HIH-4030, analog, 5 V."""
