"""The sums, the whitening and the evidence against slow and obvious ways."""

from itertools import product

import numpy as np
import pytest
from scipy.linalg import toeplitz
from scipy.signal import lfilter

import echocal
from echocal.diagnose.candidates.columns import Columns
from echocal.diagnose.candidates.unexplained_terms import HOUR, Basis, column_of, term_candidates
from echocal.diagnose.candidates.variant import Candidates, Variant
from echocal.diagnose.inference.hypothesis import Hypothesis, Stack, fit_hypotheses, fit_hypothesis
from echocal.diagnose.inference.innovation import innovation
from echocal.diagnose.inference.noise import Convection, Noise, all_convections, growing_noises, noises
from echocal.diagnose.inference.sums import Sums, Whitened
from echocal.diagnose.preprocess.order import Order
from echocal.diagnose.settings import NoiseModelSettings, TermSettings

MODELS = NoiseModelSettings()
CONVECTIONS = (*all_convections(MODELS), *growing_noises(MODELS))


def sums(
    columns: np.ndarray, groups: np.ndarray, *, flat_level: bool, distance: np.ndarray | None = None
) -> Sums:
    n = columns.shape[1]
    starts = np.diff(groups, prepend=-1) != 0
    stored = Columns(echocal.Model("linear"), np.ones(n), {}, None)
    for column in columns:
        stored.store(column)
    order = Order(starts, groups, np.ones(n) if distance is None else distance, flat_level)
    alike = [theta for theta, _ in MODELS.autoregressions]
    found = Sums.gather(stored, order, np.arange(n) * 3 // n, alike)
    return found if distance is None else found.with_correlations(stored, CONVECTIONS)


@pytest.mark.parametrize("rho", [0.0, 0.4, 0.9])
def test_whitening_is_generalized_least_squares(rho: float, random: np.random.Generator) -> None:
    n = 60
    columns = np.stack([np.ones(n), random.normal(size=n), random.normal(size=n)])
    noise = Noise(0.0, rho, 0.0, 1.0)
    whitened = sums(columns, np.zeros(n, dtype=int), flat_level=True).whiten(noise).products
    covariance = toeplitz(rho ** np.arange(n)) / (1 - rho**2)
    products = columns @ np.linalg.solve(covariance, columns.T)
    expected = products - np.outer(products[0], products[0]) / products[0, 0]
    np.testing.assert_allclose(whitened[1:, 1:], expected[1:, 1:], rtol=1e-9, atol=1e-9)


def test_a_random_error_per_station_is_its_covariance(random: np.random.Generator) -> None:
    groups = np.repeat(np.arange(6), 10)
    columns = np.stack([np.ones(60), random.normal(size=60), random.normal(size=60)])
    whitened = sums(columns, groups, flat_level=False).whiten(Noise(0.0, 0.0, 2.0, 1.0))
    covariance = np.eye(60) + 2.0 * (groups[:, None] == groups[None, :])
    expected = columns @ np.linalg.solve(covariance, columns.T)
    np.testing.assert_allclose(whitened.products, expected, rtol=1e-9, atol=1e-9)
    assert whitened.log_weight == pytest.approx(-0.5 * np.linalg.slogdet(covariance)[1])


@pytest.mark.parametrize("convection", [*CONVECTIONS[:20:6], *CONVECTIONS[20::5]])
def test_convection_is_its_covariance(convection: Convection, random: np.random.Generator) -> None:
    """White noise, air that stays for some rows and errs more on a longer path, an error per station."""
    groups = np.repeat(np.arange(4), 15)
    columns, distance = random.normal(size=(3, 60)), random.uniform(0.2, 4.0, 60)
    columns[0] = 1.0
    noise = Noise(0.0, convection.rho, 0.3, 1.0, convection.growth, convection.whole_path)
    whitened = sums(columns, groups, flat_level=False, distance=distance).whiten(noise)
    together = np.outer(distance, distance)
    white = 1 / (1 + convection.growth) if convection.whole_path else 1.0
    air = toeplitz(convection.rho ** np.arange(60)) * (
        together if convection.whole_path else np.sqrt(together)
    )
    alike = groups[:, None] == groups[None, :]
    covariance = white * np.eye(60) + (white * convection.growth * air + 0.3) * alike
    expected = columns @ np.linalg.solve(covariance, columns.T)
    np.testing.assert_allclose(whitened.products, expected, rtol=1e-9, atol=1e-9)
    assert whitened.log_weight == pytest.approx(-0.5 * np.linalg.slogdet(covariance)[1])


def test_blocks_add_up_whatever_is_held_out(random: np.random.Generator) -> None:
    columns = random.normal(size=(3, 90))
    columns[0] = 1.0
    all_rows = sums(columns, np.zeros(90, dtype=int), flat_level=True)
    last = all_rows.whiten(Noise(0.0, 0.0, 0.0, 1.0), np.array([False, False, True])).products
    rows = columns[:, 60:] - columns[:, 60:].mean(axis=1, keepdims=True)
    np.testing.assert_allclose(last[1:, 1:], (rows @ rows.T)[1:, 1:], rtol=1e-9, atol=1e-9)


def test_evidence_is_the_integral_over_size_and_variance(random: np.random.Generator) -> None:
    n = 40
    x = random.normal(size=n)
    y = 0.8 * x + random.normal(size=n)
    products = np.stack([x, y]) @ np.stack([x, y]).T
    stack = Stack.of([Whitened(products, 0.0, Noise(0.0, 0.0, 0.0, 1.0))], n)
    unbounded = ((-np.inf, np.inf),)
    one = fit_hypothesis(Hypothesis((Variant("x", free=(0,), bounds=unbounded),), 1.0), stack)
    none = fit_hypothesis(Hypothesis((), 1.0), stack)

    sigma = np.exp(np.linspace(-2.5, 2.5, 1001))[:, None]
    size = np.linspace(-12, 12, 4001)[None, :]
    square = products[1, 1] - 2 * size * products[0, 1] + size**2 * products[0, 0]
    prior = sum(np.exp(-0.5 * (size / w) ** 2) / w for w in (1 / 3, 1.0, 3.0)) / 3 / np.sqrt(2 * np.pi)
    likelihood = np.exp(-n * np.log(sigma) - 0.5 * square / sigma**2 + n)
    with_x = (likelihood * prior).sum() * (size[0, 1] - size[0, 0])
    without = np.exp(-n * np.log(sigma) - 0.5 * products[1, 1] / sigma**2 + n).sum()
    # the prior is scaled by the variance over its estimate: this costs a little of one unit of log odds
    assert one.log_evidence - none.log_evidence == pytest.approx(np.log(with_x / without), abs=0.25)


def test_bounds_cut_the_prior_off() -> None:
    products = np.array([[100.0, 80.0], [80.0, 100.0]])
    stack = Stack.of([Whitened(products, 0.0, Noise(0.0, 0.0, 0.0, 1.0))], 100)
    evidence = [
        fit_hypothesis(Hypothesis((Variant("x", free=(0,), bounds=(bounds,)),), 1.0), stack).log_evidence
        for bounds in ((-np.inf, np.inf), (0.0, 10.0), (-10.0, 0.0))
    ]
    assert evidence[1] == pytest.approx(evidence[0] + np.log(2), abs=0.02)  # twice the prior density
    assert evidence[2] < evidence[0] - 10  # the wrong sign


def test_hypotheses_side_by_side_are_each_by_itself(random: np.random.Generator) -> None:
    parts = sums(random.normal(size=(9, 90)), np.repeat(np.arange(5), 18), flat_level=False)
    stack = Stack(*parts.whiten_all(noises(MODELS, True)), 90, noises(MODELS, True))
    forms = [Variant(f"x{i}", free=(i,), bounds=((-1.0, 2.0),)) for i in range(1, 8)]
    hypotheses = [Hypothesis(tuple(forms[:count]), 1.0) for count in range(5)]
    for hypothesis, found in zip(hypotheses, fit_hypotheses(hypotheses, stack), strict=True):
        alone = fit_hypothesis(hypothesis, stack)
        assert found.log_evidence == alone.log_evidence
        np.testing.assert_array_equal(found.mean, alone.mean)
        np.testing.assert_array_equal(found.covariance, alone.covariance)


def test_noises_have_a_prior_of_one() -> None:
    for stations, convections in product((False, True), ((), CONVECTIONS)):
        found = noises(MODELS, stations, convections)
        assert sum(noise.prior for noise in found) == pytest.approx(1.0)
        assert all(
            noise.rho > noise.moving_average or noise.rho == noise.moving_average == 0 for noise in found
        )


@pytest.mark.parametrize("noise", [Noise(0.0, 0.98, 0.0, 1.0), Noise(0.9, 0.98, 0.0, 1.0)])
def test_a_long_series_is_whitened_as_one_although_it_is_summed_in_spans(
    noise: Noise, random: np.random.Generator
) -> None:
    n = 20_000
    columns = np.cumsum(random.normal(size=(3, n)), axis=1)
    columns[0] = 1.0
    filtered = lfilter([1.0], [1.0, -noise.moving_average], columns)
    white = filtered[:, 1:] - noise.rho * filtered[:, :-1]
    expected = white @ white.T + noise.first_weight * np.outer(columns[:, 0], columns[:, 0])
    found = sums(columns, np.zeros(n, dtype=int), flat_level=False).whiten(noise).products
    np.testing.assert_allclose(found, expected, rtol=1e-8)


def test_a_long_series_in_convection_is_whitened_as_one_although_it_is_summed_in_spans(
    random: np.random.Generator,
) -> None:
    n, noise = 20_000, Noise(0.0, 0.98, 0.0, 1.0, 0.3)
    columns, distance = np.cumsum(random.normal(size=(3, n)), axis=1), random.uniform(0.2, 4.0, n)
    found = sums(columns, np.zeros(n, dtype=int), flat_level=False, distance=distance).whiten(noise)
    order = Order(np.arange(n) == 0, np.zeros(n, dtype=int), distance, False)
    white = np.stack([innovation(column, order, noise) for column in columns])
    scale = np.exp(2 * found.log_weight / n)  # innovations are as dense as what they are made of
    np.testing.assert_allclose(found.products, scale * white @ white.T, rtol=1e-8)


def test_many_noises_at_once_are_each_by_itself(random: np.random.Generator) -> None:
    columns = random.normal(size=(4, 90))
    parts = sums(columns, np.repeat(np.arange(5), 18), flat_level=False)
    use = np.array([True, False, True])
    products, log_weight = parts.whiten_all(noises(MODELS, True), use)
    for noise, matrix, weight in zip(noises(MODELS, True), products, log_weight, strict=True):
        one = parts.whiten(noise, use)
        np.testing.assert_array_equal(matrix, one.products)
        assert weight == one.log_weight


def test_terms_are_fitted_as_they_are_reported(random: np.random.Generator) -> None:
    """Columns of the core, made a block at a time, are the functions that a model gets, less their means."""
    against = {"time": np.sort(random.uniform(0, 9 * 86400.0, 700))}
    found = Candidates(Columns(echocal.Model("linear"), np.ones(700), {}, None))
    term_candidates(found, against, TermSettings(), known_distance=False)
    for name in (HOUR, "time"):
        column = column_of(name, against)
        reported = np.array(Basis.of(name, column, TermSettings()).at(column))
        fitted = found.columns.at(found.terms[name].free)
        left = fitted - fitted.mean(axis=1, keepdims=True)
        left -= reported - reported.mean(axis=1, keepdims=True)
        assert np.abs(left).max() < 1e-12, name
