"""The log score of held-out rows: against its covariance, and where slow noise decides the error."""

import numpy as np
import pytest
from scipy.linalg import toeplitz
from scipy.signal import lfilter

from echocal.diagnose.inference.noise import Noise
from echocal.diagnose.preprocess.folds import Folds
from echocal.diagnose.preprocess.order import Order
from echocal.diagnose.validation.gain import HeldOut
from echocal.diagnose.validation.score import Score, score

Random = np.random.Generator


def order_of(groups: np.ndarray, *, flat_level: bool) -> Order:
    return Order(np.diff(groups, prepend=-1) != 0, groups, np.ones(len(groups)), flat_level)


def folds_of(n: int, count: int = 5) -> Folds:
    held = tuple(np.arange(count) == fold for fold in range(count))
    return Folds(np.arange(n) * count // n, held, np.ones(count, dtype=bool), "")


def information(n: int, rho: float) -> float:
    """On a constant, of n rows that follow each other."""
    covariance = toeplitz(rho ** np.arange(n)) / (1 - rho**2)
    return float(np.ones(n) @ np.linalg.solve(covariance, np.ones(n)))


@pytest.mark.parametrize("rho", [0.0, 0.4, 0.95])
@pytest.mark.parametrize("level", ["unknown", "stations err", "known"])
def test_it_is_the_density_of_the_covariance(rho: float, level: str, random: Random) -> None:
    n, ratio = 60, 2.0 if level == "stations err" else 0.0
    order, folds = order_of(np.zeros(n, dtype=np.int64), flat_level=level == "unknown"), folds_of(n)
    one, other = random.normal(size=(2, n))
    found = score(HeldOut(one), HeldOut(other), order, folds, [Noise(0.0, rho, ratio, 1.0)] * 5)
    log, square = 0.0, 0.0
    for fold in range(5):
        rows = folds.blocks == fold
        covariance = toeplitz(rho ** np.arange(12)) / (1 - rho**2)
        if level == "unknown":  # the level of the other rows, a run before and a run after
            runs = [length for length in (12 * fold, 12 * (4 - fold)) if length]
            covariance = covariance + 1.0 / sum(information(length, rho) for length in runs)
        covariance = covariance + ratio
        log += other[rows] @ np.linalg.solve(covariance, other[rows])
        log -= one[rows] @ np.linalg.solve(covariance, one[rows])
        square += one[rows] @ np.linalg.solve(covariance, one[rows])
    assert found.total == pytest.approx(0.5 * log / (square / n), rel=1e-9)


def test_a_level_that_no_fitted_row_has_is_free(random: Random) -> None:
    groups = np.repeat(np.arange(5), 12)
    order, folds = order_of(groups, flat_level=True), folds_of(60)
    one, other = random.normal(size=(2, 60))
    noises = [Noise(0.0, 0.6, 0.0, 1.0)] * 5
    found = score(HeldOut(one), HeldOut(other), order, folds, noises)
    moved = 10.0 * groups
    again = score(HeldOut(one + moved), HeldOut(other - moved), order, folds, noises)
    assert again.total == pytest.approx(found.total, rel=1e-6)


def test_white_noise_at_known_distances_is_the_squared_error(random: Random) -> None:
    one, other = random.normal(size=(2, 60))
    other[7] = np.nan  # a row that one model cannot judge
    order, folds = order_of(np.zeros(60, dtype=np.int64), flat_level=False), folds_of(60)
    found = score(HeldOut(one), HeldOut(other), order, folds, [Noise(0.0, 0.0, 0.0, 1.0)] * 5)
    known = np.isfinite(other)
    expected = 0.5 * np.sum(other[known] ** 2 - one[known] ** 2) / np.mean(one[known] ** 2)
    assert len(found.of_rows) == 59
    assert found.total == pytest.approx(expected)


def test_the_interval_is_that_of_independent_pieces(random: Random) -> None:
    covered = 0
    for _ in range(400):
        rows = random.normal(0.1, 1.0, 400)
        low, high = Score(rows).interval()
        covered += low < 40.0 < high
    assert 0.91 < covered / 400 < 0.985  # four standard errors
    assert Score(np.zeros(0)).interval() == (0.0, 0.0)


def remembering(n: int, rho: float, random: Random) -> np.ndarray:
    steps = np.sqrt(1 - rho**2) * random.normal(size=n + 2000)
    return np.asarray(lfilter([1.0], [1.0, -rho], steps)[2000:])


def whitened(values: np.ndarray, rho: float) -> np.ndarray:
    first = np.sqrt(1 - rho**2) * values[:1]
    return np.concatenate([first, values[1:] - rho * values[:-1]])


def log_of_a_day(rho: float, expected: float, random: Random) -> tuple[float, bool, Score]:
    """A column of five days at an unknown level in slow noise, with an expected log likelihood ratio.

    Returns the log likelihood ratio, whether the squared errors refute the column, and its log score.
    """
    n, time = 720, np.arange(720)
    column = np.sin(2 * np.pi * time / 144 + random.uniform(0, 6)) + 0.5 * remembering(n, 0.99, random)
    design = np.stack([whitened(one, rho) for one in (column, np.ones(n))], axis=1)
    apart = np.linalg.inv(np.linalg.inv(design.T @ design)[:1, :1])[0, 0] / (1 - rho**2)
    values = remembering(n, rho, random) + np.sqrt(2 * expected / apart) * column
    order, folds = order_of(np.zeros(n, dtype=np.int64), flat_level=True), folds_of(n)
    errors = np.empty((2, n))
    for fold in range(5):
        seen = folds.blocks != fold
        size = np.linalg.lstsq(design[seen], whitened(values, rho)[seen], rcond=None)[0][0]
        for left, error in zip((values - size * column, values), errors, strict=True):
            error[~seen] = left[~seen] - left[seen].mean()
    one, other = (HeldOut(error) for error in errors)
    size = np.linalg.lstsq(design, whitened(values, rho), rcond=None)[0][0]
    found = score(one, other, order, folds, [Noise(0.0, rho, 0.0, 1.0)] * 5)
    return float(0.5 * size**2 * apart), one.rms > other.rms, found


def test_slow_noise_does_not_refute_what_acts(random: Random) -> None:
    drawn = [log_of_a_day(0.995, 15.0, random) for _ in range(60)]
    assert sum(by_squares for _, by_squares, _ in drawn) >= 5  # 0.29 of them, by chance
    assert sum(found.total < 0.0 for _, _, found in drawn) <= 2
    assert sum(found.interval()[0] > 0.0 for _, _, found in drawn) >= 30  # 0.77 of them


def test_what_chance_has_chosen_is_not_proven(random: Random) -> None:
    drawn = [log_of_a_day(0.97, 0.0, random) for _ in range(800)]
    chosen = [found for ratio, _, found in drawn if ratio > 2.0]
    assert len(chosen) > 10
    assert sum(found.interval()[0] > 0.0 for found in chosen) <= 0.2 * len(chosen)
