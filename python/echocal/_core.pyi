from collections.abc import Callable, Sequence
from typing import Any, final, overload

import numpy as np
from numpy.typing import ArrayLike, NDArray

__version__: str

_Column = NDArray[np.float64]
_Correlation = float | tuple[float, float, bool] | None

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
    def files(
        self, measured: list[dict[str, Any]], uncertainty: dict[str, Any] | None
    ) -> list[tuple[str, str]]: ...
    def unit_files(self, layout: str) -> list[tuple[str, str]]: ...
    def air_files(self, layout: str) -> list[tuple[str, str]]: ...
    def ranked_by(self) -> tuple[int, int]: ...
    def steps(self) -> list[tuple[str, int]]: ...
    def filtered(
        self, distances: NDArray[np.int32], statuses: NDArray[np.uint8]
    ) -> tuple[NDArray[np.int32], NDArray[np.uint8]] | None: ...
    def evaluate(self, codes: list[NDArray[np.int64]]) -> tuple[NDArray[np.int32], NDArray[np.uint8]]: ...

def echo_times(
    model: Model, request: dict[str, Any], distances: list[float]
) -> list[tuple[float, float]]: ...
def firmware_targets() -> tuple[list[str], list[str]]: ...
def output_units() -> list[tuple[str, str]]: ...
def design_firmware(
    model: Model, request: dict[str, Any], progress: Callable[[str, int, int], object] | None
) -> Firmware: ...

@final
class Form:
    def __new__(
        cls,
        cause: int | None,
        offsets: Sequence[int],
        free: Sequence[int],
        bounds: Sequence[tuple[float, float]],
        weight: float,
    ) -> Form: ...
    @property
    def cause(self) -> int | None: ...
    @property
    def offsets(self) -> list[int]: ...
    @property
    def free(self) -> list[int]: ...
    @property
    def bounds(self) -> list[tuple[float, float]]: ...
    @property
    def weight(self) -> float: ...

@final
class Prior:
    def __new__(cls, causes: list[float], unexplained: float) -> Prior: ...
    @property
    def causes(self) -> list[float]: ...
    @property
    def unexplained(self) -> float: ...
    def no_cause(self, terms: bool) -> float: ...

@final
class SearchOptions:
    def __new__(cls, pruning_log_odds: float, form_preference: float, unlisted: float) -> SearchOptions: ...
    @property
    def pruning_log_odds(self) -> float: ...
    @property
    def form_preference(self) -> float: ...
    @property
    def unlisted(self) -> float: ...

@final
class HypothesisFit:
    @property
    def log_evidence(self) -> float: ...
    @property
    def mean(self) -> _Column: ...
    @property
    def covariance(self) -> _Column: ...
    @property
    def noise(self) -> _Column: ...
    @property
    def variance(self) -> float: ...

@final
class Outcome:
    @property
    def forms(self) -> list[int]: ...
    @property
    def prior(self) -> float: ...
    @property
    def fit(self) -> HypothesisFit: ...

@final
class Posterior:
    @property
    def outcomes(self) -> list[Outcome]: ...
    @property
    def noises(self) -> list[bool]: ...
    @property
    def systems(self) -> int: ...

def fit_hypotheses(
    products: NDArray[np.float64],
    log_weight: NDArray[np.float64],
    degrees: float,
    variance_floor: float,
    hypotheses: list[list[Form]],
    one_width: bool,
) -> list[HypothesisFit]: ...
def posterior(
    products: NDArray[np.float64],
    log_weight: NDArray[np.float64],
    degrees: float,
    variance_floor: float,
    forms: list[Form],
    prior: Prior,
    options: SearchOptions,
) -> Posterior: ...
def preferred_form(log_odds: list[float], coefficients: list[int], form_preference: float) -> int: ...

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
        self,
        column: NDArray[np.float64],
        low: float,
        high: float,
        first: int,
        scales: list[float],
        lines: list[tuple[float, float]],
    ) -> list[int]: ...
    def waves(
        self,
        column: NDArray[np.float64],
        period: float,
        scales: list[float],
        means: list[tuple[float, float]],
    ) -> list[int]: ...
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
        correlations: list[_Correlation],
        flat_level: bool,
    ) -> Sums: ...

@final
class Scanner:
    def __new__(
        cls, separator: int, width: int, comments: bool, braces: bool, repeated: list[bytes]
    ) -> Scanner: ...
    def scan(self, data: bytes, last: bool) -> Lines: ...

@final
class Lines:
    def __len__(self) -> int: ...
    @property
    def data(self) -> bytes: ...
    @property
    def taken(self) -> int: ...
    @property
    def count(self) -> int: ...
    @property
    def wrong(self) -> tuple[str, int, int, int, bytes] | None: ...
    def unread(self) -> list[tuple[int, int, int, bool]]: ...
    def records(self) -> list[tuple[int, int, int, list[bytes] | None, bool | None]]: ...
    def short(self) -> list[tuple[int, int]]: ...
    def numbers(
        self, places: list[int], decimal: int, absent: list[bytes]
    ) -> list[tuple[_Column, bool] | None]: ...
    def texts(self, places: list[int]) -> list[tuple[bytes, NDArray[np.int32]]]: ...
    def with_results(
        self,
        distance: NDArray[np.float64],
        uncertainty: NDArray[np.float32],
        codes: NDArray[np.int16],
        status: list[bytes],
        decimal: int,
    ) -> NDArray[np.uint8]: ...

@final
class NoiseModel:
    def __new__(
        cls, correlation: int, rho: float, station_ratio: float, first_weight: float, log_prior: float
    ) -> NoiseModel: ...
    @property
    def correlation(self) -> int: ...
    @property
    def rho(self) -> float: ...
    @property
    def station_ratio(self) -> float: ...
    @property
    def first_weight(self) -> float: ...
    @property
    def log_prior(self) -> float: ...

@final
class Sums:
    @property
    def width(self) -> int: ...
    def whiten(self, noises: list[NoiseModel], used: list[bool]) -> tuple[NDArray[np.float64], _Column]: ...
    def joined(self, more: Sums) -> Sums: ...
    def without_infinite(self) -> tuple[Sums, list[bool]]: ...

def whitened(
    correlation: _Correlation,
    rho: float,
    first_weight: float,
    values: NDArray[np.float64],
    starts: NDArray[np.bool_],
    distance: NDArray[np.float64],
) -> tuple[_Column, float]: ...
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
