"""Designs of measurements that separate the members of a credible set."""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import combinations

import numpy as np
from numpy.typing import NDArray

from echocal.diagnose.experiment_design.prospect import Prospect

__all__ = ["Plan", "best_plan"]

Matrix = NDArray[np.float64]

_ALIKE = 0.9  # overlap: with a larger one, a design does not separate two members
_DRAWS = 400  # readings of each member
_BETTER = 0.01  # probability that a further place must add
_MOST = 5  # places
_SPREAD = 20  # places, evenly over the grid, at which members are compared
_ROUNDS = 4  # rounds in which every place is exchanged for a better one


@dataclass(frozen=True)
class Plan:
    """Places, rows at each, and the expected probability.

    Attributes
    ----------
    places : tuple of int
    rows : tuple of int
    classes : tuple of tuple of int
        Members that no place separates.
    now, expected : float
        Probability of the most probable member and its exact aliases now, and its expected value
        after the measurement.
    """

    places: tuple[int, ...]
    rows: tuple[int, ...]
    classes: tuple[tuple[int, ...], ...]
    now: float
    expected: float


def best_plan(
    prospect: Prospect,
    probability: Matrix,
    same: NDArray[np.int64],
    rows: int,
    seed: int,
    fixed: NDArray[np.int64] | None = None,
) -> Plan:
    """Find the places to measure at, and the expected probability.

    If there are enough rows, the fixed places are taken: all corners of the ranges, and their
    middle. In our trials no choice from the predictions of the members was better
    (docs/diagnose.md), and these places also show causes that are not among the members.

    Otherwise places are added one by one. Each minimizes the union bound on the probability of
    error, from the Bhattacharyya coefficients of the predictive distributions [1]_. Then places are
    exchanged one by one as long as this reduces the bound. A further place is kept if it increases
    the expected probability enough.

    Parameters
    ----------
    prospect : Prospect
    probability : ndarray, shape (m,)
        Of each member. The rest up to one belongs to causes that have no model.
    same : ndarray of int, shape (m,)
        Class of exact aliases of each member.
    rows : int
        Rows that the places share.
    seed : int
    fixed : ndarray of int, optional
        Places that do not depend on the members.

    References
    ----------
    .. [1] Kailath, T. (1967). The divergence and Bhattacharyya distance measures in signal
       selection. IEEE Trans. Commun. Technol. 15, 52-60. https://doi.org/10.1109/TCOM.1967.1089532
    """
    classes = _classes(prospect, rows)
    now = float(np.bincount(same, probability).max())

    def plan(places: NDArray[np.int64]) -> Plan:
        shares = _shares(rows, len(places))
        expected = _expected(prospect, probability, same, places, shares, seed)
        return Plan(tuple(places.tolist()), shares, classes, now, expected)

    if fixed is not None and 1 < len(fixed) <= rows:
        return plan(fixed)
    places = np.empty(0, dtype=np.int64)
    best: Plan | None = None
    for count in range(1, _MOST + 1):
        places = _exchanged(prospect, probability, np.append(places, 0), _shares(rows, count))
        more = plan(places)
        if best is not None and count > 2 and more.expected < best.expected + _BETTER:
            break
        best = more if best is None or more.expected > best.expected else best
    assert best is not None
    return best


def _exchanged(
    prospect: Prospect, probability: Matrix, places: NDArray[np.int64], shares: tuple[int, ...]
) -> NDArray[np.int64]:
    """Move each place to the least overlap of the members, the newest first, until none moves."""
    for _ in range(_ROUNDS):
        before = places.copy()
        for which in reversed(range(len(places))):
            places = _moved(prospect, probability, places, shares, which)
        if (places == before).all():
            break
    return places


def _moved(
    prospect: Prospect, probability: Matrix, places: NDArray[np.int64], shares: tuple[int, ...], which: int
) -> NDArray[np.int64]:
    """Move one place to the least overlap of the members."""
    anywhere = np.arange(prospect.shift.shape[1])
    designs = np.tile(places, (len(anywhere), 1))
    designs[:, which] = anywhere
    return np.asarray(designs[_least(_overlaps(prospect, designs, shares), probability)])


