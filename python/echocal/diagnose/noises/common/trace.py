"""Residuals of a hypothesis on the mean, from which the likelihoods of noises are computed."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from echocal.diagnose.preprocess.density import fitted

__all__ = ["KERNELS", "Likelihood", "Trace", "group_medians"]

Column = NDArray[np.float64]

KERNELS = (np.inf, 8.0, 4.0, 2.5)
"""Degrees of freedom of the noise below everything: normal, and heavier tails."""


@dataclass(frozen=True)
class Likelihood:
    """A noise fitted to a trace.

    Attributes
    ----------
    log : float
        Log likelihood, less what its free parameters cost.
    parameters : mapping of str to (float, float)
        Value and standard uncertainty.
    because : str
        A sentence that a person can check.
    matters : bool
        Whether a verdict counts it.
    """

    log: float
    parameters: dict[str, tuple[float, float]]
    because: str
    matters: bool = True


@dataclass(frozen=True, eq=False)
class Trace:
    """Residuals of one hypothesis.

    Attributes
    ----------
    left : ndarray, shape (n,)
        Reading less base less the hypothesis's causes, in the order recorded [m].
    innovation : ndarray, shape (n,)
        The same without autocorrelation and the errors of the stations [m].
    distance : ndarray, shape (n,)
        Expected distance [m].
    speed : ndarray, shape (n,)
        Speed of sound that the device converts with [m/s].
    free_mean : bool
        Whether the hypothesis found a level of its own, so that zero means nothing.
    segment : ndarray of int, shape (n,)
        Segment of rows with one target, undisturbed, that each row belongs to.
    rounding : float
        Standard deviation of the error of rounding of each row [m]: no noise scatters less.
    """

    left: Column
    innovation: Column
    distance: Column
    speed: Column
    free_mean: bool
    segment: NDArray[np.int64]
    rounding: float = 0.0

    def __len__(self) -> int:
        return len(self.left)

    @cached_property
    def segment_median(self) -> Column:
        """Median of what is left over the row's segment [m]."""
        return np.asarray(group_medians(self.left, self.segment)[self.segment])

    def skewed(self, worth: float) -> bool:
        """Whether a moment is so many standard errors off as one-sided delays would move it."""
        count, mean, spread = len(self), float(self.left.mean()), float(self.left.std()) + 1e-12
        unit = (self.left - mean) / spread
        square = unit * unit  # powers of other than two take long
        skew = float(np.mean(square * unit)) * np.sqrt(count / 6)
        flat = (3 - float(np.mean(square * square))) * np.sqrt(count / 24)
        late = 0.0 if self.free_mean else mean / spread * np.sqrt(count)
        return skew > worth or flat > worth or late > 2 * worth

    @cached_property
    def plain(self) -> float:
        """Log likelihood of noise without a name, its kernel averaged.

        Of the rows as they are, or less what the nuisance noises explain, whichever is likelier: what these
        take from heavy tails makes other rows outliers.
        """
        either = [_averaged(values, self.rounding) for values in (self.innovation, self.left)]
        return float(np.logaddexp.reduce(either) - np.log(2) - 0.5 * np.log(len(self)))


def group_medians(values: Column, groups: NDArray[np.int64]) -> Column:
    """Median of each group; groups are numbered from 0 without a gap."""
    order = np.lexsort((values, groups))
    count = np.bincount(groups)
    firsts = np.cumsum(count) - count
    middle = values[order[firsts + (count - 1) // 2]] + values[order[firsts + count // 2]]
    return np.asarray(0.5 * middle)


def _averaged(values: Column, least: float) -> float:
    logs = [float(fitted(values, freedom, least)[1]) for freedom in KERNELS]
    return float(np.logaddexp.reduce(logs) - np.log(len(KERNELS)))
