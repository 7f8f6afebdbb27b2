"""The parts of a diagnosis, as data."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from echocal.model import Shape

__all__ = [
    "OF_THIS_TABLE",
    "Cause",
    "Gain",
    "Ladder",
    "NextMeasurement",
    "Parameter",
    "Refuted",
    "Shifted",
    "Traces",
    "Unexplained",
    "Verdict",
]

Verdict = Literal["named", "ambiguous", "unknown", "nothing"]
Column = NDArray[np.float64]
Ladder = tuple[tuple[tuple[str, ...], float], ...]

OF_THIS_TABLE = frozenset({"row", "time", "hour of day"})
"""Columns that no later reading has: what follows them cannot extend a model."""


@dataclass(frozen=True)
class Parameter:
    """A parameter of a cause with its standard uncertainty (0 where theory fixes it)."""

    name: str
    value: float
    standard_uncertainty: float
    unit: str


@dataclass(frozen=True)
class Cause:
    """A cause that the data speak for.

    Attributes
    ----------
    id : str
        Id in the registry.
    kind : str
        ``effect``, ``noise``, ``row`` or ``gross``.
    probability : float
        That this cause, or one of those it cannot be told from, is at work.
    parameters : tuple of Parameter
    indistinguishable_from : tuple of str
        Causes that these data cannot tell it from.
    because : str
        A sentence that a user can check in the data.
    in_model : bool
        Whether the extended model has it. Where the verdict is ``ambiguous``, the most probable
        causes stand in the model and those that might be at work instead of them do not.
    doubt : str
        Why the cause is not named for all its probability; empty where nothing speaks against it.
    """

    id: str
    kind: str
    probability: float
    parameters: tuple[Parameter, ...]
    indistinguishable_from: tuple[str, ...]
    because: str
    in_model: bool = True
    doubt: str = ""


@dataclass(frozen=True)
class Refuted:
    """A cause that the fitted rows speak for and the rows never fitted speak against.

    Attributes
    ----------
    id : str
    probability : float
        By the fitted rows.
    rms_with_m, rms_without_m : float
        Error on rows never fitted with the cause and without it [m].
    indistinguishable_from : tuple of str
    together : tuple of str
        Where causes were refuted together, all of them: the errors are then those of the model
        with all of them and of the base. Empty where the cause was refuted beside others.
    """

    id: str
    probability: float
    rms_with_m: float
    rms_without_m: float
    indistinguishable_from: tuple[str, ...] = ()
    together: tuple[str, ...] = ()


@dataclass(frozen=True)
class Unexplained:
    """A shape that no cause of the catalogue accounts for.

    Attributes
    ----------
    against : str
        Column that it is a function of.
    rms_m : float
        Its size beside the model [m].
    probability : float
    description : str
    shape : Shape or None
        The function, with its band.
    rms_without_m, rms_with_m : float or None
        Error of the model on rows never fitted without the shape and with it [m]; None where no
        later reading has the column, so that it cannot extend a model.
    """

    against: str
    rms_m: float
    probability: float
    description: str
    shape: Shape | None = None
    rms_without_m: float | None = None
    rms_with_m: float | None = None

    @property
    def extends(self) -> bool:
        """Whether rows never fitted let the shape extend the model."""
        if self.rms_without_m is None or self.rms_with_m is None:
            return self.against not in OF_THIS_TABLE
        return not self.rms_with_m >= self.rms_without_m


@dataclass(frozen=True)
class Shifted:
    """The gain under other conditions than those of the fit.

    Attributes
    ----------
    against : str
        The column that tells them apart.
    low, high : float
        Its range in the rows that the model was fitted to, in the unit of the quantity.
    rows : int
        Rows outside, that it was judged by.
    rms_before_m, rms_after_m : float
        Their error with the base simulation and with the model [m].
    """

    against: str
    low: float
    high: float
    rows: int
    rms_before_m: float
    rms_after_m: float


@dataclass(frozen=True)
class Gain:
    """What the extended model gains on rows that its parameters never saw.

    Attributes
    ----------
    rms_fixed_speed_m : float or None
        Error of a device that converts these echoes with one fixed speed [m]; None where the
        readings are found to come from such a device already.
    ladder : tuple of (tuple of str, float)
        Error [m] as the causes join one by one, from the base alone to the extended model.
    rms_before_m, rms_after_m : float
        Error of the base simulation and of the extended model [m].
    rms_floor_m : float
        Error that every column together could reach on these rows, less what chance gives [m].
    held_out_rows : int
    fraction_of_reachable : float or None
        Part of the mean square between base and floor that the model removes; None where the
        base is at the floor.
    interval_95 : tuple of float
        Of ``rms_before_m - rms_after_m`` [m], from resampled blocks of rows.
    scheme : str
        How rows were held out.
    shifted : tuple of Shifted
        The same under other conditions: fitted to the middle of a column, judged outside.
    """

    rms_fixed_speed_m: float | None
    ladder: Ladder
    rms_before_m: float
    rms_after_m: float
    rms_floor_m: float
    held_out_rows: int
    fraction_of_reachable: float | None
    interval_95: tuple[float, float]
    scheme: str
    shifted: tuple[Shifted, ...] = ()


@dataclass(frozen=True)
class NextMeasurement:
    """Rows, or a side measurement, that would separate causes.

    Attributes
    ----------
    conditions : mapping
        Where to measure, or ``{"side_measurement": ...}``.
    separates : tuple of str
    expected_probability : float or None
        Probability that the first set of effects would then be the right one, exact aliases
        counted as one, by simulation; None for a side measurement.
    probability_now : float or None
        The same before measuring.
    """

    conditions: Mapping[str, Any]
    separates: tuple[str, ...]
    expected_probability: float | None
    probability_now: float | None = None


@dataclass(frozen=True)
class Traces:
    """Columns for plots, one entry per used row.

    Attributes
    ----------
    row : ndarray of int
        Position in the source.
    before, after : ndarray
        Reading less reference (or level) with the base and with the extended model [m].
    held_out : ndarray of bool
        Rows that no fit saw; all False where folds took turns.
    against : mapping of str to ndarray
        Recorded columns by name, in SI units.
    """

    row: NDArray[np.int64]
    before: Column
    after: Column
    held_out: NDArray[np.bool_]
    against: Mapping[str, Column]
