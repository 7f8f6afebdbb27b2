"""Where a reading is made: the air, the target, and what else returns the sound."""

from dataclasses import dataclass, field, replace
from typing import Self

import numpy as np
from numpy.typing import NDArray

from echocal.errors import UsageError
from echocal.virtual_bench import air
from echocal.virtual_bench.waveform.possible import Limits, check, check_length
from echocal.virtual_bench.waveform.sensor import Sensor
from echocal.virtual_bench.waveform.target import Target, aperture, directivity, echo_of

Column = NDArray[np.float64]
Phasor = NDArray[np.complex128]
Value = float | Column
Path = tuple[Column, Phasor]  # length [m] and size of what arrives by a path, without the air

_DECIBELS = 20.0
_CELSIUS = Limits(-273.15, above=True, unit="degC")
_PART = Limits(0.0, 1.0, way_out="it is a fraction; write 0.5 for 50 %")
_WIND = Limits(-250.0, 250.0, unit="m/s", way_out="the bench has no wind as fast as sound")
_PLACE = Limits(0.0, above=True, endless=True, unit="m", way_out="inf stands for none")
_SIZE = Limits(0.0)
_POSSIBLE = {
    "distance": Limits(0.0, above=True, unit="m", way_out="a target stands in front of the sensor"),
    "temperature": _CELSIUS,
    "device_temperature": _CELSIUS,
    "relative_humidity": _PART,
    "pressure": Limits(0.0, above=True, unit="Pa"),
    "co2_mole_fraction": _PART,
    "wind_along": _WIND,
    "wind_across": _WIND,
    "supply": Limits(0.0, above=True, way_out="it is a part of the nominal voltage; write 1 for all of it"),
    "way": Limits(unit="m"),
    "louder": _SIZE,
    "floor": _PLACE,
    "floor_reflectivity": _PART,
    "wall": _PLACE,
    "wall_reflectivity": _PART,
    "object_distance": _PLACE,
    "object_aside": Limits(unit="m"),
    "object_size": _SIZE,
    "other_time": Limits(0.0, endless=True, unit="s", way_out="inf stands for no other sensor"),
    "other_size": _SIZE,
}


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

    Raises
    ------
    UsageError
        If something cannot be, such as a target behind the sensor.
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

    def __post_init__(self) -> None:
        for name, limits in _POSSIBLE.items():
            value = getattr(self, name)
            if value is not None:
                check_length(name, value, len(self))
                check(name, value, limits)
        for name, value in vars(self.target).items():
            check_length(f"target.{name}", value, len(self))
        self._check_side()

    def _check_side(self) -> None:
        """Check that the face of the target looks at the sensor."""
        tilt, offset = np.asarray(self.target.tilt), np.asarray(self.target.offset)
        front = np.broadcast_to(self.distance * np.cos(tilt) - offset * np.sin(tilt), self.distance.shape)
        behind = np.flatnonzero(~(front + self.way > 0))
        if len(behind):
            one = behind[0]
            turned, aside = (float(np.broadcast_to(value, front.shape)[one]) for value in (tilt, offset))
            raise UsageError(
                f"the target of reading {one + 1} shows its back to the sensor: at {self.distance[one]:g} m, "
                f"{aside:g} m off the axis, a tilt of {turned:g} rad leaves {front[one]:g} m to its plane; "
                "give a smaller tilt or offset"
            )

    def __len__(self) -> int:
        return len(self.distance)

    def at(self, rows: NDArray[np.int64]) -> Self:
        """Return some of the readings."""
        given = {name: value[rows] for name, value in vars(self).items() if isinstance(value, np.ndarray)}
        return replace(self, target=self.target.at(rows), **given)  # type: ignore[arg-type]

    def speed(self, frequency: float, *, group: bool = False) -> Column:
        """Compute the speed of sound on the path, without wind [m/s]: of its phase, or of its envelope."""
        here = (self.temperature, self.relative_humidity, self.pressure, self.co2_mole_fraction)
        return np.broadcast_to(air.speed_of_sound(*here, frequency, group=group), self.distance.shape)

    def paths(self, sensor: Sensor) -> tuple[Column, Phasor]:
        """List what arrives: delays of the envelope [s] and complex sizes, shape (n, p).

        The first path leads along the board, the second to the target and back, the next ones to it again.
        """
        speed, group = (self.speed(sensor.frequency, group=flag) for flag in (False, True))
        omega = 2 * np.pi * sensor.frequency
        number, moved = omega / speed, self.distance + self.way
        main, way = echo_of(self.target, moved, number, sensor.piston, sensor.spacing)
        found: list[Path] = [(np.full(len(self), sensor.spacing), np.full(len(self), sensor.coupling + 0j))]
        found.append((way, main * self.louder))
        found += self._again(main * self.louder, way, moved, number, sensor)
        found += [self._beside(plane, moved, number, sensor) for plane in self._planes()]
        if np.isfinite(self.object_distance).any():
            found.append(self._object(number, sensor))
        lost = air.absorption(self.temperature, self.relative_humidity, self.pressure, sensor.frequency)
        pumped = 1 + sensor.supply_gain * (np.asarray(self.supply) - 1)
        delays, sizes = [], []
        for length, size in found:
            delay = self._travel(length, group)
            ahead = np.exp(1j * omega * (delay - self._travel(length, speed)))  # of the phase
            delays.append(delay)
            sizes.append(size * ahead * pumped * 10 ** (-lost * length / _DECIBELS))
        if np.isfinite(self.other_time).any():
            delays.append(np.broadcast_to(self.other_time, moved.shape))
            sizes.append(np.broadcast_to(np.asarray(self.other_size) + 0j, moved.shape))
        return np.stack(delays, axis=-1), np.stack(sizes, axis=-1)

    def _travel(self, length: Column, speed: Column) -> Column:
        """Time for a way out and back in wind [s]."""
        along, across = np.asarray(self.wind_along), np.asarray(self.wind_across)
        slowed = np.sqrt(speed**2 - across**2)
        return np.asarray(0.5 * length * (1 / (slowed + along) + 1 / (slowed - along)))

    def _again(self, main: Phasor, way: Column, moved: Column, number: Column, sensor: Sensor) -> list[Path]:
        """By the sensor's own face to the target again, and once more."""
        plain, _ = echo_of(self.target, moved, number, 0.0)
        wide, high = (aperture(half, 0.0, 2 * moved, number) for half in sensor.face)
        # A wall and a face without end: the echo is m times as far, so 1/m as loud.
        step = plain * moved * wide * high
        return [(times * way, main * step ** (times - 1) / times) for times in (2, 3)]

    def _planes(self) -> list[tuple[float, float, Value, Value, Value]]:
        """Of floor and wall: distance, reflectivity, half of the target toward and across, radius across."""
        own = self.target
        floor = (self.floor, self.floor_reflectivity, own.half_height, own.half_width, own.radius)
        wall = (self.wall, self.wall_reflectivity, own.half_width, own.half_height, np.inf)
        return [plane for plane in (floor, wall) if np.isfinite(plane[0])]

    def _beside(
        self,
        plane: tuple[float, float, Value, Value, Value],
        moved: Column,
        number: Column,
        sensor: Sensor,
    ) -> Path:
        """By a plane beside the axis and the target, and the same way round: two echoes at once.

        The plane mirrors the receiver, and the way to the mirrored one is shortest by the corner of plane and
        target. Where the target ends before the corner, its edge scatters; it never reaches beyond the plane.
        """
        away, part, toward, across, radius = plane
        half = np.hypot(moved, away)
        bent = half**3 / moved**2  # the distance at which a plate would be as large beside the wave's zones
        edge = np.maximum(away - np.asarray(toward), 0.0)  # from the corner to the target
        further = np.hypot(moved, away - edge) + np.hypot(moved, away + edge) - 2 * half
        curved = np.sqrt(1 / (1 + half / np.asarray(radius)))
        far = away + np.asarray(toward)
        seen = aperture(0.5 * (far - edge), 0.5 * (far + edge), bent, number) * curved
        seen = seen * aperture(across / curved, 0.0, half, number)
        leaves, returns = (
            directivity(np.hypot(np.arctan2(side, moved), self.target.tilt), sensor.piston, number)
            for side in (away - edge, away + edge)
        )
        rough = np.exp(-2 * (number * np.asarray(self.target.roughness) * moved / half) ** 2)
        size = 2 * part * np.asarray(self.target.reflectivity) * leaves * returns * rough / half
        turned = np.exp(1j * number * edge**2 / bent)  # as at the edge of a plate, see `echo_of`
        return 2 * half + further, size * seen * turned * self.louder

    def _object(self, number: Column, sensor: Sensor) -> Path:
        """A thing in front that is small beside the wave's zone: it sends to all sides."""
        away = np.hypot(self.object_distance, self.object_aside)
        there = np.isfinite(away)
        angle = np.where(
            there, np.arctan2(self.object_aside, np.where(there, self.object_distance, 1.0)), 0.0
        )
        seen = directivity(angle, sensor.piston, number) ** 2
        size = np.where(there, seen * self.object_size / np.where(there, away, 1.0), 0.0)
        return np.broadcast_to(2 * away, number.shape), np.broadcast_to(size + 0j, number.shape)
