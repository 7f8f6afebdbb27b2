from collections.abc import Callable
from typing import Any, final, overload

import numpy as np
from numpy.typing import ArrayLike, NDArray

__version__: str

_Column = NDArray[np.float64]
_Form = tuple[int | None, list[int], list[int], list[tuple[float, float]], float]
_Weighed = tuple[float, _Column, _Column, _Column, float]

@final
class Model:
    def __new__(cls, law: str, effects: list[tuple[str, list[tuple[str, float]]]]) -> Model: ...
    @property
    def law(self) -> str: ...
    @property
    def law_reads(self) -> list[str]: ...
    @property
    def terms(self) -> list[tuple[str, list[float]]]: ...
    def indicate(
        self,
        distance: ArrayLike | Any,
        conditions: list[Any],
        out: NDArray[Any] | None = None,
        n_threads: int | None = None,
    ) -> Any: ...
    def speed_of_sound(
        self,
        distance: ArrayLike | Any,
        conditions: list[Any],
        out: NDArray[Any] | None = None,
        n_threads: int | None = None,
    ) -> Any: ...
    def time_of_flight(
        self,
        distance: ArrayLike | Any,
        conditions: list[Any],
        out: NDArray[Any] | None = None,
        n_threads: int | None = None,
    ) -> Any: ...
    def correct(
        self,
        indication: ArrayLike | Any,
        conditions: list[Any],
        out: NDArray[Any] | None = None,
        n_threads: int | None = None,
    ) -> Any: ...
    def distance(
        self,
        time: ArrayLike | Any,
        conditions: list[Any],
        out: NDArray[Any] | None = None,
        n_threads: int | None = None,
    ) -> Any: ...
    def jacobian(self, distance: _Column, conditions: list[_Column]) -> NDArray[np.float64]: ...

def departure(law: str | None, row: list[float]) -> tuple[str, float, float, float, str] | None: ...
def departure_names() -> list[str]: ...
def departures(law: str | None, columns: list[_Column]) -> NDArray[np.uint8]: ...

@final
class Firmware:
    def files(self, measured: list[dict[str, Any]]) -> list[tuple[str, str]]: ...
    def ranked_by(self) -> tuple[int, int]: ...
    def steps(self) -> list[tuple[str, int]]: ...
    def evaluate(self, codes: list[NDArray[np.int64]]) -> NDArray[np.int32]: ...

def echo_times(
    model: Model, request: dict[str, Any], distances: list[float]
) -> list[tuple[float, float]]: ...
def design_firmware(
    model: Model, request: dict[str, Any], progress: Callable[[str, int, int], object] | None
) -> Firmware: ...
def weigh(
    products: NDArray[np.float64],
    log_weight: NDArray[np.float64],
    degrees: float,
    finest: float,
    hypotheses: list[list[_Form]],
    one_width: bool,
) -> list[_Weighed]: ...
def posterior(
    products: NDArray[np.float64],
    log_weight: NDArray[np.float64],
    degrees: float,
    finest: float,
    forms: list[_Form],
    causes: list[float],
    shape: float,
    hopeless: float,
) -> tuple[list[tuple[list[int], float, _Weighed]], list[bool], int]: ...
def log_density(values: NDArray[np.float64], freedom: float) -> NDArray[np.float64]: ...
def slips(
    left: NDArray[np.float64],
    step: NDArray[np.float64],
    cells: NDArray[np.int64],
    stretches: NDArray[np.int64],
    orders: list[float],
    freedom: float,
    spread: float,
    level: NDArray[np.float64],
    scale: float,
) -> tuple[float, NDArray[np.float64], float, NDArray[np.float64]]: ...

@final
class Columns:
    def __new__(
        cls,
        base: Model,
        distance: NDArray[np.float64],
        recorded: list[float | NDArray[np.float64]],
        groups: NDArray[np.uint32] | None,
    ) -> Columns: ...
    def __len__(self) -> int: ...
    def slope(self) -> int: ...
    def store(self, column: NDArray[np.float64]) -> int: ...
    def shift(
        self, id: str, parameters: list[tuple[str, float]], levels: NDArray[np.float64] | None
    ) -> int: ...
    def tangent(
        self,
        id: str,
        parameters: list[tuple[str, float]],
        at_work: bool,
        levels: NDArray[np.float64] | None,
        parameter: str,
        scale: float,
    ) -> int: ...
    def legendre(
        self, column: NDArray[np.float64], low: float, high: float, first: int, scales: list[float]
    ) -> list[int]: ...
    def waves(self, column: NDArray[np.float64], period: float, scales: list[float]) -> list[int]: ...
    def settle(self) -> None: ...
    def combined(self, chosen: list[tuple[int, float]]) -> NDArray[np.float64]: ...
    def made(self, chosen: list[int], rows: NDArray[np.uintp] | None = None) -> NDArray[np.float64]: ...
    def gram(self) -> NDArray[np.float64]: ...
    def products(
        self,
        starts: NDArray[np.bool_],
        blocks: NDArray[np.uint32],
        cells: NDArray[np.uint32],
        distance: NDArray[np.float64],
        places: list[tuple[int, int]],
        series: NDArray[np.float64],
        memories: list[float | tuple[float, float] | None],
        flat_level: bool,
    ) -> Sums: ...

