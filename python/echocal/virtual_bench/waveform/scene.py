"""Where a reading is made: the air, the target, and what else returns the sound."""

from dataclasses import dataclass, field, replace
from typing import Self

import numpy as np
from numpy.typing import NDArray

from echocal.virtual_bench import air
from echocal.virtual_bench.waveform.sensor import Sensor
from echocal.virtual_bench.waveform.target import Target, directivity, echo_of

__all__ = ["Scene"]

Column = NDArray[np.float64]
Phasor = NDArray[np.complex128]
Value = float | Column

_DECIBELS = 20.0


@dataclass(frozen=True)
class Scene:
    """What n readings are made of; each number may be one for all.

    Attributes
    ----------
    distance : ndarray, shape (n,)
        From the sensor to the middle of the target [m].
    temperature, relative_humidity, pressure, co2_mole_fraction : float or ndarray, shape (n,)
        Mean of the path [degC], [0..1], [Pa], [mol/mol].
    device_temperature : float or ndarray, shape (n,), or None
        Of the transducers [degC]; None: that of the path.
    wind_along, wind_across : float or ndarray, shape (n,)
        [m/s].
    supply : float or ndarray, shape (n,)
        Over its nominal voltage.
    target : Target
    way : float or ndarray, shape (n,)
        What turbulence adds to the distance [m].
    louder : float or ndarray, shape (n,)
        Factor of the echo's amplitude, by turbulence and the like.
    floor, wall : float
        Distance of a plane beside the axis [m]; infinite: none.
    floor_reflectivity, wall_reflectivity : float
    object_distance, object_aside : float or ndarray, shape (n,)
        Of a small thing in front [m]; infinite: none.
    object_size : float or ndarray, shape (n,)
        Its echo over that of an endless wall at its place.
    other_time : float or ndarray, shape (n,)
        When the burst of another sensor arrives, since the own burst began [s]; infinite: none.
    other_size : float or ndarray, shape (n,)
        Its amplitude.
    """

    distance: Column
    temperature: Value = 20.0
    relative_humidity: Value = 0.5
    pressure: Value = 101325.0
    co2_mole_fraction: Value = 4.2e-4
    device_temperature: Value | None = None
    wind_along: Value = 0.0
    wind_across: Value = 0.0
    supply: Value = 1.0
    target: Target = field(default_factory=Target)
    way: Value = 0.0
    louder: Value = 1.0
    floor: float = np.inf
    floor_reflectivity: float = 0.7
    wall: float = np.inf
    wall_reflectivity: float = 0.9
    object_distance: Value = np.inf
    object_aside: Value = 0.0
    object_size: Value = 0.02
    other_time: Value = np.inf
    other_size: Value = 0.3

    def __len__(self) -> int:
        return len(self.distance)

    def at(self, rows: NDArray[np.int64]) -> Self:
        """Return some of the readings."""
        given = {name: value[rows] for name, value in vars(self).items() if isinstance(value, np.ndarray)}
        return replace(self, target=self.target.at(rows), **given)  # type: ignore[arg-type]

    def speed(self, frequency: float) -> Column:
        """Compute the speed of sound on the path, without wind [m/s]."""
        here = (self.temperature, self.relative_humidity, self.pressure, self.co2_mole_fraction)
        return np.broadcast_to(air.speed_of_sound(*here, frequency), self.distance.shape)

    def paths(self, sensor: Sensor) -> tuple[Column, Phasor]:
        """List what arrives: delays [s] and complex sizes, shape (n, p).

        The first path leads along the board, the second to the target and back.
        """
        speed = self.speed(sensor.frequency)
        number = 2 * np.pi * sensor.frequency / speed
        moved = self.distance + self.way
        main, way = echo_of(self.target, moved, number, sensor.piston)
        found = [(np.full(len(self), sensor.spacing), np.full(len(self), sensor.coupling + 0j))]
        found.append((np.hypot(way, sensor.spacing), main * self.louder))
        found.append(
            (2 * found[1][0], 0.3 * main * main * found[1][0] / 2)
        )  # once more, by the sensor's own face
        found += [self._beside(plane, part, moved, number, sensor) for plane, part in self._planes()]
        if np.isfinite(self.object_distance).any():
            found.append(self._object(number, sensor))
        lost = air.absorption(self.temperature, self.relative_humidity, self.pressure, sensor.frequency)
        pumped = 1 + sensor.supply_gain * (np.asarray(self.supply) - 1)
        delays, sizes = [], []
        for length, size in found:
            delays.append(self._travel(length, speed))
            sizes.append(size * pumped * 10 ** (-lost * length / _DECIBELS))
        if np.isfinite(self.other_time).any():
            delays.append(np.broadcast_to(self.other_time, moved.shape))
            sizes.append(np.broadcast_to(np.asarray(self.other_size) + 0j, moved.shape))
        return np.stack(delays, axis=-1), np.stack(sizes, axis=-1)

    def _travel(self, length: Column, speed: Column) -> Column:
        """Time for a way out and back in wind [s]."""
        along, across = np.asarray(self.wind_along), np.asarray(self.wind_across)
        slowed = np.sqrt(speed**2 - across**2)
        return np.asarray(0.5 * length * (1 / (slowed + along) + 1 / (slowed - along)))

    def _planes(self) -> list[tuple[float, float]]:
        given = ((self.floor, self.floor_reflectivity), (self.wall, self.wall_reflectivity))
        return [(plane, part) for plane, part in given if np.isfinite(plane)]

    def _beside(
        self, plane: float, part: float, distance: Column, number: Column, sensor: Sensor
    ) -> tuple[Column, Phasor]:
        """The corner of a plane beside the axis and the target: the image of the sensor in both."""
        half = np.hypot(distance, plane)
        aside = directivity(np.arctan2(plane, distance), sensor.piston, number) ** 2
        corner = replace(
            self.target, offset=plane, tilt=0.0
        )  # the plane stands at the target's lower edge or below
        reached, _ = echo_of(corner, distance, number, sensor.piston)
        return 2 * half, reached * part * aside * distance / half * self.louder

    def _object(self, number: Column, sensor: Sensor) -> tuple[Column, Phasor]:
        """A thing in front that is small beside the wave's zone: it sends to all sides."""
        away = np.hypot(self.object_distance, self.object_aside)
        there = np.isfinite(away)
        angle = np.where(
            there, np.arctan2(self.object_aside, np.where(there, self.object_distance, 1.0)), 0.0
        )
        seen = directivity(angle, sensor.piston, number) ** 2
        size = np.where(there, seen * self.object_size / np.where(there, away, 1.0), 0.0)
        return np.broadcast_to(2 * away, number.shape), np.broadcast_to(size + 0j, number.shape)
