"""Ridges, columns that are averaged out, densities and mixtures of the diagnosis, by hand."""

import numpy as np
import pytest
from scipy.stats import norm, t

from echocal.diagnose.inference.least_squares import averaged_out, principal, ridge
from echocal.diagnose.noises.cycle_slip import _fitted, _Groups
from echocal.diagnose.preprocess.density import fitted, log_density, weight

Random = np.random.Generator


def test_a_column_that_is_averaged_out() -> None:
    """The first column has a square of 3: with a variance of 2 it takes 1 * 4 / 5 from the rest."""
    products = np.array([[[3.0, 1.0, 4.0], [1.0, 2.0, 0.5], [4.0, 0.5, 9.0]]])
    found, log = averaged_out(products, [0], range(3), [0, 0], np.array([2.0, np.inf]))
    np.testing.assert_allclose(found[0], [[0, 0, 0], [0, 2.0 - 0.2, 0.5 - 0.8], [0, 0.5 - 0.8, 9.0 - 3.2]])
    np.testing.assert_allclose(found[1], [[0, 0, 0], [0, 2.0, 0.5], [0, 0.5, 9.0]])
    np.testing.assert_allclose(log, [-0.5 * np.log(2.5), 0.0])
    some, _ = averaged_out(products, [0], [1, 2], [0], np.array([2.0]))
    np.testing.assert_allclose(some[0], found[0, 1:, 1:])
    np.testing.assert_array_equal(products[0, 0], [3.0, 1.0, 4.0])  # what is given stays


def test_a_ridge_on_one_column() -> None:
    """A column of square 4 along 2 with a square of 10, of 8 rows: the ridge is 10 / 8 / 9."""
    products = np.array([[1.0, 0.0, 0.0], [0.0, 4.0, 2.0], [0.0, 2.0, 10.0]])
    added = 10.0 / 8.0 / 9.0
    size = 2.0 / (4.0 + added)
    sizes, left = ridge(products, 8)
    np.testing.assert_allclose(sizes, [size])
    np.testing.assert_allclose(left, (10.0 - 2.0 * size - added * size**2) / 8.0)
    squares, along = principal(products)
    np.testing.assert_allclose(squares, [4.0])
    np.testing.assert_allclose(along / (squares + added), [size])
    both, _ = ridge(np.stack([products, 2.0 * products]), 8)
    np.testing.assert_allclose(both, [[size], [2.0 * 2.0 / (8.0 + 2.0 * added)]])


@pytest.mark.parametrize("freedom", [np.inf, 8.0, 2.5])
def test_densities_and_the_scale_of_greatest_likelihood(freedom: float, random: Random) -> None:
    known = norm if np.isinf(freedom) else t(freedom)
    values = random.normal(0.0, 2.0, 60)
    np.testing.assert_allclose(log_density(values, 3.0, freedom), known.logpdf(values / 3.0) - np.log(3.0))
    scale, log = fitted(values, freedom, 0.0)
    counts = np.mean(weight(values, scale, freedom) * values**2)
    np.testing.assert_allclose(counts, scale**2, rtol=1e-2)  # where the likelihood is flat
    assert log == pytest.approx(log_density(values, scale, freedom).sum())
    lines, _ = fitted(np.stack([values, 3.0 * values]), freedom, 0.0)
    np.testing.assert_allclose(lines, [scale, 3.0 * scale])
    assert fitted(values, freedom, 70.0)[0] == 70.0


def test_groups_far_apart() -> None:
    """Eight rows at 0 and four one step further, each 0.1 or -0.1 off: nothing is in doubt."""
    left = (np.arange(12) >= 8) + 0.1 * np.tile([1.0, -1.0], 6)
    one = np.zeros(12, dtype=np.int64)
    log, weights, scale, level = _fitted(
        left, np.ones(12), _Groups(one, (0, 1), one), np.inf, (np.zeros(12), 0.2, 0.0)
    )
    np.testing.assert_allclose(weights, [[2 / 3, 1 / 3]])
    assert scale == pytest.approx(0.1)
    assert not level.any()
    each = -0.5 - np.log(0.1) - 0.5 * np.log(2 * np.pi)
    assert log == pytest.approx(12 * each + 8 * np.log(2 / 3) + 4 * np.log(1 / 3))


def test_a_level_of_each_segment() -> None:
    left = np.array([0.31, 0.29, 0.3, 1.3, -0.19, -0.21, -0.2, -0.2])
    one, segment = np.zeros(8, dtype=np.int64), np.repeat([0, 1], 4)
    _, weights, _, level = _fitted(
        left, np.ones(8), _Groups(one, (-1, 0, 1), segment), 4.0, (np.zeros(8), 0.3, 100.0)
    )
    np.testing.assert_allclose(level[[0, 7]], [0.3, -0.2], atol=1e-3)
    assert weights[0, 2] == pytest.approx(1 / 8, abs=1e-3)
