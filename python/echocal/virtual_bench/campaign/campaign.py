"""One measuring campaign: what is true in every row, who measures, and who writes it down."""

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from echocal.virtual_bench.waveform.fluctuations import Turbulence
from echocal.virtual_bench.waveform.sensor import Sensor
from echocal.virtual_bench.waveform.target import Target

__all__ = ["INTERFERENCE", "TILT", "Campaign", "Random", "Surroundings"]

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
