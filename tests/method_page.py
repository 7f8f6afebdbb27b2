"""docs/method.md in plain NumPy: written from its equations alone, slow and obvious, for small tables."""

import itertools
import math
from collections.abc import Iterable, Sequence
from typing import Protocol

import numpy as np

Matrix = np.ndarray
WIDTHS = (1 / 3, 1.0, 3.0)
NUMBER = (0.44, 0.45, 0.1, 0.01)
TERM = 0.05
FLOOR = 1e-9  # m
UNKNOWN = "unknown"


class Form(Protocol):
    """A form of a cause, as Eq. 2 has it: which columns of the table it uses, and what is known of them."""

    cause: str
    offset: int | None
    free: tuple[int, ...]
    bounds: tuple[tuple[float, float], ...]
    weight: float


class Noise(Protocol):
    """A noise model, Eq. 3 and 5."""

    rho: float
    memory: float
    station_ratio: float
    prior: float


def precision(noise: Noise, starts: Matrix, station: Matrix) -> tuple[Matrix, float]:
    """Inverse of V and its log determinant, Eq. 3 and 5."""
    n, rho, theta = len(starts), noise.rho, noise.moving_average
    first = (1 - rho**2) / (1 - 2 * rho * theta + theta**2)
    white = np.zeros((n, n))
    kept = np.zeros(n)
    for i in range(n):
        before, kept = (np.zeros(n) if starts[i] else kept), np.eye(n)[i]
        if starts[i]:
            white[i] = math.sqrt(first) * kept
            continue
        kept = kept + theta * before
        white[i] = kept - rho * before
    within = np.linalg.inv(white.T @ white) + noise.station_ratio * (station[:, None] == station)
    return np.linalg.inv(within), float(np.linalg.slogdet(within)[1])


def one_noise(forms: Sequence[Form], columns: Matrix, inverse: Matrix) -> list[tuple]:
    """Log evidence, mean and covariance of every combination of widths, Eq. 9 and 11 to 15."""
    n = columns.shape[1]
    fixed = [v.offset for v in forms if v.offset is not None]
    free = [c for v in forms for c in v.free]
    bounds = np.array([b for v in forms for b in v.bounds]).reshape(-1, 2)
    x, y = columns[free], columns[-1] - columns[fixed].sum(axis=0)
    among, along, square = x @ inverse @ x.T, x @ inverse @ y, max(y @ inverse @ y, n * FLOOR**2)
    ridge = 1e-9 * np.trace(among) * np.eye(len(free))
    least = max(square - along @ np.linalg.solve(among + ridge, along), 1e-12 * square) / n
    parts = []
    counts = [len(v.free) for v in forms if v.free]
    for chosen in itertools.product(WIDTHS, repeat=len(counts)):
        width = np.repeat(chosen, counts)
        prior = np.maximum(least / width**2, 1e-9 * among.diagonal())
        whole = among + np.diag(prior)
        mean = np.linalg.solve(whole, along)
        left = max(square - along @ mean, 1e-12 * square, n * FLOOR**2)
        covariance = left / n * np.linalg.inv(whole)
        log = -0.5 * (n * math.log(left) + np.linalg.slogdet(whole)[1] - np.log(prior).sum())
        log -= len(counts) * math.log(len(WIDTHS))
        for j, (low, high) in enumerate(bounds):
            if min(abs(low), abs(high)) <= 15:
                deviation = math.sqrt(covariance[j, j])
                log += math.log(
                    max(mass((low - mean[j]) / deviation, (high - mean[j]) / deviation), 2.3e-308)
                )
                log -= math.log(mass(low / width[j], high / width[j]))
        parts.append((log, mean, covariance))
    return parts


def mass(low: float, high: float) -> float:
    """Probability of a standard normal number between two others."""
    low, high = (-high, -low) if low > 0 else (low, high)
    return 0.5 * (math.erfc(-high / math.sqrt(2)) - math.erfc(-low / math.sqrt(2)))


