"""A table as detectors look at it: readings beside a robust expectation."""

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from echocal.diagnose.base import Base
from echocal.diagnose.lattice import find_lattice
from echocal.observations import Observations

__all__ = ["View"]

Column = NDArray[np.float64]
Mask = NDArray[np.bool_]

_MAD_TO_SD = 1.4826  # of a normal distribution
_ENOUGH = 20_000  # rows that a robust fit needs at most
_ROUNDS = 12  # reweightings: least absolute deviations to a part in a thousand
_WINDOW = 13  # rows that vouch for a level where no reference is known
_ANYHOW = 0.06  # part of a distance that no law or thermometer is wrong by
_NEAR = 0.05  # m, and no mount
_PER_STEP = 0.6  # scatter that a step of the readings makes at least, where it hides the noise
_LEAST = 1e-5  # m, below what any such sensor scatters


@dataclass(frozen=True, eq=False)
class View:
    """One look at a table; a repair makes a new one.

    Attributes
    ----------
    observations : Observations
    base : Base
    given : float or None
        Reference distance of every row [m], where the user said it.
    known : bool
        Whether there is a reference distance at all.
    """

    observations: Observations
    base: Base
    given: float | None
    known: bool

    def __len__(self) -> int:
        return len(self.observations)

    def after(self, repaired: Observations) -> "View":
        """The same look at a repaired table."""
        return View(repaired, self.base, self.given, self.known)

    def without(self, rows: Mask, reason: str) -> Observations:
        """Mark rows unusable, with the reason; none is dropped."""
        unusable = self.observations.unusable.astype(object)
        unusable[rows & self.observations.usable] = reason
        return replace(self.observations, unusable=unusable.astype(str))

    @cached_property
    def reference(self) -> Column | None:
        """Reference distance [m]; None where only its constancy is known."""
        if not self.known:
            return None
        if self.given is not None:
            return np.full(len(self), self.given)
        return self.observations.reference_distance

    @cached_property
    def indication(self) -> Column:
        """Reading with the base's speed [m], also of rows that are out of range."""
        with np.errstate(all="ignore"):
            return self.base.indication(self.observations.echo_time, self.observations.conditions)

    @cached_property
    def temperature(self) -> Column | None:
        """Recorded temperature [degC]."""
        return self.observations.conditions.get("temperature")

    @cached_property
    def good(self) -> Mask:
        """Rows that can be judged."""
        good = self.observations.usable & np.isfinite(self.indication)
        return good if self.reference is None else good & np.isfinite(self.reference)

    @cached_property
    def expected(self) -> Column:
        """What most rows say that each should read [m]; NaN where nothing does."""
        if self.reference is not None:
            return self.reference + self._bulk
        import pandas as pd  # takes long to import

        expected = np.full(len(self), np.nan)
        kept = pd.Series(self.indication[self.good])
        expected[self.good] = kept.rolling(_WINDOW, center=True, min_periods=1).median().to_numpy()
        return expected

    @cached_property
    def deviation(self) -> Column:
        """Reading less what is expected of it [m]."""
        return self.indication - self.expected

    @cached_property
    def scatter(self) -> float:
        """Robust standard deviation of the deviation [m]."""
        inside = self.deviation[self.good & np.isfinite(self.deviation)]
        least = max(_LEAST, _PER_STEP * self.resolution)
        return max(_MAD_TO_SD * float(np.median(np.abs(inside))), least) if len(inside) else least

    @cached_property
    def resolution(self) -> float:
        """Step of the readings or echo times as the logger wrote them [m]; 0 where there is none."""
        values = (
            self.observations.echo_time if self.observations.reading is None else self.observations.reading
        )
        lattice = find_lattice(np.where(self.good, values, np.nan))
        if lattice is None:
            return 0.0
        scale = float(np.median(self.indication[self.good] / values[self.good])) if self.good.any() else 1.0
        return lattice.step * scale

    @cached_property
    def _bulk(self) -> Column:
        """Smooth part of reading less reference that most rows share [m]."""
        assert self.reference is not None
        columns = _basis(self.reference, self.temperature)
        error = self.indication - self.reference
        sane = self.good & np.isfinite(columns).all(axis=0) & np.isfinite(error) & (self.reference > 0)
        center = float(np.median(error[sane])) if sane.any() else 0.0
        scale = float(np.median(error[sane] / self.reference[sane])) if sane.any() else 0.0
        off = np.minimum(np.abs(error - center), np.abs(error - scale * self.reference))
        sane &= off < _ANYHOW * self.reference + _NEAR  # no leverage for wild rows
        rows = np.flatnonzero(sane)
        rows = rows[:: max(1, len(rows) // _ENOUGH)]
        if len(rows) < 3 * len(columns):
            return np.full(len(self), float(np.median(error[rows])) if len(rows) else 0.0)
        return np.asarray(_least_absolute(columns[:, rows].T, error[rows]) @ columns)


def _basis(distance: Column, temperature: Column | None) -> Column:
    """Columns that most causes' means nearly lie in."""
    far = distance / 2.0
    columns = [np.ones_like(far)]
    spread = [] if np.ptp(far[np.isfinite(far)]) == 0 else [far, far**2]
    if temperature is not None and np.nanmax(temperature) > np.nanmin(temperature):
        warm = temperature / 25.0
        spread += [far * warm, far * warm**2]
    return np.stack([*columns, *spread])


def _least_absolute(columns: Column, values: Column) -> Column:
    """Coefficients of least absolute deviations, by reweighting."""
    weight = np.ones(len(values))
    center = np.median(values)
    found = np.zeros(columns.shape[1])
    found[0] = center
    for _ in range(_ROUNDS):
        left = np.abs(values - columns @ found)
        weight = 1 / np.maximum(left, max(1e-3 * float(np.median(left)), 1e-9))
        weighted = columns * weight[:, None]
        ridge = 1e-9 * np.trace(weighted.T @ columns) * np.eye(columns.shape[1])
        found = np.linalg.solve(weighted.T @ columns + ridge, weighted.T @ values)
    return found
