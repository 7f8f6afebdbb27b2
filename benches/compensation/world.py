"""Units, seasons and campaigns: what is true, before any firmware or thermometer writes it down."""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from echocal.virtual_bench import Resonance, Scene, Sensor, Target, measure
from echocal.virtual_bench.campaign.campaign import INTERFERENCE, TILT, Random
from echocal.virtual_bench.waveform.fluctuations import INDOORS, OUTDOORS, Turbulence, remembering

Column = NDArray[np.float64]
Labels = NDArray[np.int64]

HOUR, DAY = 3600.0, 86400.0
EACH = 5  # readings of a burst
_APART = 0.1  # s, between them
REFERENCE = 1.0  # m, to the plate of the reference path
_CLOCK = 1.8e-3  # RMS of five boards with a ceramic resonator: github.com/manitou48/crystals, crystals.txt
_CLOCK_DRIFT = 1.5e-5  # 1/K, assumed: a third of the 0.3 % that resonators may change over 70 K
_ZERO = 1e-3  # m, assumed: how well a ruler's zero is put to the face of the sensor
_THRESHOLD, _CENTER = 0.2, 200.0  # 1 and Hz, assumed: how modules differ


@dataclass(frozen=True)
class Season:
    """Weather of some days.

    Attributes
    ----------
    mean, swing, front : float
        Temperature [degC], half of what it changes in a day [K], standard deviation from day to day [K].
    humidity : float
        Mean of the relative humidity.
    sun : float
        Radiation at noon without clouds [W/m2].
    """

    mean: float
    swing: float
    front: float
    humidity: float
    sun: float


SEASONS = {
    "spring": Season(12.0, 5.0, 2.5, 0.62, 750.0),
    "summer": Season(27.0, 7.0, 3.0, 0.50, 900.0),
    "winter": Season(-1.0, 3.0, 3.0, 0.80, 300.0),
}


@dataclass(frozen=True)
class Unit:
    """One device: a sensor, the second one of a reference path, and the board.

    Attributes
    ----------
    sensor, second : Sensor
    clock, clock_drift : float
        Relative error of the board's clock at 25 degC, and what a kelvin adds.
    zero : float
        From the face of the sensor to where the user puts the ruler's zero [m].
    """

    sensor: Sensor
    second: Sensor
    clock: float
    clock_drift: float
    zero: float


@dataclass(frozen=True)
class Truth:
    """A campaign as it truly is, a row for each reading.

    Attributes
    ----------
    seconds, distance, temperature, humidity, pressure, radiation, wind : ndarray, shape (n,)
        [s], [m], [degC], [0..1], [Pa], [W/m2], [m/s].
    placement, burst : ndarray of int, shape (n,)
        Which placement of the target, which burst.
    pulse, ideal, second : ndarray, shape (n,)
        Length of ECHO [s]: the sensor, one without time walk, that of the reference path.
    tape : ndarray, shape (n,)
        What the user read from the ruler [m].
    """

    seconds: Column
    distance: Column
    temperature: Column
    humidity: Column
    pressure: Column
    radiation: Column
    wind: Column
    placement: Labels
    burst: Labels
    pulse: Column
    ideal: Column
    second: Column
    tape: Column


def draw_unit(random: np.random.Generator) -> Unit:
    """Draw a device: the bench's HC-SR04 is one module; how modules differ is assumed."""

    def sensor() -> Sensor:
        own = Sensor()
        return own.but(
            threshold=own.comparator.threshold * np.exp(_THRESHOLD * random.normal()),
            transmitter=Resonance(own.transmitter.center + _CENTER * random.normal(), 30.0, -40.0),
            receiver=Resonance(own.receiver.center + _CENTER * random.normal(), 30.0, -40.0),
        )

    return Unit(
        sensor(), sensor(), _CLOCK * random.normal(), _CLOCK_DRIFT * random.normal(), _ZERO * random.normal()
    )


