"""Sizes that vary between tables: the closed form against sums over grids."""

import numpy as np
import pytest
from scipy.stats import norm

from echocal.diagnose.pooling.hierarchy import WIDTHS, Grid, Likelihoods, left_out, log_mixture, population

FREE = ((-np.inf, np.inf),)
SIZES = np.linspace(-12.0, 12.0, 4001)


def drawn(random: np.random.Generator, count: int) -> Likelihoods:
    precision = random.uniform(0.5, 20.0, count)
    information = precision * random.normal(1.0, 0.7, count)
    return Likelihoods(random.normal(0.0, 1.0, count), information[:, None], precision[:, None, None])


def likelihood(tables: Likelihoods, place: int, size: np.ndarray) -> np.ndarray:
    square, along = tables.precision[place, 0, 0], tables.information[place, 0]
    return np.exp(tables.log[place] + along * size - 0.5 * square * size**2)


def by_sums(tables: Likelihoods, between: float, low: float = -np.inf) -> float:
    """The same integral on a grid of means, and of sizes around each mean."""
    step = SIZES[1] - SIZES[0]
    product = np.ones(len(SIZES))
    for place in range(len(tables.log)):
        own = likelihood(tables, place, SIZES)
        if between > 0.0:
            kernel = norm.pdf(SIZES[:, None] - SIZES[None, :], scale=between) * step
            own = kernel @ own
        product = product * own
    total = 0.0
    for width in WIDTHS:
        inside = np.where(low == SIZES, 0.5, low < SIZES)  # half of the cell at the bound
        prior = norm.pdf(SIZES, scale=width) * inside / norm.sf(low, scale=width)
        total += float(product @ prior) * step / len(WIDTHS)
    return float(np.log(total))


@pytest.mark.parametrize("between", [0.0, 0.2, 0.8])
def test_the_evidence_is_the_integral_over_all_sizes(random: np.random.Generator, between: float) -> None:
    tables = drawn(random, 3)
    found = population(tables, Grid.of([1], (between,)), FREE)
    assert found.log_evidence == pytest.approx(by_sums(tables, between), abs=1e-3)


def test_a_bound_cuts_the_prior_and_the_posterior(random: np.random.Generator) -> None:
    tables = drawn(random, 2)
    found = population(tables, Grid.of([1], (0.0,)), ((0.0, np.inf),))
    assert found.log_evidence == pytest.approx(by_sums(tables, 0.0, low=0.0), abs=1e-2)


def test_one_table_has_the_evidence_of_a_single_diagnosis(random: np.random.Generator) -> None:
    tables = drawn(random, 1)
    alone = tables.log[0] + log_mixture(tables.information[0], tables.precision[0], [1], FREE)
    found = population(tables, Grid.of([1], (0.0,)), FREE)
    assert found.log_evidence == pytest.approx(alone)


def test_a_table_left_out_is_as_if_it_were_not_there(random: np.random.Generator) -> None:
    tables, grid = drawn(random, 4), Grid.of([1], (0.0, 0.1, 0.4))
    _, others = left_out(tables, grid, FREE)
    for place in range(4):
        without = tables.only(np.arange(4) != place)
        assert others[place] == pytest.approx(population(without, grid, FREE).log_evidence)


def test_one_size_for_all_is_the_weighted_mean(random: np.random.Generator) -> None:
    tables = drawn(random, 3)
    grid = Grid(np.array([[1e3]]), np.array([[0.0]]))  # hardly any prior
    found = population(tables, grid, FREE)
    precision = tables.precision.sum()
    assert found.mean.mean[0] == pytest.approx(tables.information.sum() / precision, rel=1e-5)
    assert found.mean.covariance[0, 0] == pytest.approx(1 / precision, rel=1e-5)


def test_a_table_without_information_takes_the_size_of_the_others(random: np.random.Generator) -> None:
    tables = drawn(random, 3)
    tables.information[2], tables.precision[2] = 0.0, 0.0
    found = population(tables, Grid.of([1], (0.0, 0.2)), FREE)
    silent = found.drawn(tables)[2]
    assert silent.mean == pytest.approx(found.mean.mean)
    assert silent.covariance[0, 0] > found.mean.covariance[0, 0]
    assert found.log_evidence == pytest.approx(
        population(tables.only(np.arange(3) < 2), Grid.of([1], (0.0, 0.2)), FREE).log_evidence + tables.log[2]
    )


def test_sizes_that_differ_show_their_standard_deviation(random: np.random.Generator) -> None:
    """The median of nine populations: 5 of 2,000 single ones fall to the next point of the grid."""
    count, deviation = 30, 0.2
    between = []
    for _ in range(9):
        size = random.normal(1.0, deviation, count)
        tables = Likelihoods(np.zeros(count), 2500.0 * size[:, None], np.full((count, 1, 1), 2500.0))
        found = population(tables, Grid.of([1], (0.0, 0.03, 0.1, 0.2, 0.4, 0.8)), FREE)
        assert found.mean.mean[0] == pytest.approx(1.0, abs=6 * deviation / count**0.5)
        between.append(found.between[0])
    assert np.median(between) == pytest.approx(deviation, rel=0.6)


def test_several_causes_have_a_grid_each(random: np.random.Generator) -> None:
    assert len(Grid.of([1, 2], (0.0, 0.1)).widths) == 9 * 4
    assert len(Grid.of([1, 1, 1], (0.0, 0.1)).widths) == 27 * 2  # one standard deviation for three
    assert Grid.of([0], (0.0, 0.1)).widths.shape == (1, 0)
    two = Grid.of([1, 2], (0.0, 0.1))
    assert np.array_equal(two.widths[:, 1], two.widths[:, 2])
