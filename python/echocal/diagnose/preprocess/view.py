"""A table as fault detectors see it: readings and their robust expectation."""

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from echocal.diagnose.preprocess.base import Base
from echocal.diagnose.preprocess.tape import printed_grid, step_of_the_tape
from echocal.diagnose.settings.noises import NoiseSettings
from echocal.observations import Observations
from echocal.observations.quantiles import MAD_TO_SD, median
from echocal.observations.quantization_grid import QuantizationGrid, find_grid

__all__ = ["View", "least_absolute"]

Column = NDArray[np.float64]
Mask = NDArray[np.bool_]

_ENOUGH = 20_000  # rows that are enough for a robust fit
_MANY = 100_000  # rows that are enough for a robust center
_ROUNDS = 12  # reweightings, for least absolute deviations to 0.1 %
_WINDOW = 13  # rows whose median is the expectation where no reference is known
_ANYHOW = 0.06  # of the distance: laws and thermometers are wrong by less
_NEAR = 0.05  # m: mounts are wrong by less
_PER_STEP = 0.6  # least scatter, in steps of the readings, for a step that hides the noise
_LEAST = 1e-5  # m, below the scatter of such sensors


@dataclass(frozen=True, eq=False)
class View:
    """A table for detectors; a repair makes a new one.

    Attributes
    ----------
    observations : Observations
    base : Base
    given : float or None
        Reference distance of every row [m], if the user gives it.
    known : bool
        Whether there is a reference distance.
    by_chance : float
        Probability below which a step that readings share with the stations is not theirs.
    """

    observations: Observations
    base: Base
    given: float | None
    known: bool
    by_chance: float = NoiseSettings.step_by_chance

    def __len__(self) -> int:
        return len(self.observations)

    def after(self, repaired: Observations) -> "View":
        """The view of a repaired table."""
        return replace(self, observations=repaired)

    def without(self, rows: Mask, reason: str, *, anyhow: bool = False) -> Observations:
        """Mark rows as unusable, with the reason; all rows are kept.

        `anyhow` gives this reason to rows that are unusable for another one, too.
        """
        unusable = self.observations.unusable.astype(object)
        unusable[rows & (self.observations.usable | anyhow)] = reason
        return replace(self.observations, unusable=unusable.astype(str))

    @cached_property
    def reference(self) -> Column | None:
        """Reference distance [m]; None if it is constant and unknown."""
        if not self.known:
            return None
        if self.given is not None:
            return np.full(len(self), self.given)
        return self.observations.reference_distance

    @cached_property
    def indication(self) -> Column:
        """Reading with the base's speed of sound [m], including rows that are out of range."""
        with np.errstate(all="ignore"):
            return self.base.indication(self.observations.echo_time, self.observations.conditions)

    @cached_property
    def temperature(self) -> Column | None:
        """Recorded temperature [degC]."""
        return self.observations.conditions.get("temperature")

    @cached_property
    def good(self) -> Mask:
        """Rows with all values that detectors need."""
        good = self.observations.usable & np.isfinite(self.indication)
        return good if self.reference is None else good & np.isfinite(self.reference)

    @cached_property
    def measured(self) -> Mask:
        """Rows with a reading, also one that is out of range, but none that a fault left out."""
        reasons = self.observations.unusable.astype(str)
        return (self.observations.usable | np.char.endswith(reasons, "out of range")) & np.isfinite(
            self.indication
        )

    @cached_property
    def expected(self) -> Column:
        """Reading of each row that follows from most of the rows [m]; NaN where it is unknown."""
        if self.reference is not None:
            return self.reference + self._bulk
        import pandas as pd  # takes long to import

        expected = np.full(len(self), np.nan)
        kept = pd.Series(self.indication[self.good])
        expected[self.good] = kept.rolling(_WINDOW, center=True, min_periods=1).median().to_numpy()
        return expected

    @cached_property
    def deviation(self) -> Column:
        """Reading less its expectation [m]."""
        return self.indication - self.expected

    @cached_property
    def farthest(self) -> float:
        """Largest known deviation [m]; a small one excludes many faults at once."""
        low, high = np.fmin.reduce(self.deviation, initial=0.0), np.fmax.reduce(self.deviation, initial=0.0)
        return float(max(-low, high))

    @cached_property
    def ratios(self) -> tuple[float, float]:
        """Smallest and largest ratio of reading to reference."""
        assert self.reference is not None
        with np.errstate(all="ignore"):
            ratio = self.indication / self.reference
        return float(np.fmin.reduce(ratio)), float(np.fmax.reduce(ratio))

    @cached_property
    def scatter(self) -> float:
        """Robust standard deviation of the deviation [m]."""
        judged = self.good & np.isfinite(self.deviation)
        inside = self.deviation if judged.all() else self.deviation[judged]
        least = max(_LEAST, _PER_STEP * self.resolution)
        return max(MAD_TO_SD * median(np.abs(inside)), least) if len(inside) else least

    @property
    def _values(self) -> Column:
        reading = self.observations.reading
        return self.observations.echo_time if reading is None else reading

    @cached_property
    def grid(self) -> QuantizationGrid | None:
        """Quantization of the recorded readings, or of the echo times where there are none."""
        grid = find_grid(np.where(self.good, self._values, np.nan))
        reading, reference = self.observations.reading, self.reference
        if reading is None or reference is None or not self.good.any():
            return grid
        at = reading[self.good], reference[self.good]
        if grid is None or step_of_the_tape(*at, grid.step, self.by_chance):
            return printed_grid(*at)
        return grid

    @cached_property
    def resolution(self) -> float:
        """Quantization step of the recorded readings or echo times [m]; 0 if there is none."""
        grid, values = self.grid, self._values
        if grid is None:
            return 0.0
        scale = float(np.median(self.indication[self.good] / values[self.good])) if self.good.any() else 1.0
        return grid.step * scale

    @cached_property
    def _bulk(self) -> Column:
        """Smooth part of reading less reference that most rows have [m]."""
        assert self.reference is not None
        columns = _smooth(self.reference, self.temperature)
        error = self.indication - self.reference
        sane = self.good & np.isfinite(error) & (self.reference > 0)
        sane &= np.isfinite(columns).all(axis=0)
        known = np.flatnonzero(sane)
        some = known[:: max(1, len(known) // _MANY)]  # a few percent are accurate enough
        center = median(error[some]) if len(some) else 0.0
        scale = median(error[some] / self.reference[some]) if len(some) else 0.0
        sane &= _near(error, self.reference, center, scale)  # outliers must not have leverage
        rows = np.flatnonzero(sane)
        rows = rows[:: max(1, len(rows) // _ENOUGH)]
        if len(rows) < 3 * len(columns):
            return np.full(len(self), float(np.median(error[rows])) if len(rows) else 0.0)
        return least_absolute(columns[:, rows], error[rows]) @ columns


def _near(error: Column, reference: Column, center: float, scale: float) -> Mask:
    """Rows whose error is near a constant or near a part of the distance."""
    limit = _ANYHOW * reference + _NEAR
    return np.asarray((np.abs(error - center) < limit) | (np.abs(error - scale * reference) < limit))


def _smooth(distance: Column, temperature: Column | None) -> Column:
    """Basis functions of distance and temperature that approximate the mean of most causes, one per line."""
    far = distance / 2.0
    columns = [np.ones_like(far)]
    if np.fmax.reduce(far) > np.fmin.reduce(far):
        columns += [far, far**2]
    if temperature is not None and np.fmax.reduce(temperature) > np.fmin.reduce(temperature):
        columns += [far * (temperature / 25.0) ** power for power in (1, 2)]
    return np.stack(columns)


def least_absolute(columns: Column, values: Column) -> Column:
    """Coefficients of least absolute deviations, by iterative reweighting."""
    found = np.zeros(len(columns))
    found[0] = median(values)
    for _ in range(_ROUNDS):
        left = np.abs(values - found @ columns)
        weighted = columns / np.maximum(left, max(1e-3 * median(left), 1e-9))
        among = weighted @ columns.T
        ridge = 1e-9 * np.trace(among) * np.eye(len(columns))
        found = np.linalg.solve(among + ridge, weighted @ values)
    return found
