"""Designs of measurements that tell the members of a credible set apart."""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import combinations

import numpy as np
from numpy.typing import NDArray

from echocal.diagnose.average import Member
from echocal.diagnose.noise import Noise

__all__ = ["Plan", "Prospect", "best_plan"]

Matrix = NDArray[np.float64]

_FREE = 1.0  # m^2: variance of a level that nobody knows
_ALIKE = 0.9  # overlap from which on no design tells two members apart
_DRAWS = 600
_BETTER = 0.01  # probability that a further place must add
_MOST = 5  # places
_SPREAD = 20  # places, evenly over the grid and its ends, that say whether members can be told apart
_ROUNDS = 4  # of exchanging every place for a better one
_LEAST = 1e-12  # m^2: 1 um, below what any sensor of this kind resolves; a column of constants has no noise
_TAPE = 1e-3  # m, standard deviation of a new stand's distance: a tape errs by 0.5 to 2 mm (CATALOGUE)


@dataclass(frozen=True)
class Prospect:
    """What each member predicts where one could measure.

    Attributes
    ----------
    mean : ndarray, shape (m, p)
        Reading at each place [m].
    spread : ndarray, shape (m, p, p)
        Covariance of these readings from what the member's parameters leave open [m^2].
    distance, slope : ndarray, shape (p,)
        Distance [m], and derivative of the reading to it.
    noise : Noise
    variance : float
        Of the innovations [m^2].
    level_known : bool
        Whether the distance of new rows would be known.
    stands : ndarray
        Distances at which there are rows already [m].
    """

    mean: Matrix
    spread: Matrix
    distance: Matrix
    slope: Matrix
    noise: Noise
    variance: float
    level_known: bool
    stands: Matrix

    @classmethod
    def of(
        cls,
        members: Sequence[Member],
        conditions: dict[str, Matrix],
        noise: Noise,
        variance: float,
        level_known: bool,
        stands: Matrix,
    ) -> "Prospect":
        """Ask each member's model, with its exact derivatives."""
        means, spreads = [], []
        for member in members:
            jacobian = member.model.jacobian(**conditions)
            means.append(member.model.indicate(**conditions))
            covariance = member.model.covariance
            tangents = jacobian[:, 1:]
            none = np.zeros((len(tangents), len(tangents)))
            spreads.append(none if covariance is None else tangents @ covariance @ tangents.T)
            slope = jacobian[:, 0]
        distance = conditions["distance"]
        variance = max(variance, _LEAST)
        return cls(np.array(means), np.array(spreads), distance, slope, noise, variance, level_known, stands)

    def covariance(self, places: NDArray[np.int64], rows: Sequence[int]) -> Matrix:
        """Covariance of the mean reading at each place; shape (m, designs, k, k)."""
        among = self.spread[:, places[:, :, None], places[:, None, :]]
        shot = np.array([self._of_mean(n) for n in rows])
        among = among + np.diag(shot) + self._of_stands(self.distance[places])
        if not self.level_known:
            slope = self.slope[places]
            among = among + _FREE * slope[:, :, None] * slope[:, None, :]
        return np.asarray(among)

    def _of_stands(self, at: Matrix) -> Matrix:
        """Covariance of the stands' own errors, each of which is in all rows of its stand.

        From rows of one stand nobody learns how large they are, and what was learned there has that
        stand's error in it: seen from any other stand, it is in all of them.
        """
        new = ~np.isin(at, self.stands)
        many = len(self.stands) > 1
        size = self.noise.stand_ratio * self.variance if many else _TAPE**2
        own = (at[:, :, None] == at[:, None, :]) & new[:, :, None]
        learned = 0.0 if many else 1.0 * (new[:, :, None] & new[:, None, :])
        return np.asarray(size * (own + learned))

    def _of_mean(self, n: int) -> float:
        """Variance of the mean of `n` rows in succession, whose noise remembers."""
        rho, memory = self.noise.rho, self.noise.memory
        first = self.variance / self.noise.first_weight
        if rho == memory:
            return first / n
        second = self.variance * (rho - memory) * (1 - rho * memory) / (1 - rho**2)
        lags = np.arange(1, n)
        return float((n * first + 2 * ((n - lags) * second * rho ** (lags - 1)).sum()) / n**2)


@dataclass(frozen=True)
class Plan:
    """Places, rows at each, and what they promise.

    Attributes
    ----------
    places : tuple of int
    rows : tuple of int
    classes : tuple of tuple of int
        Members that no place in reach tells apart.
    now, expected : float
        Probability of the right class before, and its expectation after.
    """

    places: tuple[int, ...]
    rows: tuple[int, ...]
    classes: tuple[tuple[int, ...], ...]
    now: float
    expected: float


