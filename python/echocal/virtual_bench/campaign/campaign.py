"""One measuring campaign: what is true in every row, who measures, who writes it down, what acts."""

from collections.abc import Callable
from dataclasses import dataclass, field
from numbers import Real
from typing import Any

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from echocal.errors import UsageError
from echocal.virtual_bench.waveform.fluctuations import Turbulence
from echocal.virtual_bench.waveform.sensor import Sensor
from echocal.virtual_bench.waveform.target import Target

Column = NDArray[np.float64]
Labels = NDArray[np.int64]


# Of a placement: tilt [rad] and logarithm of the amplitude. The first is an assumption. The second is set by
# hand: with it as many near placements stand on another cycle as in a real record (docs/virtual-bench.md).
TILT, INTERFERENCE = 0.02, 0.18
_REPLICATES = 1000  # above any byte of a name


class Random:
    """Random numbers by name: a stage draws the same whatever the other stages draw."""

    def __init__(self, seed: int, replicate: int = 0) -> None:
        """Take the seed of a table, and which of its replicates it is."""
        self.seed, self.replicate = seed, replicate

    def __call__(self, name: str, *, kept: bool = False) -> np.random.Generator:
        """Return the generator of a stage; what is `kept` is the same in every replicate."""
        further = [] if kept or not self.replicate else [_REPLICATES + self.replicate]
        return np.random.default_rng([self.seed, *name.encode(), *further])


@dataclass
class Surroundings:
    """What a log may record of the air and the supply, as it truly is."""

    # temperature, relative_humidity, pressure: of the air at the thermometer [degC], [0..1], [Pa]; shape (n,)
    temperature: Column
    relative_humidity: Column
    pressure: Column
    # wind_along, wind_across: [m/s]; shape (n,)
    wind_along: Column
    wind_across: Column
    radiation: Column  # of the sun [W/m2]; shape (n,)
    supply: Column  # over its nominal voltage; shape (n,)


@dataclass
class Campaign:
    """What a design lays down, and a cause changes."""

    design: str
    seconds: Column
    """True time of each reading [s]; shape (n,)."""
    distance: Column
    """True distance of the target [m]; shape (n,)."""
    placement: Labels
    """Number of the place of the target, from 0: as it was put up once, whenever it is looked at; shape
    (n,)."""
    around: Surroundings
    reference: Column | None
    """Distance that is written down [m]; None where nobody knows it; shape (n,)."""
    unknown_constant: bool = False
    """Whether the user says that the distance is constant instead."""
    numbered: bool = True
    """Whether the log has a column with the number of the placement, where somebody puts them up."""
    by_hand: bool = False
    """Whether somebody puts up each placement, and numbers them."""
    co2: float | Column = 4.2e-4
    """Mole fraction; shape (n,)."""
    sensor: Sensor = field(default_factory=Sensor)
    target: Target = field(default_factory=Target)
    second_thermometer: Column | None = None
    """What a thermometer at another place says [degC]; shape (n,)."""
    scene: dict[str, Any] = field(default_factory=dict)
    """Further arguments of `Scene`."""
    turbulence: Turbulence = field(default_factory=Turbulence)
    slow_air: float = 0.05
    """Standard deviation of the path's temperature about that at the thermometer [K]."""
    air: Column = field(init=False)
    """Temperature of the path [degC]: that of the air at the thermometer, and what causes add; shape (n,)."""
    device_temperature: Column = field(init=False)
    # thermometer, pulse, logger: stages of causes: of the recorded temperature, of the length of the pulse
    # [s], and of the finished table
    thermometer: list[Callable[[Column], Column]] = field(default_factory=list)
    pulse: list[Callable[[Column], Column]] = field(default_factory=list)
    logger: list[Callable[[pd.DataFrame], pd.DataFrame]] = field(default_factory=list)
    shown: set[str] = field(default_factory=set)
    """Columns that the log holds beside the usual ones."""

    def __post_init__(self) -> None:
        self.air = self.around.temperature.copy()
        self.device_temperature = self.around.temperature.copy()

    def __len__(self) -> int:
        return len(self.seconds)


Stage = Callable[[Campaign, float, np.random.Generator], None]

_MOST = 10.0  # times the largest usual size: more is a slip of the unit
_LEAST = 1e-6  # of the largest usual size: less shows in no table


@dataclass(frozen=True)
class Cause:
    """A cause and how it is staged.

    Attributes
    ----------
    id : str
        As in the catalogue of effects and noises, or a name of the bench where the catalogue has none.
    unit : str
        Of its size.
    low, high : float
        Usual sizes; a negative `low` of the same amount means either sign.
    sentence : str
    needs : frozenset of str
        What a design must have to show it: "time" (hours), "distances", "weather" (days of it), "visits"
        (known placements), "reference" (known distances).
    in_catalogue : bool
    stage : callable
    whole : bool
        Whether its size is a whole number.
    """

    id: str
    unit: str
    low: float
    high: float
    sentence: str
    needs: frozenset[str]
    in_catalogue: bool
    stage: Stage
    whole: bool = False

    def refused(self, offered: frozenset[str]) -> frozenset[str]:
        """What a design lacks without which there is nothing to stage; without weather a cause acts, too."""
        return self.needs - offered - {"weather"}

    def usual(self) -> str:
        """Write the usual sizes."""
        return f"+-{-self.low / 4:g} to {self.high:g}" if self.low < 0 else f"{self.low:g} to {self.high:g}"

    def check(self, size: float) -> float:
        """Return a size that somebody asks for.

        Raises `UsageError` if it is not a number, or of the wrong sign, or more than ten times the usual, or
        less than a millionth of it.
        """
        if isinstance(size, bool) or not isinstance(size, Real):
            message = f"{self.id}={size!r}: its size is a number [{self.unit}], or None for a usual one"
            raise UsageError(message)
        least = -_MOST * self.high if self.low < 0 else 0.0
        if not least <= size <= _MOST * self.high or abs(size) < _LEAST * self.high:
            limits = f"from {least:g} to {_MOST * self.high:g}, and not 0"
            raise UsageError(
                f"{self.id}={size:g}: its size is {limits} [{self.unit}]; usual is {self.usual()}, "
                f"and {self.id} without a size draws one"
            )
        if self.whole and size != round(size):
            message = f"{self.id}={size:g}: its size is a whole number [{self.unit}]; usual is {self.usual()}"
            raise UsageError(message)
        return float(size)

    def draw(self, random: np.random.Generator) -> float:
        """Draw a usual size, log-uniform."""
        if self.low < 0:
            return float(
                random.choice([-1, 1]) * np.exp(random.uniform(np.log(-self.low / 4), np.log(self.high)))
            )
        size = float(np.exp(random.uniform(np.log(self.low), np.log(self.high))))
        return float(round(size)) if self.whole else size


CAUSES: dict[str, Cause] = {}


def cause(
    unit: str,
    low: float,
    high: float,
    *needs: str,
    id: str = "",
    in_catalogue: bool = True,
    whole: bool = False,
) -> Callable[[Stage], Stage]:
    """Register a function that stages a cause; its name is the id, its docstring the sentence."""

    def register(stage: Stage) -> Stage:
        name = id or stage.__name__
        sentence = (stage.__doc__ or "").strip().splitlines()[0]
        CAUSES[name] = Cause(name, unit, low, high, sentence, frozenset(needs), in_catalogue, stage, whole)
        return stage

    return register