def mixed(parts: Iterable[tuple]) -> tuple[float, Matrix, Matrix]:
    """Log evidence, mean and covariance of a mixture, Eq. 16 and 17."""
    logs, means, covariances = (np.array(some) for some in zip(*parts, strict=True))
    log = float(np.logaddexp.reduce(logs))
    share = np.exp(logs - log)
    mean = share @ means
    spread = np.einsum("p,pij->ij", share, covariances + means[:, :, None] * means[:, None, :])
    return log, mean, spread - np.outer(mean, mean)


class Method:
    """Eq. 3 to 17 for one table."""

    def __init__(self, columns: Matrix, noises: Iterable[Noise], starts: Matrix, station: Matrix) -> None:
        self.columns = columns
        self.noises = [(math.log(noise.prior), *precision(noise, starts, station)) for noise in noises]

    def evidence(self, forms: Sequence[Form]) -> tuple[float, Matrix, Matrix]:
        parts = []
        for log_prior, inverse, log_determinant in self.noises:
            weight = log_prior - 0.5 * log_determinant
            found = one_noise(forms, self.columns, inverse)
            parts += [(weight + log, mean, covariance) for log, mean, covariance in found]
        return mixed(parts)


def prior(forms: Sequence[Form], causes: int, terms: int) -> float:
    """Eq. 7 and 8."""
    known = [v for v in forms if v.cause != UNKNOWN]
    count = len(known)
    p = NUMBER[min(count, 3)] * 0.1 ** max(count - 3, 0) / math.comb(causes, count)
    p *= math.prod(v.weight for v in known)
    if not terms:
        return p
    return p * (TERM / terms if len(known) < len(forms) else 1 - TERM)


def every(known: Sequence[Form]) -> Iterable[tuple[Form, ...]]:
    """Every set of causes, in every form, without and beside each term."""
    forms: dict[str, list[tuple[Form, ...]]] = {}
    for form in known:
        forms.setdefault(form.cause, [()]).append((form,))
    for some in itertools.product(*forms.values()):
        yield tuple(itertools.chain(*some))


def informative(posterior: Sequence[tuple], causes: int) -> dict[tuple[str, ...], float]:
    """Probability of each set, Eq. 20 to 22; `posterior` has variants, p, variances of the sizes."""
    sets: dict[tuple[str, ...], float] = {}
    best: dict[tuple[str, ...], tuple] = {}
    for variants, p, variances in sorted(posterior, key=lambda one: -one[1]):
        ids = tuple(sorted(v.cause for v in variants))
        best.setdefault(ids, (variants, variances))
        sets[ids] = sets.get(ids, 0.0) + p
    before = dict(sets)
    for ids in sorted(sets, key=len, reverse=True):
        moved: dict[tuple[str, ...], float] = {}
        variants, variances = best[ids]
        at = 0
        for v in variants:
            own, at = variances[at : at + len(v.free)], at + len(v.free)
            fewer = tuple(id_ for id_ in ids if id_ != v.cause)
            if v.cause == UNKNOWN or v.offset is not None or fewer not in before:
                continue
            signal = math.sqrt(max(1 / min(own) - 1 / np.mean(np.square(WIDTHS)), 0.0))
            part = np.mean([math.erf(1 / max(signal * w, 1e-12) / math.sqrt(2)) for w in WIDTHS])
            known = len(set(ids) - {UNKNOWN})
            odds = [
                NUMBER[min(k, 3)] * 0.1 ** max(k - 3, 0) / math.comb(causes, k) for k in (known, known - 1)
            ]
            moved[fewer] = float(part) * odds[0] / odds[1] * before[fewer]
        scale = min(1.0, before[ids] / max(sum(moved.values()), 1e-300))
        for fewer, p in moved.items():
            sets[ids] -= scale * p
            sets[fewer] += scale * p
    return {ids: p / sum(sets.values()) for ids, p in sets.items()}
