"""The parts of a diagnosis, as data."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from echocal.model import Shape, Smooth

__all__ = [
    "HELD_OUT",
    "OF_THIS_TABLE",
    "Cause",
    "Gain",
    "Ladder",
    "NextMeasurement",
    "Parameter",
    "Refuted",
    "Remainder",
    "Shifted",
    "SmoothCorrection",
    "Traces",
    "Unexplained",
    "Verdict",
]

Verdict = Literal["named", "ambiguous", "unknown", "nothing"]
Column = NDArray[np.float64]
Ladder = tuple[tuple[tuple[str, ...], float], ...]

OF_THIS_TABLE = frozenset({"row", "time", "hour of day"})
"""Columns that no later reading has. A function of such a column cannot extend a model."""

HELD_OUT = "rows from"
"""A scheme that begins like this names rows that take no part in the choice or the fit of causes."""


@dataclass(frozen=True)
class Parameter:
    """A parameter of a cause with its standard uncertainty (0 where theory fixes it)."""

    name: str
    value: float
    standard_uncertainty: float
    unit: str


@dataclass(frozen=True)
class Cause:
    """A cause that the data support.

    Attributes
    ----------
    id : str
        Id in the registry.
    kind : str
        ``effect``, ``noise``, ``row`` or ``gross``.
    probability : float
        Of this cause or one of those that the data cannot separate from it.
    parameters : tuple of Parameter
    indistinguishable_from : tuple of str
        Causes that these data cannot separate from it.
    because : str
        A sentence that a user can check in the data.
    in_model : bool
        Whether the extended model has it. Where the verdict is ``ambiguous``, the model has the
        most probable causes, and none of their alternatives.
    doubt : str
        Why the cause is not named although it is probable; else empty.
    probability_alone : float or None
        Of this cause without those that the data cannot separate from it. None for noises and faults.
    contribution_m : float or None
        The most that it adds to a reading of these rows, up or down [m]; where the distance is not known,
        beside its mean. None for noises and faults.
    matters : bool
        Whether this is as much as the user minds. What matters is told; it decides no probability.
    """

    id: str
    kind: str
    probability: float
    parameters: tuple[Parameter, ...]
    indistinguishable_from: tuple[str, ...]
    because: str
    in_model: bool = True
    doubt: str = ""
    probability_alone: float | None = None
    contribution_m: float | None = None
    matters: bool = True


@dataclass(frozen=True)
class Refuted:
    """A cause that fits, but that cross-validated or held-out rows speak against.

    Attributes
    ----------
    id : str
    probability : float
        From the rows that causes are selected on.
    rms_with_m, rms_without_m : float
        Error on cross-validated or held-out rows with the cause and without it [m].
    indistinguishable_from : tuple of str
    together : tuple of str
        All causes that were refuted at once. The errors are then those of the model with all of
        them and of the base. Empty where the cause was refuted alone, beside the other causes.
    log_score : float or None
        Log density of these rows, under the noise, with the cause less that without it.
    """

    id: str
    probability: float
    rms_with_m: float
    rms_without_m: float
    indistinguishable_from: tuple[str, ...] = ()
    together: tuple[str, ...] = ()
    log_score: float | None = None


@dataclass(frozen=True)
class Unexplained:
    """A smooth function of one column that no cause of the catalogue explains.

    Attributes
    ----------
    against : str
        Name of the column.
    rms_m : float
        Size of what remains beside the model [m].
    probability : float
    description : str
    shape : Shape or None
        The function with its standard uncertainty.
    rms_without_m, rms_with_m : float or None
        Error of the model without the function and with it, on cross-validated or held-out rows
        [m]. None where no later reading has the column: then the function cannot extend a model.
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
        """Whether the function may extend the model: it does not make the error larger."""
        if self.rms_without_m is None or self.rms_with_m is None:
            return self.against not in OF_THIS_TABLE
        return self.rms_with_m < self.rms_without_m  # not, where no row can judge it


@dataclass(frozen=True)
class SmoothCorrection:
    """A smooth correction of what the model leaves: functions of recorded columns without a cause.

    Attributes
    ----------
    tried : tuple of str
        Columns that could take part.
    smooth : Smooth or None
        The correction; None if no column predicts rows that it is not fitted to.
    scheme : str
        How the rows were chosen that judge it.
    rms_before_m, rms_after_m : float or None
        Error of the model without the correction and with it [m], on rows that neither the choice of the
        columns and of the smoothness nor the fit has seen.
    held_out_rows : int
        Number of these rows.
    interval_95 : tuple of float, or None
        Of ``rms_before_m - rms_after_m`` [m].
    variance_removed : float or None
        Part of the mean square error of the model that the correction removes.
    variance_removed_interval_95 : tuple of float, or None
    chosen_by_folds : tuple of tuple of str
        Columns that each fold chooses by itself.
    rows_outside : int
        Rows of this table outside of a column's range, which keep the correction of the model.
    """

    tried: tuple[str, ...]
    smooth: Smooth | None
    scheme: str
    rms_before_m: float | None = None
    rms_after_m: float | None = None
    held_out_rows: int = 0
    interval_95: tuple[float, float] | None = None
    variance_removed: float | None = None
    variance_removed_interval_95: tuple[float, float] | None = None
    chosen_by_folds: tuple[tuple[str, ...], ...] = ()
    rows_outside: int = 0

    @property
    def refused(self) -> str:
        """Why it may not extend the model; empty where it may."""
        if self.smooth is None:
            return "no column predicts rows that it is not fitted to"
        if none := sum(not chosen for chosen in self.chosen_by_folds):
            folds = len(self.chosen_by_folds)
            return f"without the rows that judge it, {none} of {folds} folds choose no correction"
        if self.interval_95 is None:
            return "no row can judge it"
        return "" if self.interval_95[0] > 0.0 else "the interval of the gain is not above 0"

    @property
    def offered(self) -> bool:
        """Whether it may extend the model."""
        return not self.refused


