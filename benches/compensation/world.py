"""Units, seasons and campaigns: what is true, before any firmware or thermometer writes it down."""

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from echocal.virtual_bench import Scene, Sensor, measure
from echocal.virtual_bench.campaign.campaign import Campaign, Random, Surroundings
from echocal.virtual_bench.campaign.designs import lay_down, placements, tape, weather
from echocal.virtual_bench.campaign.simulate import scene_of
from echocal.virtual_bench.waveform.fluctuations import OUTDOORS

Column = NDArray[np.float64]
Labels = NDArray[np.int64]

HOUR, DAY = 3600.0, 86400.0
EACH = 5  # readings of a burst
REFERENCE = 1.0  # m, to the plate of the reference path
_BESIDE = 100  # added to the replicate: the second path has turbulence of its own
_APART = 0.1  # s, between the readings of a burst
_CLOCK = 1.8e-3  # RMS of five boards with a ceramic resonator: github.com/manitou48/crystals, crystals.txt
_CLOCK_DRIFT = 1.5e-5  # 1/K, assumed: a third of the 0.3 % that resonators may change over 70 K
_ZERO = 1e-3  # m, assumed: how well a ruler's zero is put to the face of the sensor
_SENSITIVITY, _CENTER = 0.2, 200.0  # 1 and Hz, assumed: how the transducers of modules differ

SEASONS: dict[str, dict[str, Any]] = {
    "spring": {"mean": (9.0, 15.0), "swing": (4.0, 8.0), "humidity": 0.62, "noon": 750.0},
    "summer": {"mean": (24.0, 30.0), "swing": (7.0, 11.0), "humidity": 0.50, "noon": 900.0},
    "winter": {"mean": (-4.0, 2.0), "swing": (2.0, 5.0), "humidity": 0.80, "noon": 300.0},
}
"""Arguments of `weather`; the swings are those of clear days."""


@dataclass(frozen=True)
class Unit:
    """One device: a sensor, the second one of a reference path, and the board."""

    sensor: Sensor
    second: Sensor
    clock: float  # relative error at 25 degC
    clock_drift: float  # what a kelvin adds
    zero: float  # m, from the face of the sensor to where the user puts the ruler's zero


@dataclass(frozen=True)
class Truth:
    """A campaign as it truly is, a row for each reading."""

    seconds: Column
    distance: Column  # m, from the ruler's zero
    around: Surroundings
    placement: Labels
    burst: Labels
    pulse: Column  # s, length of ECHO
    ideal: Column  # s, that of a sensor without time walk
    second: Column  # s, that of the reference path
    tape: Column  # m, what the user read from the ruler


def draw_unit(random: np.random.Generator) -> Unit:
    """Draw a device: the bench's HC-SR04 is one module; how modules differ is assumed."""

    def sensor() -> Sensor:
        own = Sensor()
        changed = {
            name: replace(old, center=old.center + _CENTER * random.normal())
            for name, old in (("transmitter", own.transmitter), ("receiver", own.receiver))
        }
        weaker = np.exp(_SENSITIVITY * random.normal())  # so threshold and noise are higher beside the echo
        threshold, noise = weaker * own.comparator.threshold, weaker * own.noise
        return own.but(threshold=threshold, noise=noise, **changed)

    return Unit(
        sensor(), sensor(), _CLOCK * random.normal(), _CLOCK_DRIFT * random.normal(), _ZERO * random.normal()
    )


def outdoors(
    season: str, unit: Unit, random: Random, days: float, stay: float, reach: tuple[float, ...]
) -> Truth:
    """Stage some days in the open: a burst every half hour, and the target is moved every `stay` hours."""
    own = random("design")
    start = np.repeat(np.arange(0.0, days * DAY, 0.5 * HOUR), EACH)
    seconds = start + _APART * (np.arange(len(start)) % EACH)
    placement = (start // (stay * HOUR)).astype(np.int64)
    distance = _places(own, placement.max() + 1, reach)[placement]
    campaign = Campaign(
        season,
        seconds,
        distance,
        placement,
        weather(seconds, own, **SEASONS[season]),
        reference=tape(distance, placement, 1e-3, own),
        turbulence=OUTDOORS,
        by_hand=True,
        slow_air=0.15,
    )
    campaign.device_temperature += 5e-3 * campaign.around.radiation  # as a thermometer without a shield
    return _measured(campaign, unit, random)


def bench(unit: Unit, random: Random) -> Truth:
    """Stage a student's bench: eight distances in ascending order, 25 readings each, cool and heated."""
    return _measured(lay_down("bench", random), unit, random)


def nominal(unit: Unit, random: Random, reach: tuple[float, ...]) -> Truth:
    """Stage the conditions of the data sheet: 48 placements in a room at 20 degC."""
    places = _places(random("places"), 48, reach)
    return _measured(placements("nominal", list(places), 6 * EACH, [20.0] * 48, random), unit, random)


def _places(random: np.random.Generator, count: int, reach: tuple[float, ...]) -> Column:
    """Distances drawn so that the bands between the values of `reach` have equal numbers."""
    bands = np.arange(count) % (len(reach) - 1)
    low, high = np.array(reach[:-1])[bands], np.array(reach[1:])[bands]
    return np.round(random.permutation(random.uniform(low, high)), 3)


def _measured(campaign: Campaign, unit: Unit, random: Random) -> Truth:
    """Measure: both sensors in the same air, each with its own turbulence."""
    true, n = campaign.distance, len(campaign)
    campaign.distance = true + unit.zero
    scene = scene_of(campaign, random)
    plate = replace(
        campaign,
        distance=np.full(n, REFERENCE),
        placement=np.zeros(n, dtype=np.int64),
        by_hand=False,
        slow_air=0.0,
    )
    plate.air, plate.device_temperature = np.asarray(scene.temperature), campaign.device_temperature
    beside = scene_of(plate, Random(random.seed, _BESIDE + random.replicate))

    def pulse(scene: Scene, sensor: Sensor, name: str) -> Column:
        return measure(scene, sensor, random(name), threads=1).time

    return Truth(
        campaign.seconds,
        true,
        campaign.around,
        campaign.placement,
        np.arange(n) // EACH,
        pulse=pulse(scene, unit.sensor, "noise"),
        ideal=pulse(scene, unit.sensor.but(ideal=True), "noise"),
        second=pulse(beside, unit.second, "noise of the second"),
        tape=np.asarray(campaign.reference),
    )
