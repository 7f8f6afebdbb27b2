"""What rows at some places promise, and the members that they do not separate."""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import combinations

import numpy as np
from numpy.typing import NDArray

from echocal.diagnose.experiment_design.prospect import Prospect

__all__ = ["Plan", "planned"]

Matrix = NDArray[np.float64]

_ALIKE = 0.9  # overlap: with a larger one, two places do not separate two members
_DRAWS = 400  # readings of each member


@dataclass(frozen=True)
class Plan:
    """Rows at each place, and the expected probability.

    Attributes
    ----------
    classes : tuple of tuple of int
        Members that no two of the places separate.
    now, expected : float
        Probability of the most probable member and its exact aliases now, and its expected value
        after the measurement.
    """

    rows: tuple[int, ...]
    classes: tuple[tuple[int, ...], ...]
    now: float
    expected: float


def planned(prospect: Prospect, probability: Matrix, same: NDArray[np.int64], rows: int, seed: int) -> Plan:
    """Share rows among the places of a prospect.

    Parameters
    ----------
    probability : ndarray, shape (m,)
        Of each member. The rest up to one belongs to causes that have no model.
    same : ndarray of int, shape (m,)
        Class of exact aliases of each member.
    rows : int
        Each place has one at least.
    """
    places = prospect.shift.shape[1]
    shares = _shares(max(rows, places), places)
    now = float(np.bincount(same, probability).max())
    return Plan(shares, _classes(prospect, rows), now, _expected(prospect, probability, same, shares, seed))


def _shares(rows: int, places: int) -> tuple[int, ...]:
    return tuple(rows // places + (place < rows % places) for place in range(places))


def _classes(prospect: Prospect, rows: int) -> tuple[tuple[int, ...], ...]:
    """Connected groups of members that no pair of places separates."""
    from scipy.sparse.csgraph import connected_components  # takes long to import

    pairs = np.array(list(combinations(range(prospect.shift.shape[1]), 2)))
    least = _overlaps(prospect, pairs, _shares(rows, 2)).min(axis=2)
    labels = connected_components(least > _ALIKE, directed=False)[1]
    return tuple(tuple(np.flatnonzero(labels == label).tolist()) for label in dict.fromkeys(labels.tolist()))


def _overlaps(prospect: Prospect, designs: NDArray[np.int64], rows: Sequence[int]) -> Matrix:
    """Bhattacharyya coefficients [1]_ of all pairs of members under all designs, shape (m, m, designs).

    References
    ----------
    .. [1] Kailath, T. (1967). The divergence and Bhattacharyya distance measures in signal
       selection. IEEE Trans. Commun. Technol. 15, 52-60. https://doi.org/10.1109/TCOM.1967.1089532
    """
    spread = prospect.covariance(designs, rows)
    mean = prospect.shift[:, designs]
    between = 0.5 * (spread[:, None] + spread)
    apart = (mean[:, None] - mean)[..., None]
    square = (apart * np.linalg.solve(between, apart)).sum(axis=(-2, -1))
    logs = np.linalg.slogdet(spread)[1]
    log = np.linalg.slogdet(between)[1] - 0.5 * (logs[:, None] + logs)
    return np.asarray(np.exp(-0.125 * square - 0.5 * log))


def _expected(
    prospect: Prospect, probability: Matrix, same: NDArray[np.int64], rows: tuple[int, ...], seed: int
) -> float:
    """Simulate the probability of the most probable class after the measurement.

    Readings are drawn from each member, and the posterior over all members is computed. The
    probability of causes that are not among the members counts as zero.
    """
    mean = prospect.shift
    roots = np.linalg.cholesky(prospect.covariance(np.arange(len(rows))[None], rows)[:, 0])
    normal = np.random.default_rng(seed).normal(size=(_DRAWS, len(rows)))
    drawn = (mean[:, None] + normal @ roots.swapaxes(1, 2)).reshape(-1, len(rows))
    left = (drawn - mean[:, None]) @ np.linalg.inv(roots).swapaxes(1, 2)
    size = np.log(np.diagonal(roots, axis1=1, axis2=2)).sum(axis=1)
    log = (np.log(probability) - size)[:, None] - 0.5 * (left**2).sum(axis=2)
    weight = np.exp(log - log.max(axis=0))
    shares = np.eye(same.max() + 1)[same].T @ weight
    first = shares.max(axis=0) / shares.sum(axis=0)
    return float(probability @ first.reshape(len(mean), -1).mean(axis=1))
