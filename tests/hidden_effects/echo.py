"""An oracle's echo: a resonant receiver rings up, a comparator waits for a threshold."""

import numpy as np
from numpy.typing import NDArray

from hidden_effects import gas

Column = NDArray[np.float64]

PERIOD = 25e-6  # s, one cycle of 40 kHz
_CARRIER = 40e3  # Hz
_NEAR = 0.3  # m, where the threshold stands at its neutral part of the amplitude


def amplitude(distance: Column, temperature: Column, humidity: Column) -> Column:
    """Echo amplitude over that at `_NEAR`: spherical spreading out and back, ISO 9613-1 absorption."""
    lost = gas.attenuation(temperature, humidity) * 2 * (distance - _NEAR)
    return np.asarray(_NEAR / np.maximum(distance, 0.05) * 10 ** (-lost / 20))


def crossing(strength: Column, threshold: float, rise: float) -> Column:
    """Delay [s] until an envelope A (1 - exp(-s/rise)) crosses the threshold."""
    part = np.minimum(threshold / np.maximum(strength, 1e-9), 0.98)  # a fainter echo is lost altogether
    return -rise * np.log1p(-part)


def walk(distance: Column, temperature: Column, humidity: Column, threshold: float, rise: float) -> Column:
    """Delay of the crossing beyond that of a near echo [s]."""
    strength = amplitude(distance, temperature, humidity)
    return crossing(strength, threshold, rise) - crossing(np.ones(1), threshold, rise)


def detuned(temperature: Column, per_kelvin: float, quality: float, rise: float) -> Column:
    """Delay [s] where the resonance leaves the carrier by `per_kelvin` [Hz/K] from 25 degC.

    Both transducers answer by a Lorentzian; the fainter echo crosses later.
    """
    off = per_kelvin * (temperature - 25.0) / _CARRIER
    strength = 1 / (1 + (2 * quality * off) ** 2)
    return crossing(strength, 0.15, rise) - crossing(np.ones(1), 0.15, rise)


def missed_cycles(strength: Column, noise: float, random: np.random.Generator) -> Column:
    """Cycles that the comparator misses: carrier peaks under the threshold in amplitude noise."""
    cycles = np.zeros(len(strength))
    waiting = np.ones(len(strength), dtype=bool)
    for count in range(1, 4):
        peak = strength * (1 - np.exp(-(count + 1.5) / 3.0))
        waiting &= peak + noise * random.normal(size=len(strength)) < 0.12
        cycles[waiting] = count
    return cycles