def outdoors(
    name: str, season: Season, unit: Unit, random: Random, days: float, stay: float, reach: tuple[float, ...]
) -> Truth:
    """Stage some days in the open: a burst every half hour, and the target is moved every `stay` hours."""
    own = random(f"{name} design")
    start = np.arange(0.0, days * DAY, 0.5 * HOUR)
    bursts = np.repeat(np.arange(len(start)), EACH)
    seconds = start[bursts] + _APART * np.tile(np.arange(EACH), len(start))
    placement = (start[bursts] // (stay * HOUR)).astype(np.int64)
    places = _places(own, placement.max() + 1, reach)
    hours = seconds / HOUR % 24
    clouds = np.clip(0.65 + 0.35 * remembering(seconds, 3 * HOUR, own), 0.05, 1.0)
    swing = season.swing * np.sin(2 * np.pi * (hours - 9) / 24) * clouds.mean() / 0.65
    front = season.front * remembering(seconds, 1.5 * DAY, own)
    local = 0.5 * remembering(seconds, HOUR, own)
    wet = season.humidity - 0.022 * swing - 0.02 * front + 0.05 * remembering(seconds, 2 * HOUR, own)
    gusts = np.abs(own.uniform(1.5, 3.5) * (0.5 + 0.5 * remembering(seconds, HOUR, own)))
    return _staged(
        unit,
        random,
        name,
        OUTDOORS,
        seconds=seconds,
        burst=bursts,
        placement=placement,
        distance=places[placement],
        temperature=season.mean + 2.0 * own.normal() + swing + front + local,
        humidity=np.clip(wet, 0.15, 1.0),
        pressure=own.uniform(96e3, 102e3) + 700 * remembering(seconds, 2 * DAY, own),
        radiation=season.sun * np.maximum(0.0, np.sin(2 * np.pi * (hours - 6) / 24)) * clouds,
        wind=gusts,
    )


def bench(name: str, unit: Unit, random: Random) -> Truth:
    """Stage a student's bench: eight distances in ascending order, 25 readings each, cool and heated."""
    own = random(f"{name} design")
    places = np.tile(np.round(np.linspace(own.uniform(0.2, 0.3), own.uniform(2.6, 3.6), 8), 2), 2)
    placement = np.repeat(np.arange(16), 25)
    seconds = 60.0 * placement + np.tile(0.2 * np.arange(25), 16) + 2 * HOUR * (placement > 7)
    mean = own.uniform(17, 21) + np.where(placement > 7, own.uniform(6, 10), 0.0)
    return _room(name, unit, random, seconds, placement, places, mean)


def nominal(name: str, unit: Unit, random: Random, reach: tuple[float, ...]) -> Truth:
    """Stage the conditions of the data sheet: 48 placements in a room at 20 degC."""
    placement = np.repeat(np.arange(48), 6 * EACH)
    seconds = 60.0 * placement + np.tile(0.2 * np.arange(6 * EACH), 48)
    places = _places(random(f"{name} design"), 48, reach)
    return _room(name, unit, random, seconds, placement, places, np.full(len(seconds), 20.0))


def _room(
    name: str, unit: Unit, random: Random, seconds: Column, placement: Labels, places: Column, mean: Column
) -> Truth:
    """Measure in still air; warm air is as damp as before, so its relative humidity is lower."""
    own, n = random(f"{name} room"), len(seconds)
    wet = own.uniform(0.35, 0.55) - 0.02 * (mean - mean[0]) + 0.02 * remembering(seconds, 1800.0, own)
    return _staged(
        unit,
        random,
        name,
        INDOORS,
        seconds=seconds,
        burst=np.arange(n) // EACH,
        placement=placement,
        distance=places[placement],
        temperature=mean + 0.25 * remembering(seconds, 900.0, own),
        humidity=np.clip(wet, 0.1, 0.95),
        pressure=own.uniform(96e3, 102e3) + 30 * remembering(seconds, 6 * HOUR, own),
        radiation=np.zeros(n),
        wind=np.zeros(n),
    )


def _places(random: np.random.Generator, count: int, reach: tuple[float, ...]) -> Column:
    """Distances drawn so that the bands between the values of `reach` have equal numbers."""
    bands = np.arange(count) % (len(reach) - 1)
    low, high = np.array(reach[:-1])[bands], np.array(reach[1:])[bands]
    return np.round(random.permutation(random.uniform(low, high)), 3)


def _staged(
    unit: Unit,
    random: Random,
    name: str,
    turbulence: Turbulence,
    *,
    seconds: Column,
    distance: Column,
    placement: Labels,
    burst: Labels,
    temperature: Column,
    humidity: Column,
    pressure: Column,
    radiation: Column,
    wind: Column,
) -> Truth:
    """Measure: both sensors in the same air, each with its own turbulence."""
    own, hand = random(f"{name} air"), random(f"{name} hand")
    count = placement.max() + 1
    placed, fixed = hand.normal(size=(2, count))[:, placement], hand.normal(size=2)
    toward = own.uniform(0, 2 * np.pi) + 0.5 * remembering(seconds, 2 * HOUR, own)
    slow = (0.15 if wind.any() else 0.05) * remembering(seconds, 1800.0, own)
    common = Scene(
        distance + unit.zero,
        temperature=temperature + slow,
        relative_humidity=humidity,
        pressure=pressure,
        device_temperature=temperature + 5e-3 * radiation / (1 + wind),
        wind_along=wind * np.cos(toward),
        wind_across=wind * np.sin(toward),
        supply=1 + 0.004 * remembering(seconds, 60.0, own),
    )

    def seen(scene: Scene, sensor: Sensor, path: Labels, moved: Column, what: str) -> Column:
        drawn = turbulence.draw(seconds, scene.distance, path, random(f"{name} turbulence {what}"))
        louder = drawn[1] * np.exp(INTERFERENCE * moved[1])
        target = Target(tilt=TILT * moved[0] * np.ones(len(seconds)))
        own_scene = replace(scene, target=target, way=drawn[0], louder=louder)
        return measure(own_scene, sensor, random(f"{name} noise {what}"), threads=1).time

    still = np.zeros(len(seconds), dtype=np.int64)
    plate = replace(common, distance=np.full(len(seconds), REFERENCE))
    tape = np.round(distance + 0.4e-3 * random(f"{name} tape").normal(size=count)[placement], 3)
    return Truth(
        seconds,
        distance,
        temperature,
        humidity,
        pressure,
        radiation,
        wind,
        placement,
        burst,
        pulse=seen(common, unit.sensor, placement, placed, "main"),
        ideal=seen(common, unit.sensor.but(ideal=True), placement, placed, "main"),
        second=seen(plate, unit.second, still, np.outer(fixed, np.ones(len(seconds))), "second"),
        tape=tape,
    )
