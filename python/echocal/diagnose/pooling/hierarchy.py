"""Sizes that vary between tables: Gaussian integrals in closed form.

docs/method/several-tables.md, Eq. 36 to 38.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import product
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from echocal.diagnose.settings.priors import WIDTHS

__all__ = ["Grid", "Likelihoods", "Population", "Sizes", "left_out", "log_mixture", "population"]

Array = NDArray[np.floating[Any]]
Bounds = Sequence[tuple[float, float]]

_FAR = 15.0  # prior standard deviations beyond which a bound has no effect: Eq. 15
_PER_CAUSE = 2  # causes up to which each has a standard deviation between tables of its own


class Sizes(NamedTuple):
    """Sizes of a set of causes, in the units of their shared forms."""

    mean: Array
    covariance: Array

    @property
    def deviation(self) -> Array:
        """Standard uncertainties."""
        return np.asarray(np.sqrt(np.diag(self.covariance)))


@dataclass(frozen=True)
class Likelihoods:
    """Log likelihood of the sizes in each of some tables, ``log + information b - b precision b / 2``.

    Attributes
    ----------
    log : ndarray, shape (k,)
    information : ndarray, shape (k, d)
    precision : ndarray, shape (k, d, d)
    """

    log: Array
    information: Array
    precision: Array

    def blurred(self, variances: Array) -> "Likelihoods":
        """Of the mean of the tables, if the size of each differs from it with these variances, shape (t, d).

        Its arrays have a first axis of length t.
        """
        d = variances.shape[-1]
        inner = np.eye(d) + variances[:, None, :, None] * self.precision  # (t, k, d, d)
        diagonal = variances[:, None, :, None] * np.eye(d)
        held = np.linalg.solve(inner, np.broadcast_to(diagonal, inner.shape))
        along = np.einsum("tkij,kj->tki", held, self.information)
        return Likelihoods(
            self.log - 0.5 * np.linalg.slogdet(inner)[1] + 0.5 * (along * self.information).sum(axis=-1),
            self.information - np.einsum("kij,tkj->tki", self.precision, along),
            self.precision - self.precision @ held @ self.precision,
        )

    def only(self, tables: NDArray[np.bool_]) -> "Likelihoods":
        """Of some tables."""
        return Likelihoods(self.log[tables], self.information[tables], self.precision[tables])


@dataclass(frozen=True)
class Grid:
    """Widths of the prior of the mean, and standard deviations between tables, for each coefficient.

    Attributes
    ----------
    widths, between : ndarray, shape (g, d)
    """

    widths: Array
    between: Array

    @classmethod
    def of(cls, counts: Sequence[int], between: Sequence[float]) -> "Grid":
        """All combinations; the coefficients of a cause have one width and one standard deviation.

        Of more than two causes, all have the same standard deviation between tables.
        """
        places = np.repeat(np.arange(len(counts)), counts)
        sized = [place for place, count in enumerate(counts) if count]
        free = len(sized) if len(sized) <= _PER_CAUSE else 1
        rows = []
        for widths in product(WIDTHS, repeat=len(sized)):
            for tau in product(between, repeat=free):
                each = tau if len(tau) == len(sized) else tau * len(sized)
                own = np.zeros((2, len(counts)))
                own[:, sized] = np.array([widths, each]) if sized else 0.0
                rows.append(own[:, places])
        both = np.array(rows).reshape(len(rows), 2, len(places))
        return cls(both[:, 0], both[:, 1])


@dataclass(frozen=True)
class Population:
    """The sizes that tables share, after the data.

    Attributes
    ----------
    weight : ndarray, shape (g,)
        Probability of each combination of the grid.
    means : ndarray, shape (g, d)
        Of the mean size.
    covariances : ndarray, shape (g, d, d)
    """

    log_evidence: float
    weight: Array
    grid: Grid
    means: Array
    covariances: Array

    @cached_property
    def mean(self) -> Sizes:
        """Mean sizes of the tables."""
        (mean,), (covariance,) = self._averaged(self.means[:, None], self.covariances[:, None])
        return Sizes(mean, covariance)

    @property
    def between(self) -> Array:
        """Posterior mean of the standard deviation between tables."""
        return np.asarray(self.weight @ self.grid.between)

    def drawn(self, tables: Likelihoods) -> list[Sizes]:
        """Sizes of each table, drawn to the mean of all: docs/method/several-tables.md, Eq. 38."""
        d = self.grid.widths.shape[1]
        variance = self.grid.between**2  # (g, d)
        inner = np.eye(d) + variance[:, None, :, None] * tables.precision  # (g, k, d, d)
        own = np.linalg.solve(inner, np.broadcast_to(variance[:, None, :, None] * np.eye(d), inner.shape))
        kept = np.eye(d) - own @ tables.precision  # how far a table follows the mean
        means = np.einsum("gkij,gj->gki", kept, self.means) + np.einsum(
            "gkij,kj->gki", own, tables.information
        )
        covariances = own + kept @ self.covariances[:, None] @ np.swapaxes(kept, -1, -2)
        return [Sizes(*both) for both in zip(*self._averaged(means, covariances), strict=True)]

    def _averaged(self, means: Array, covariances: Array) -> tuple[Array, Array]:
        """Over the grid: means, shape (g, k, d), and covariances, shape (g, k, d, d)."""
        mean = np.einsum("g,gki->ki", self.weight, means)
        apart = means - mean
        covariance = np.einsum("g,gkij->kij", self.weight, covariances)
        return mean, covariance + np.einsum("g,gki,gkj->kij", self.weight, apart, apart)


def population(tables: Likelihoods, grid: Grid, bounds: Bounds) -> Population:
    """Integrate over the sizes of all tables and over their mean, for each combination of the grid."""
    return _populations(tables, grid, bounds, leave_out=False)[0]


def left_out(tables: Likelihoods, grid: Grid, bounds: Bounds) -> tuple[Population, Array]:
    """The same, and the log evidence of all tables but one, for each table, shape (k,)."""
    whole, evidence = _populations(tables, grid, bounds, leave_out=True)
    return whole, evidence


def _populations(
    tables: Likelihoods, grid: Grid, bounds: Bounds, *, leave_out: bool
) -> tuple[Population, Array]:
    values, places = np.unique(grid.between**2, axis=0, return_inverse=True)
    blurred = tables.blurred(values)
    count = len(tables.log) if leave_out else 0
    places = places.ravel()

    def joined(part: Array) -> Array:
        total = part.sum(axis=1, keepdims=True)
        without = total - part[:, :count]  # one table less, for each table
        return np.asarray(np.concatenate([total, without], axis=1)[places])

    log, information, precision = map(joined, (blurred.log, blurred.information, blurred.precision))
    logs, means, covariances = integrals(log, information, precision, grid.widths[:, None, :], bounds)
    total = np.logaddexp.reduce(logs, axis=0)  # (1 + k,)
    evidence = total - float(np.log(len(logs)))
    weight = np.exp(logs[:, 0] - total[0])
    return Population(float(evidence[0]), weight, grid, means[:, 0], covariances[:, 0]), evidence[1:]


def log_mixture(information: Array, precision: Array, counts: Sequence[int], bounds: Bounds) -> float:
    """Log of a likelihood (whose log is 0 at size 0) averaged over the prior of a single table, Eq. 6."""
    widths = Grid.of(counts, (0.0,)).widths
    logs = integrals(np.zeros(len(widths)), information, precision, widths, bounds)[0]
    return float(np.logaddexp.reduce(logs) - np.log(len(logs)))


def integrals(
    log: Array, information: Array, precision: Array, widths: Array, bounds: Bounds
) -> tuple[Array, Array, Array]:
    """Log integral over a size with a prior of these widths, and the size's mean and covariance.

    The arrays have common first axes.
    """
    d = widths.shape[-1]
    shape = np.broadcast_shapes(widths.shape[:-1], information.shape[:-1])
    if d == 0:
        return np.broadcast_to(log, shape), np.zeros((*shape, 0)), np.zeros((*shape, 0, 0))
    square = np.broadcast_to(widths**2, (*shape, d))[..., None]
    inner = np.eye(d) + square * precision
    covariance = np.linalg.solve(inner, square * np.eye(d))
    covariance = 0.5 * (covariance + np.swapaxes(covariance, -1, -2))
    mean = np.einsum("...ij,...j->...i", covariance, np.broadcast_to(information, (*shape, d)))
    log = log + 0.5 * (information * mean).sum(axis=-1) - 0.5 * np.linalg.slogdet(inner)[1]
    for place, (low, high) in enumerate(bounds):
        if min(abs(low), abs(high)) <= _FAR:
            deviation = np.sqrt(np.maximum(covariance[..., place, place], 1e-300))
            at, width = mean[..., place], widths[..., place]
            log = log + _log_mass((low - at) / deviation, (high - at) / deviation)
            log = log - _log_mass(low / width, high / width)
    return np.asarray(log), mean, covariance


def _log_mass(low: Array, high: Array) -> Array:
    """Log probability that a standard normal number is between two limits."""
    from scipy.special import log_ndtr  # takes long to import

    flip = low > 0.0  # then in the tail where the logarithms are exact
    low, high = np.where(flip, -high, low), np.where(flip, -low, high)
    upper, lower = log_ndtr(high), log_ndtr(low)
    return np.asarray(upper + np.log1p(-np.exp(np.minimum(lower - upper, -1e-15))))
