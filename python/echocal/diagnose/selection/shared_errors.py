"""Errors that all rows of a placement share, in the uncertainty of a size."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from echocal.diagnose.candidates.columns import Columns
from echocal.diagnose.inference.case import Case
from echocal.diagnose.inference.hypothesis import HypothesisFit
from echocal.diagnose.settings.priors import WIDEST

__all__ = ["Shared", "with_shared_errors"]

_LEAST = 1e-18
"""Variance of an error that counts as none [m^2]."""


@dataclass(frozen=True, eq=False)
class Shared:
    """Placements of the target, and the error of rounding that the rows of each share.

    Attributes
    ----------
    columns : Columns
        What causes add to the readings.
    placement : ndarray of int, shape (n,)
    rounding : ndarray, shape (placements,)
        Variance [m^2].
    apart : bool
        Whether the parts have other stations, each with an error of its reference.
    """

    columns: Columns
    placement: NDArray[np.int64]
    rounding: NDArray[np.float64]
    apart: bool

    @classmethod
    def of(cls, case: Case) -> "Shared":
        """Those of a table."""
        known = case.table.rounding
        placement = case.table.groups if known is None else known.placement
        variance = np.zeros(int(placement.max()) + 1) if known is None else known.variance
        if case.sums.flat_level:  # the unknown level of a placement has its error, too
            variance = np.zeros_like(variance)
        return cls(case.found.columns, placement, variance, case.at_stations)


def with_shared_errors(
    fit: HypothesisFit, shared: Shared, free: Sequence[int], rows: NDArray[np.bool_], more: float
) -> HypothesisFit:
    """Add errors that do not average out over the rows of a placement: docs/method.md, Eq. 28a.

    Parameters
    ----------
    fit : HypothesisFit
        To some rows.
    shared : Shared
    free : sequence of int
        Columns of its coefficients.
    rows : ndarray of bool, shape (n,)
        These rows.
    more : float
        Variance of the error of a station beyond that in the fit [m^2].
    """
    variance = shared.rounding + (more if shared.apart else 0.0)
    if not free or not (variance[np.unique(shared.placement[rows])] > _LEAST).any():
        return fit
    at = shared.placement[rows]
    own = shared.columns.at(free, np.flatnonzero(rows))
    count = np.bincount(at, minlength=len(variance))
    means = np.array([np.bincount(at, column, len(variance)) for column in np.atleast_2d(own)])
    seen = count > 0
    means = means[:, seen] / count[seen]
    return fit._replace(covariance=_wider(fit.covariance, means, np.maximum(variance[seen], _LEAST)))


def _wider(
    covariance: NDArray[np.floating[Any]], means: NDArray[np.float64], variance: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Covariance where the means of placements have errors, too."""
    between = (means / variance) @ means.T
    one = np.eye(len(between))
    both = np.linalg.solve(one + between @ covariance, between)  # the harmonic sum of two informations
    return np.asarray(np.linalg.inv(0.5 * (both + both.T) + one / WIDEST**2))