def _shares(rows: int, places: int) -> tuple[int, ...]:
    return tuple(rows // places + (place < rows % places) for place in range(places))


def _overlaps(prospect: Prospect, designs: NDArray[np.int64], rows: Sequence[int]) -> Matrix:
    """Bhattacharyya coefficients of all pairs of members under all designs, shape (m, m, designs)."""
    spread = prospect.covariance(designs, rows)
    mean = prospect.shift[:, designs]
    m = len(mean)
    logs = _distances(spread, np.zeros_like(mean))[1]
    one, other = np.triu_indices(m, 1)
    square, log = _distances(0.5 * (spread[one] + spread[other]), mean[one] - mean[other])
    overlap = np.ones((m, m, len(designs)))
    distance = 0.125 * square + 0.5 * (log - 0.5 * (logs[one] + logs[other]))
    overlap[one, other] = overlap[other, one] = np.exp(-distance)
    return overlap


def _distances(covariance: Matrix, apart: Matrix) -> tuple[Matrix, Matrix]:
    """Squared Mahalanobis distances and log determinants of many small matrices."""
    rest, left = covariance.copy(), apart.copy()
    square, log = np.zeros(apart.shape[:-1]), np.zeros(apart.shape[:-1])
    for i in range(apart.shape[-1]):
        pivot = rest[..., i, i].copy()
        square += left[..., i] ** 2 / pivot
        log += np.log(pivot)
        part = rest[..., i + 1 :, i] / pivot[..., None]
        left[..., i + 1 :] -= part * left[..., i, None]
        rest[..., i + 1 :, i + 1 :] -= part[..., None] * rest[..., i, None, i + 1 :]
    return square, log


def _least(overlap: Matrix, probability: Matrix) -> int:
    weight = np.sqrt(np.outer(probability, probability))
    np.fill_diagonal(weight, 0.0)
    return int(np.einsum("ij,ijd->d", weight, overlap).argmin())


def _classes(prospect: Prospect, rows: int) -> tuple[tuple[int, ...], ...]:
    """Connected groups of members that no pair of places, spread over the grid, separates."""
    from scipy.sparse.csgraph import connected_components  # takes long to import

    count = prospect.shift.shape[1]
    some = np.unique(np.linspace(0, count - 1, min(count, _SPREAD)).round().astype(np.int64))
    pairs = np.array(list(combinations(some.tolist(), 2)))
    least = _overlaps(prospect, pairs, _shares(rows, 2)).min(axis=2)
    labels = connected_components(least > _ALIKE, directed=False)[1]
    return tuple(tuple(np.flatnonzero(labels == label).tolist()) for label in dict.fromkeys(labels.tolist()))


def _expected(
    prospect: Prospect,
    probability: Matrix,
    same: NDArray[np.int64],
    places: NDArray[np.int64],
    rows: tuple[int, ...],
    seed: int,
) -> float:
    """Simulate the probability of the most probable class after the measurement.

    Readings are drawn from each member, and the posterior over all members is computed. The
    probability of causes that are not among the members counts as zero.
    """
    mean = prospect.shift[:, places]
    roots = np.linalg.cholesky(prospect.covariance(places[None], rows)[:, 0])
    normal = np.random.default_rng(seed).normal(size=(_DRAWS, len(places)))
    drawn = (mean[:, None] + normal @ roots.swapaxes(1, 2)).reshape(-1, len(places))
    left = (drawn - mean[:, None]) @ np.linalg.inv(roots).swapaxes(1, 2)
    size = np.log(np.diagonal(roots, axis1=1, axis2=2)).sum(axis=1)
    log = (np.log(probability) - size)[:, None] - 0.5 * (left**2).sum(axis=2)
    weight = np.exp(log - log.max(axis=0))
    shares = np.eye(same.max() + 1)[same].T @ weight
    first = shares.max(axis=0) / shares.sum(axis=0)
    return float(probability @ first.reshape(len(mean), -1).mean(axis=1))
