"""Designs as people run them: a function each, from an evening with a ruler to a month on a mast."""

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from echocal.errors import UsageError
from echocal.virtual_bench.campaign.campaign import Campaign, Random, Surroundings
from echocal.virtual_bench.waveform.fluctuations import INDOORS, OUTDOORS, remembering

Column = NDArray[np.float64]

_HOUR, _DAY = 3600.0, 86400.0

Design = Callable[[Random], Campaign]
DESIGNS: dict[str, Design] = {}


def _design(function: Design) -> Design:
    DESIGNS[function.__name__] = function
    return function


def lay_down(name: str, random: Random) -> Campaign:
    """Make the campaign of a design. Raises `UsageError` if there is no such design."""
    if name not in DESIGNS:
        raise UsageError(f"there is no design '{name}'; there are {', '.join(DESIGNS)}")
    return DESIGNS[name](random)


def tape(distance: Column, placement: NDArray[np.int64], step: float, random: np.random.Generator) -> Column:
    """What somebody reads from a tape: the same error for a whole placement, then the step of the scale."""
    errors = random.normal(0.0, 0.4 * step, placement.max() + 1)
    return np.asarray(np.round((distance + errors[placement]) / step) * step)


def room(seconds: Column, mean: Column | float, random: np.random.Generator) -> Surroundings:
    """Air of a room with a mean temperature, of each row or of all [degC]."""
    n = len(seconds)
    temperature = mean + 0.25 * remembering(seconds, 900.0, random)
    humidity = np.clip(random.uniform(0.3, 0.6) + 0.02 * remembering(seconds, 1800.0, random), 0.1, 0.95)
    zeros = np.zeros(n)
    return Surroundings(
        temperature=np.asarray(temperature),
        relative_humidity=humidity,
        pressure=np.full(n, random.uniform(96e3, 102.5e3)) + 30 * remembering(seconds, 6 * _HOUR, random),
        wind_along=zeros,
        wind_across=zeros.copy(),
        radiation=zeros.copy(),
        supply=np.ones(n) + 0.004 * remembering(seconds, 60.0, random),
    )


def weather(
    seconds: Column,
    random: np.random.Generator,
    *,
    open_air: float = 1.0,
    mean: tuple[float, float] = (6.0, 20.0),
    swing: tuple[float, float] = (3.0, 7.0),
    humidity: float = 0.65,
    noon: float = 900.0,
) -> Surroundings:
    """Air outdoors, or behind a thin wall: days, weather, sun, wind.

    `open_air` is the factor of wind and sun, `mean` the range of the mean temperature [degC], `swing` that of
    half of what a clear day changes [K], and `noon` the radiation at a clear noon [W/m2].
    """
    n, hours = len(seconds), seconds / _HOUR % 24
    sun = np.maximum(0.0, np.sin(2 * np.pi * (hours - 6) / 24))
    clouds = np.clip(0.7 + 0.3 * remembering(seconds, 3 * _HOUR, random), 0.1, 1.0)
    day = random.uniform(*swing) * np.sin(2 * np.pi * (hours - 9) / 24) * clouds.mean()
    front = remembering(seconds, 1.5 * _DAY, random)
    temperature = random.uniform(*mean) + day + 2.5 * front + 0.5 * remembering(seconds, _HOUR, random)
    damp = humidity - 0.022 * day - 0.06 * front + 0.05 * remembering(seconds, 2 * _HOUR, random)
    gusts = np.abs(random.uniform(1.5, 3.5) * (0.5 + 0.5 * remembering(seconds, _HOUR, random)))
    toward = random.uniform(0, 2 * np.pi) + 0.5 * remembering(seconds, 2 * _HOUR, random)
    return Surroundings(
        temperature=temperature,
        relative_humidity=np.clip(damp, 0.15, 1.0),
        pressure=random.uniform(96e3, 102e3) + 700 * remembering(seconds, 2 * _DAY, random),
        wind_along=open_air * gusts * np.cos(toward),
        wind_across=open_air * gusts * np.sin(toward),
        radiation=open_air * noon * sun * clouds,
        supply=np.ones(n) + 0.005 * remembering(seconds, 600.0, random),
    )


