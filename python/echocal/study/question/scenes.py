"""What the person and the module do in each row: how the potentiometer is set, and how long ECHO is."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from echocal.arrays import Column
from echocal.virtual_bench.air import speed_of_sound
from echocal.virtual_bench.echo_time import echo_time

MODULE_SPEED = 343.0
"""Speed with which the module of the simulator makes its echo [m/s]. Tinkercad does not publish it."""

_CODES, _FULL_SCALE, _VOLTS = 1023, 50.0, 5.0
_FREQUENCY = 40e3  # Hz
_DAMP = 0.5  # relative humidity of a room


@dataclass(frozen=True)
class Rows:
    """Rows for the board."""

    echo: Column  # length of ECHO [s]; shape (n,)
    voltage: Column  # of the potentiometer [V]; shape (n,)


Scene = Callable[[Column, float, np.random.Generator], Rows]
"""Makes rows from the temperatures of the table [degC], a distance [m], and what draws random numbers."""


def _volts(temperature: Column) -> Column:
    """Voltage of the potentiometer in the middle of the code that is nearest to a temperature."""
    code = np.clip(np.round(temperature / _FULL_SCALE * _CODES), 0, _CODES)
    return np.asarray((code + 0.5) * _VOLTS / (_CODES + 1))


def _rows(temperature: Column, echo: Column | float) -> Rows:
    return Rows(np.broadcast_to(np.asarray(echo, dtype=np.float64), temperature.shape), _volts(temperature))


def plain(temperature: Column, distance: float, random: np.random.Generator) -> Rows:
    """Potentiometer at the nearest code, target at the distance, no air."""
    return _rows(temperature, 2.0 * distance / MODULE_SPEED)


def placed(offset: float) -> Scene:
    """Target beside the distance by an offset [m], the same in all rows."""
    return lambda t, d, random: _rows(t, 2.0 * (d + offset) / MODULE_SPEED)


def moved(half: float) -> Scene:
    """Target placed anew in each row, uniformly within a half width [m]."""

    def scene(temperature: Column, distance: float, random: np.random.Generator) -> Rows:
        off = random.uniform(-half, half, temperature.shape)
        return _rows(temperature, 2.0 * (distance + off) / MODULE_SPEED)

    return scene


def module(speed: float) -> Scene:
    """Module that makes its echo with another speed of sound [m/s]."""
    return lambda t, d, random: _rows(t, 2.0 * d / speed)


def late(least: float, most: float) -> Scene:
    """ECHO longer by a latency [s], uniformly between two bounds."""

    def scene(temperature: Column, distance: float, random: np.random.Generator) -> Rows:
        delay = random.uniform(least, most, temperature.shape)
        return _rows(temperature, 2.0 * distance / MODULE_SPEED + delay)

    return scene


def hand(half: float) -> Scene:
    """Potentiometer set by hand, uniformly within a half width [K] of the temperature."""

    def scene(temperature: Column, distance: float, random: np.random.Generator) -> Rows:
        set_to = temperature + random.uniform(-half, half, temperature.shape)
        return _rows(set_to, 2.0 * distance / MODULE_SPEED)

    return scene


def echo_and_voltage(echo: Scene, voltage: Scene) -> Scene:
    """ECHO of one scene and potentiometer of another."""

    def scene(temperature: Column, distance: float, random: np.random.Generator) -> Rows:
        return Rows(echo(temperature, distance, random).echo, voltage(temperature, distance, random).voltage)

    return scene


def whole_degrees(temperature: Column, distance: float, random: np.random.Generator) -> Rows:
    """Potentiometer turned until the display, which cuts off decimals, shows the temperature."""
    set_to = temperature + random.uniform(0.0, 1.0, temperature.shape)
    return _rows(set_to, 2.0 * distance / MODULE_SPEED)


def next_row(temperature: Column, distance: float, random: np.random.Generator) -> Rows:
    """Each reading belongs to the temperature of the next row."""
    after = np.append(temperature[1:], 2.0 * temperature[-1] - temperature[-2])
    return _rows(after, 2.0 * distance / MODULE_SPEED)


def _through(temperature: Column, echo: Column) -> Rows:
    """Echo in air of the temperature; the program converts with 343 m/s and corrects nothing.

    The program divides by its own speed at the potentiometer, which is left where that is 343 m/s.
    """
    where = np.full_like(temperature, (MODULE_SPEED - 331.3) / 0.6)
    return Rows(np.asarray(echo), _volts(where))


def air(temperature: Column, distance: float, random: np.random.Generator) -> Rows:
    """Dry air of the bench at the temperature."""
    return _through(
        temperature, 2.0 * distance / speed_of_sound(temperature, frequency=_FREQUENCY, group=True)
    )


def damp_air(temperature: Column, distance: float, random: np.random.Generator) -> Rows:
    """Air of the bench at 50 % relative humidity."""
    return _through(
        temperature, 2.0 * distance / speed_of_sound(temperature, _DAMP, frequency=_FREQUENCY, group=True)
    )


def comparator(temperature: Column, distance: float, random: np.random.Generator) -> Rows:
    """An HC-SR04 of the bench with its comparator before a wall, in air at 50 % relative humidity."""
    seed = int(random.integers(2**31))
    return _through(temperature, echo_time(distance, temperature, _DAMP, detector="comparator", seed=seed))
