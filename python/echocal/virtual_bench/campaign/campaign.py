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
    """What a log may record of the air and the supply, as it truly is.

    Attributes
    ----------
    temperature, relative_humidity, pressure : ndarray, shape (n,)
        Of the air at the thermometer [degC], [0..1], [Pa].
    wind_along, wind_across : ndarray, shape (n,)
        [m/s].
    radiation : ndarray, shape (n,)
        Of the sun [W/m2].
    supply : ndarray, shape (n,)
        Over its nominal voltage.
    """

    temperature: Column
    relative_humidity: Column
    pressure: Column
    wind_along: Column
    wind_across: Column
    radiation: Column
    supply: Column


@dataclass
class Campaign:
    """What a design lays down, and a cause changes.

    Attributes
    ----------
    design : str
    seconds : ndarray, shape (n,)
        True time of each reading [s].
    distance : ndarray, shape (n,)
        True distance of the target [m].
    placement : ndarray of int, shape (n,)
        Number of the place of the target, from 0: as it was put up once, whenever it is looked at.
    around : Surroundings
    reference : ndarray, shape (n,), or None
        Distance that is written down [m]; None where nobody knows it.
    unknown_constant : bool
        Whether the user says that the distance is constant instead.
    air : ndarray, shape (n,)
        Temperature of the path [degC]: that of the air at the thermometer, and what causes add.
    numbered : bool
        Whether the log has a column with the number of the placement, where somebody puts them up.
    by_hand : bool
        Whether somebody puts up each placement, and numbers them.
    co2 : float or ndarray, shape (n,)
        Mole fraction.
    sensor : Sensor
    target : Target
    second_thermometer : ndarray, shape (n,), or None
        What a thermometer at another place says [degC].
    scene : dict
        Further arguments of `Scene`.
    turbulence : Turbulence
    slow_air : float
        Standard deviation of the path's temperature about that at the thermometer [K].
    thermometer, pulse, logger : list of function
        Stages of causes: of the recorded temperature, of the length of the pulse [s], and of the finished
        table.
    shown : set of str
        Columns that the log holds beside the usual ones.
    """

    design: str
    seconds: Column
    distance: Column
    placement: Labels
    around: Surroundings
    reference: Column | None
    unknown_constant: bool = False
    numbered: bool = True
    by_hand: bool = False
    co2: float | Column = 4.2e-4
    sensor: Sensor = field(default_factory=Sensor)
    target: Target = field(default_factory=Target)
    second_thermometer: Column | None = None
    scene: dict[str, Any] = field(default_factory=dict)
    turbulence: Turbulence = field(default_factory=Turbulence)
    slow_air: float = 0.05
    air: Column = field(init=False)
    device_temperature: Column = field(init=False)
    thermometer: list[Callable[[Column], Column]] = field(default_factory=list)
    pulse: list[Callable[[Column], Column]] = field(default_factory=list)
    logger: list[Callable[[pd.DataFrame], pd.DataFrame]] = field(default_factory=list)
    shown: set[str] = field(default_factory=set)

    def __post_init__(self) -> None:
        self.air = self.around.temperature.copy()
        self.device_temperature = self.around.temperature.copy()

    def __len__(self) -> int:
        return len(self.seconds)