@final
class Sums:
    @property
    def width(self) -> int: ...
    def whiten(
        self,
        noises: list[tuple[int, float, float, float, float]],
        used: list[bool],
        chosen: list[int] | None = None,
    ) -> tuple[NDArray[np.float64], _Column]: ...
    def join(self, more: Sums) -> None: ...
    def clear_infinite(self) -> list[bool]: ...

def whitened(
    remembered: float | tuple[float, float] | None,
    rho: float,
    first_weight: float,
    values: NDArray[np.float64],
    starts: NDArray[np.bool_],
    distance: NDArray[np.float64],
) -> tuple[_Column, float]: ...
def left_over(products: NDArray[np.float64], degrees: float, variance: float, finest: float) -> float: ...
def effects() -> list[dict[str, Any]]: ...
def laws() -> list[dict[str, Any]]: ...
def quantities() -> list[dict[str, Any]]: ...
@overload
def speed_of_sound(
    temperature: float,
    relative_humidity: float = 0.0,
    pressure: float = 101325.0,
    co2_mole_fraction: float = 0.0004,
    *,
    law: str = "cramer",
    frequency: float = 0.0,
    out: None = None,
    where: None = None,
    n_threads: int | None = None,
) -> float: ...
@overload
def speed_of_sound(
    temperature: ArrayLike | Any,
    relative_humidity: ArrayLike | Any = 0.0,
    pressure: ArrayLike | Any = 101325.0,
    co2_mole_fraction: ArrayLike | Any = 0.0004,
    *,
    law: str = "cramer",
    frequency: ArrayLike | Any = 0.0,
    out: NDArray[Any] | None = None,
    where: ArrayLike | None = None,
    n_threads: int | None = None,
) -> Any: ...
@overload
def time_of_flight(
    distance: float,
    temperature: float,
    relative_humidity: float = 0.0,
    pressure: float = 101325.0,
    co2_mole_fraction: float = 0.0004,
    *,
    law: str = "cramer",
    frequency: float = 0.0,
    out: None = None,
    where: None = None,
    n_threads: int | None = None,
) -> float: ...
@overload
def time_of_flight(
    distance: ArrayLike | Any,
    temperature: ArrayLike | Any,
    relative_humidity: ArrayLike | Any = 0.0,
    pressure: ArrayLike | Any = 101325.0,
    co2_mole_fraction: ArrayLike | Any = 0.0004,
    *,
    law: str = "cramer",
    frequency: ArrayLike | Any = 0.0,
    out: NDArray[Any] | None = None,
    where: ArrayLike | None = None,
    n_threads: int | None = None,
) -> Any: ...
@overload
def distance(
    time_of_flight: float,
    temperature: float,
    relative_humidity: float = 0.0,
    pressure: float = 101325.0,
    co2_mole_fraction: float = 0.0004,
    *,
    law: str = "cramer",
    frequency: float = 0.0,
    out: None = None,
    where: None = None,
    n_threads: int | None = None,
) -> float: ...
@overload
def distance(
    time_of_flight: ArrayLike | Any,
    temperature: ArrayLike | Any,
    relative_humidity: ArrayLike | Any = 0.0,
    pressure: ArrayLike | Any = 101325.0,
    co2_mole_fraction: ArrayLike | Any = 0.0004,
    *,
    law: str = "cramer",
    frequency: ArrayLike | Any = 0.0,
    out: NDArray[Any] | None = None,
    where: ArrayLike | None = None,
    n_threads: int | None = None,
) -> Any: ...
@overload
def error(
    distance: float,
    temperature: float,
    relative_humidity: float = 0.0,
    pressure: float = 101325.0,
    co2_mole_fraction: float = 0.0004,
    *,
    reading_speed: str | float = "linear",
    law: str = "cramer",
    frequency: float = 0.0,
    out: None = None,
    where: None = None,
    n_threads: int | None = None,
) -> float: ...
@overload
def error(
    distance: ArrayLike | Any,
    temperature: ArrayLike | Any,
    relative_humidity: ArrayLike | Any = 0.0,
    pressure: ArrayLike | Any = 101325.0,
    co2_mole_fraction: ArrayLike | Any = 0.0004,
    *,
    reading_speed: str | float = "linear",
    law: str = "cramer",
    frequency: ArrayLike | Any = 0.0,
    out: NDArray[Any] | None = None,
    where: ArrayLike | None = None,
    n_threads: int | None = None,
) -> Any: ...
@overload
def absorption(
    temperature: float,
    relative_humidity: float,
    pressure: float,
    frequency: float,
    *,
    out: None = None,
    where: None = None,
    n_threads: int | None = None,
) -> float: ...
@overload
def absorption(
    temperature: ArrayLike | Any,
    relative_humidity: ArrayLike | Any,
    pressure: ArrayLike | Any,
    frequency: ArrayLike | Any,
    *,
    out: NDArray[Any] | None = None,
    where: ArrayLike | None = None,
    n_threads: int | None = None,
) -> Any: ...
def instruction_sets() -> list[str]: ...
def set_instruction_set(name: str | None) -> None: ...
