"""Causes that change the distribution of readings, not their mean alone."""

import numpy as np

from hidden_effects import disturbance, echo
from hidden_effects.causes.registry import cause
from hidden_effects.log import Log

Random = np.random.Generator


@cause("noise", size="fixed")
def timer_quantization(log: Log, _: float, random: Random) -> None:
    tick = random.choice([4e-6, 8e-6, 16e-6, 25e-6, 64e-6])
    echo_time = 2 * log.reading / log.speed
    log.reading = log.speed * tick * np.round(echo_time / tick) / 2


@cause("noise", size="fixed")
def reading_quantization(log: Log, _: float, random: Random) -> None:
    step = random.choice([1e-3, 2.54e-3, 5e-3, 10e-3])
    log.reading = step * (
        np.floor(log.reading / step) if random.random() < 0.5 else np.round(log.reading / step)
    )


@cause("noise", size="fixed")
def temperature_quantization(log: Log, _: float, random: Random) -> None:
    step = random.choice([0.25, 0.49, 0.5, 1.0])
    rounded = np.round(log.temperature / step) * step
    log.reading = log.reading * (331.4 + 0.6 * rounded) / (331.4 + 0.6 * log.temperature)
    log.temperature = rounded


@cause("noise", size="positive", needs="distances")
def noise_growth(log: Log, size: float, random: Random) -> None:
    grown = np.sqrt((1 + 0.5 * size * log.rows.distance) ** 2 - 1)
    log.reading = log.reading + disturbance.SHOT * grown * random.normal(size=len(log.rows))


@cause("noise", size="positive", needs="time")
def correlated_noise(log: Log, size: float, random: Random) -> None:
    log.reading = log.reading + size * disturbance.convection(log.rows, random)


@cause("noise", size="fixed")
def cycle_slip(log: Log, _: float, random: Random) -> None:
    strength = echo.amplitude(log.rows.distance, log.rows.temperature, log.rows.humidity)
    strength = strength / np.median(strength) * random.uniform(0.2, 0.3)
    missed = echo.missed_cycles(strength, 0.03, random)
    log.reading = log.reading + log.speed * echo.PERIOD * missed / 2


@cause("noise", size="positive")
def polling_jitter(log: Log, size: float, random: Random) -> None:
    late = random.exponential(15e-6 * size, len(log.rows))
    log.reading = log.reading + log.speed * late / 2


@cause("row", size="positive", needs="time")
def first_ping(log: Log, size: float, random: Random) -> None:
    burst = int(random.integers(5, 11))
    order = np.arange(len(log.rows)) % burst
    log.reading = log.reading - 0.7e-3 * size * (order == 0)
    log.extra["group"] = np.arange(len(log.rows)) // burst
    log.extra["order"] = order
