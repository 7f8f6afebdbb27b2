"""Ridges, columns that are averaged out, densities and mixtures of the diagnosis, by hand."""

import numpy as np
import pytest
from scipy.stats import norm, t

from echocal.diagnose.candidates.columns import legendre, waves
from echocal.diagnose.candidates.variant import Variant
from echocal.diagnose.inference.alias import Geometry
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


def test_a_form_within_its_bounds_and_beside_what_stays() -> None:
    """Columns 0 and 1 are the same, column 2 is at 60 degrees to them, and column 3 is twice as long."""
    products = np.array([[4.0, 4, 2, 8], [4, 4, 2, 8], [2, 2, 4, 4], [8, 8, 4, 16]])
    signal, anything = np.array([-2.0, 0.0, 0.0, 0.0]), (-np.inf, np.inf)
    free = {1: [anything, (0.0, 9.0)], 2: [anything]}
    forms = [Variant("a", free=(column,), bounds=(own,)) for column, each in free.items() for own in each]
    forms += [Variant("a", offset=3), Variant("a", offset=3, free=(1,), bounds=(anything,))]
    geometry = Geometry(products, 1.0)
    left, size = geometry._imitations(signal, np.zeros(4), forms)
    np.testing.assert_allclose(left, [0.0, 8.0, 6.0, 32.0, 0.0], atol=1e-9)
    np.testing.assert_allclose(size, [2.0, 0.0, 1.0, 1.0, 4.0], atol=1e-9)
    beside = np.array([0.0, 0.5, 0.0, 0.0])  # it may become what the third column misses
    left, size = geometry._imitations(signal, beside, forms[2:3])
    np.testing.assert_allclose([*left, *size], [0.0, 1.5], atol=1e-9)


def test_functions_of_a_column() -> None:
    """Abramowitz & Stegun 1964, table 22.9; what is far off is cut off at 1.5 (here 9, between 1 and 5)."""
    x = np.array([0.7, -0.3])
    found = legendre(x, -1.0, 1.0, 5)
    np.testing.assert_allclose(found[3], (5 * x**3 - 3 * x) / 2)
    np.testing.assert_allclose(found[5], (63 * x**5 - 70 * x**3 + 15 * x) / 8)
    np.testing.assert_allclose(legendre(np.array([3.0, 9.0]), 1.0, 5.0, 1)[1], [0.0, 1.5])
    (sine, cosine), (twice, _) = waves(np.array([3.0, 30.0]), 24.0, 2)
    np.testing.assert_allclose(sine, np.sin([np.pi / 4, np.pi / 2]))
    np.testing.assert_allclose([cosine[1], twice[0]], [0.0, 1.0], atol=1e-12)