def best_plan(
    prospect: Prospect,
    probability: Matrix,
    rows: int,
    seed: int,
    corners: NDArray[np.int64] | None = None,
) -> Plan:
    """Find the places at which the members' predictions overlap least.

    Rows at the corners of what can be varied guard against causes that are not among the members:
    where there are rows enough, every corner gets some, and the place left over is the one at which
    the members, given the corners, overlap least.

    Without corners, places join one by one, each where the union bound on the probability of error that the
    Bhattacharyya coefficients of the predictive distributions give [1]_ is least, and are then
    exchanged one by one until none is better elsewhere. The expected probability of the right
    class is then simulated: readings drawn from each member's predictive distribution, and
    weighed by all. A further place is kept if it adds to that.

    Parameters
    ----------
    prospect : Prospect
    probability : ndarray, shape (m,)
    rows : int
        To be shared between the places.
    seed : int
    corners : ndarray of int, optional
        Places at the ends of all that can be varied.

    References
    ----------
    .. [1] Kailath, T. (1967). The divergence and Bhattacharyya distance measures in signal
       selection. IEEE Trans. Commun. Technol. 15, 52-60. https://doi.org/10.1109/TCOM.1967.1089532
    """
    classes = _classes(prospect, rows)
    if corners is not None and 1 < len(corners) < rows:
        shares = _shares(rows, len(corners) + 1)
        places = np.append(corners, 0)
        places = _moved(prospect, probability, places, shares, len(corners))
        return _plan(prospect, probability, places, shares, classes, seed)
    places = np.empty(0, dtype=np.int64)
    best: Plan | None = None
    for count in range(1, _MOST + 1):
        shares = _shares(rows, count)
        places = _exchanged(prospect, probability, np.append(places, 0), shares)
        plan = _plan(prospect, probability, places, shares, classes, seed)
        if best is not None and count > 2 and plan.expected < best.expected + _BETTER:
            break
        best = plan if best is None or plan.expected > best.expected else best
    assert best is not None
    return best


def _exchanged(
    prospect: Prospect, probability: Matrix, places: NDArray[np.int64], shares: tuple[int, ...]
) -> NDArray[np.int64]:
    """Move each place, the newest first, to where the members overlap least; again until none moves."""
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
    """Move one place to where the members overlap least."""
    anywhere = np.arange(prospect.mean.shape[1])
    designs = np.tile(places, (len(anywhere), 1))
    designs[:, which] = anywhere
    return np.asarray(designs[_least(_overlaps(prospect, designs, shares), probability)])


def _shares(rows: int, places: int) -> tuple[int, ...]:
    return tuple(rows // places + (place < rows % places) for place in range(places))


def _overlaps(prospect: Prospect, designs: NDArray[np.int64], rows: Sequence[int]) -> Matrix:
    """Bhattacharyya coefficient of every two members under every design; shape (m, m, designs)."""
    spread = prospect.covariance(designs, rows)
    mean = prospect.mean[:, designs]
    m = len(mean)
    logs = np.linalg.slogdet(spread)[1]
    overlap = np.ones((m, m, len(designs)))
    for i, j in combinations(range(m), 2):
        both = 0.5 * (spread[i] + spread[j])
        apart = (mean[i] - mean[j])[..., None]
        distance = 0.125 * (apart * np.linalg.solve(both, apart)).sum(axis=(1, 2))
        distance += 0.5 * (np.linalg.slogdet(both)[1] - 0.5 * (logs[i] + logs[j]))
        overlap[i, j] = overlap[j, i] = np.exp(-distance)
    return overlap


def _least(overlap: Matrix, probability: Matrix) -> int:
    weight = np.sqrt(np.outer(probability, probability))
    np.fill_diagonal(weight, 0.0)
    return int(np.einsum("ij,ijd->d", weight, overlap).argmin())


def _classes(prospect: Prospect, rows: int) -> tuple[tuple[int, ...], ...]:
    """Members that no two places (of some, all over the grid) tell apart, chained."""
    from scipy.sparse.csgraph import connected_components  # takes long to import

    count = prospect.mean.shape[1]
    some = np.unique(np.linspace(0, count - 1, min(count, _SPREAD)).round().astype(np.int64))
    pairs = np.array(list(combinations(some.tolist(), 2)))
    least = _overlaps(prospect, pairs, _shares(rows, 2)).min(axis=2)
    labels = connected_components(least > _ALIKE, directed=False)[1]
    return tuple(tuple(np.flatnonzero(labels == label).tolist()) for label in dict.fromkeys(labels.tolist()))


def _plan(
    prospect: Prospect,
    probability: Matrix,
    places: NDArray[np.int64],
    rows: tuple[int, ...],
    classes: tuple[tuple[int, ...], ...],
    seed: int,
) -> Plan:
    """Simulate what the right class would hold after measuring."""
    spread = prospect.covariance(places[None], rows)[:, 0]
    mean = prospect.mean[:, places]
    random = np.random.default_rng(seed)
    share = np.array([probability[list(c)].sum() for c in classes])
    roots, inverses = np.linalg.cholesky(spread), np.linalg.inv(spread)
    offset = np.log(probability) - 0.5 * np.linalg.slogdet(spread)[1]
    expected = 0.0
    for group in classes:
        for truth in group:
            drawn = mean[truth] + random.normal(size=(_DRAWS, len(places))) @ roots[truth].T
            left = drawn[:, None] - mean
            log = offset - 0.5 * np.einsum("dmi,mij,dmj->dm", left, inverses, left)
            weight = np.exp(log - log.max(axis=1, keepdims=True))
            right = weight[:, list(group)].sum(axis=1) / weight.sum(axis=1)
            expected += float(probability[truth] * right.mean())
    return Plan(tuple(places.tolist()), rows, classes, float((share**2).sum()), expected)