def placements(name: str, visits: list[float], each: int, means: list[float], random: Random) -> Campaign:
    """A room in which somebody places a target and reads it some times; a mean temperature each visit."""
    own = random("design")
    placement = np.repeat(np.arange(len(visits)), each)
    order = np.tile(np.arange(each), len(visits))
    start = np.cumsum(own.uniform(25.0, 70.0, len(visits)) + 0.2 * each)
    warmer = np.cumsum(np.concatenate([[0.0], np.where(np.abs(np.diff(means)) > 1, 2 * _HOUR, 0.0)]))
    seconds = (start + warmer)[placement] + 0.2 * order
    distance = np.asarray(visits)[placement]
    return Campaign(
        name,
        seconds,
        distance + own.normal(0.0, 0.2e-3, len(visits))[placement],
        placement,
        room(seconds, np.asarray(means)[placement], own),
        reference=tape(distance, placement, 1e-3, own),
        turbulence=INDOORS,
        by_hand=True,
    )


def _bench(name: str, each: int, random: Random, *, mixed: bool = False) -> Campaign:
    own = random("visits", kept=True)
    far = own.uniform(2.2, 3.6)
    places = np.round(np.linspace(own.uniform(0.15, 0.3), far, 8), 2)
    if mixed:  # far and near in turn
        places = np.array([place for pair in zip(places[::-1], places, strict=True) for place in pair])[:8]
    cold = own.uniform(14, 22)
    means = [cold] * 8 + [cold + own.uniform(6, 12)] * 8
    return placements(name, [*places, *places], each, means, random)


@_design
def bench(random: Random) -> Campaign:
    """A student's ruler: eight distances in ascending order, 25 readings each, at two temperatures."""
    return _bench("bench", 25, random)


@_design
def quick(random: Random) -> Campaign:
    """The same with three readings a placement."""
    return _bench("quick", 3, random)


@_design
def far_and_near(random: Random) -> Campaign:
    """The same distances, far and near in turn, 25 readings each."""
    return _bench("far_and_near", 25, random, mixed=True)


@_design
def classroom(random: Random) -> Campaign:
    """Ten places on a tape that is read to the centimeter, ten readings each; nobody numbers them."""
    own = random("visits", kept=True)
    visits = np.sort(own.uniform(0.2, 3.2, 10))
    made = placements("classroom", list(visits), 10, [own.uniform(15, 25)] * 10, random)
    made.reference = tape(made.distance, made.placement, 1e-2, random("reference"))
    made.numbered = False
    return made


@_design
def round_robin(random: Random) -> Campaign:
    """Six distances in eight rounds of another order, five readings a visit, while the room warms up."""
    own = random("visits", kept=True)
    places = np.round(own.uniform(0.2, 3.2, 6), 2)
    visits = np.concatenate([own.permutation(places) for _ in range(8)])
    means = np.linspace(own.uniform(12, 18), own.uniform(22, 30), len(visits))
    return placements("round_robin", list(visits), 5, list(means), random)


@_design
def robot(random: Random) -> Campaign:
    """A robot that stops at 60 places, one to five readings each; it knows the distance to 2 mm."""
    own = random("visits", kept=True)
    visits = np.repeat(own.uniform(0.2, 3.5, 60), own.integers(1, 6, 60))
    made = placements("robot", list(visits), 1, list(np.full(len(visits), own.uniform(15, 25))), random)
    made.placement = np.cumsum(np.concatenate([[0], np.diff(visits) != 0]))
    made.seconds = made.placement * 8.0 + 0.1 * np.arange(len(visits))
    made.distance = visits
    made.reference = np.round(visits + random("reference").normal(0, 2e-3, 60)[made.placement], 4)
    return made