@dataclass(frozen=True)
class Remainder:
    """An error that recorded columns could lower by far, though no cause is claimed for it.

    Attributes
    ----------
    rms_m : float
        Error of the model [m].
    rms_floor_m : float
        Error that all columns together reach [m], without what chance removes.
    p_value : float
        Probability that columns of noise would remove as much.
    degrees_of_freedom : tuple of float
        Effective ones of what the columns remove, and of what they leave.
    no_effect : float
        Posterior probability that there is neither an effect nor an unexplained term.
    against : tuple of str
        Columns that were tried.
    by_chance : bool
        Whether noise as autocorrelated as that of the table may be all that there is.
    turns : str
        A sentence where rows that take turns, and no column, explain most of the error; else empty.
    """

    rms_m: float
    rms_floor_m: float
    p_value: float
    degrees_of_freedom: tuple[float, float]
    no_effect: float
    against: tuple[str, ...]
    by_chance: bool
    turns: str = ""


@dataclass(frozen=True)
class Shifted:
    """The gain under other conditions than those of the fit.

    Attributes
    ----------
    against : str
        Column whose middle range the model is fitted to.
    low, high : float
        Ends of this range, in the unit of the quantity.
    rows : int
        Number of rows outside this range, on which the error is measured.
    rms_before_m, rms_after_m : float
        Error of these rows with the base simulation and with the model [m].
    """

    against: str
    low: float
    high: float
    rows: int
    rms_before_m: float
    rms_after_m: float


@dataclass(frozen=True)
class Gain:
    """What the extended model gains on rows that its parameters are not fitted to.

    Attributes
    ----------
    rms_fixed_speed_m : float or None
        Error of a device that converts these echoes with one fixed speed [m]. None where the
        diagnosis finds that the readings come from such a device.
    ladder : tuple of (tuple of str, float)
        Error [m] of the base alone, and as the causes are added one by one. The causes are those of the
        model; their sizes are fitted without the rows.
    rms_before_m, rms_after_m : float
        Error of the base simulation and of the extended model [m]. In a cross-validation, each fold
        chooses the causes without its rows: then it may differ from the end of the ladder.
    rms_floor_m : float
        Error that all columns together could reach, without what chance removes [m]. It is of the rows that
        causes are selected on, also where others are held out.
    held_out_rows : int
        Number of rows on which the errors are measured.
    fraction_of_reachable : float or None
        Part of the mean square error between base and floor that the model removes. None where the
        base is at the floor.
    interval_95 : tuple of float
        Of ``rms_before_m - rms_after_m`` [m], from resampled blocks of rows.
    variance_removed : float
        Part of the mean square error of the base that the model removes; negative where it adds to it.
    variance_removed_interval_95 : tuple of float
        From the same resampled blocks.
    scheme : str
        How these rows were chosen.
    shifted : tuple of Shifted
        The gain under other conditions: fitted to the middle range of a column, measured outside.
    log_score : float or None
        Log density of these rows, under the noise, with the extended model less that with the base. None
        where the model is the base, and of several tables.
    log_score_interval_95 : tuple of float or None
        Of the same, from contiguous pieces of rows. None where the units are visits: what a model adds
        differs from visit to visit with the distance, and these differences are no uncertainty.
    """

    rms_fixed_speed_m: float | None
    ladder: Ladder
    rms_before_m: float
    rms_after_m: float
    rms_floor_m: float
    held_out_rows: int
    fraction_of_reachable: float | None
    interval_95: tuple[float, float]
    variance_removed: float
    variance_removed_interval_95: tuple[float, float]
    scheme: str
    shifted: tuple[Shifted, ...] = ()
    log_score: float | None = None
    log_score_interval_95: tuple[float, float] | None = None

    @property
    def earned(self) -> bool:
        """Whether rows that were not fitted prove a gain: only then a cause is named.

        The interval of the gain is above zero, and so is that of the log score, or the log score where it has
        no interval. A pool has neither. The log score alone would name what removes one hundredth of the
        error, and what another window does not have.
        """
        least = self.log_score if self.log_score_interval_95 is None else self.log_score_interval_95[0]
        smaller = self.rms_after_m < self.rms_before_m and self.interval_95[0] > 0.0
        return smaller and (least is None or least > 0.0)

    @property
    def judged_rows(self) -> str:
        """``held-out rows``, or ``cross-validated rows`` where causes were selected on them."""
        return "held-out rows" if self.scheme.startswith(HELD_OUT) else "cross-validated rows"


@dataclass(frozen=True)
class NextMeasurement:
    """Rows, or a side measurement, that would separate causes.

    Attributes
    ----------
    conditions : mapping
        Where to measure, or ``{"side_measurement": ...}``.
    separates : tuple of str
    expected_probability : float or None
        Expected probability of the most probable set of effects after the measurement, from a
        simulation that counts exact aliases as one set. None for a side measurement.
    probability_now : float or None
        Probability of the most probable set of effects before the measurement.
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
        Held-out rows, which take no part in any fit; all False in a cross-validation.
    against : mapping of str to ndarray
        Recorded columns by name, in SI units.
    begin : datetime64, optional
        The instant (UTC) that the column `time` counts from; None where the table has no dates.
    """

    row: NDArray[np.int64]
    before: Column
    after: Column
    held_out: NDArray[np.bool_]
    against: Mapping[str, Column]
    begin: np.datetime64 | None = None