def _log(
    name: str, days: float, interval: float, distance: Callable[[Column], Column], random: Random, *, air: str
) -> Campaign:
    """A logger in one place; `distance` of the time."""
    own = random("design")
    seconds = np.arange(0.0, days * _DAY, interval) + own.uniform(0, _HOUR)
    true = distance(seconds)
    around = room(seconds, own.uniform(14, 22) + 3 * np.sin(2 * np.pi * seconds / _DAY), own)
    if air != "room":
        around = weather(seconds, own, open_air=1.0 if air == "open" else 0.0)
    moved = np.concatenate([[0], np.cumsum(np.abs(np.diff(true)) > 0.02)])
    return Campaign(
        name,
        seconds,
        true,
        moved.astype(np.int64),
        around,
        reference=true.copy(),
        turbulence=OUTDOORS if air == "open" else INDOORS,
        slow_air=0.15 if air == "open" else 0.1,
    )


@_design
def outdoor(random: Random) -> Campaign:
    """One target in the open for five days, a reading every ten minutes; its distance is not known."""
    place = random("visits", kept=True).uniform(1.2, 3.0)
    made = _log("outdoor", 5, 600.0, lambda s: np.full(len(s), place), random, air="open")
    made.reference, made.unknown_constant = None, True
    return made


@_design
def warehouse(random: Random) -> Campaign:
    """Three shelves at known distances, read in turn for ten days behind a thin wall."""
    own = random("visits", kept=True)
    places = np.round([own.uniform(0.4, 1.0), own.uniform(1.3, 2.2), own.uniform(2.5, 3.5)], 3)

    def shelf(seconds: Column) -> Column:
        return np.asarray(places[np.arange(len(seconds)) % 3], dtype=float)

    made = _log("warehouse", 10, 900.0, shelf, random, air="hall")
    made.placement = np.arange(len(made)) % 3
    return made


@_design
def daily(random: Random) -> Campaign:
    """A target that is moved once a day for twelve days, a reading every 20 minutes."""
    own = random("visits", kept=True)
    places = np.round(own.uniform(0.3, 3.2, 13), 2)
    made = _log(
        "daily",
        12,
        1200.0,
        lambda s: np.asarray(places[(s // _DAY).astype(int)], dtype=float),
        random,
        air="hall",
    )
    made.by_hand = True
    made.reference = tape(made.distance, made.placement, 1e-3, random("reference"))
    return made


@_design
def tank(random: Random) -> Campaign:
    """A tank that is filled and used for six days; a float gauge tells the level to 2 mm."""
    own = random("visits", kept=True)
    low, span, period = own.uniform(0.4, 0.7), own.uniform(0.6, 1.4), own.uniform(0.8, 2.2) * _DAY
    made = _log("tank", 6, 600.0, lambda s: low + span * (s / period % 1.0), random, air="hall")
    made.placement[:] = 0
    made.reference = np.round(made.distance + random("reference").normal(0, 2e-3, len(made)), 3)
    return made


@_design
def snow(random: Random) -> Campaign:
    """A mast over ground and snow for 30 days, every hour; a stake tells the depth to the centimeter."""
    own = random("visits", kept=True)

    def surface(seconds: Column) -> Column:
        falls = own.uniform(seconds[0], seconds[-1], 5)
        depth = sum(own.uniform(0.03, 0.15) * np.clip((seconds - at) / (5 * _HOUR), 0, 1) for at in falls)
        return np.asarray(own.uniform(1.6, 2.4) - 0.8 * np.asarray(depth))

    made = _log("snow", 30, _HOUR, surface, random, air="open")
    made.around.temperature -= 12.0
    made.air, made.device_temperature = made.around.temperature.copy(), made.around.temperature.copy()
    made.placement[:] = 0
    made.reference = np.round(made.distance, 2)
    return made
