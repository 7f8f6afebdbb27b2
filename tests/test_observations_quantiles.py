"""Quantiles of long columns are numpy's to the bit."""

import numpy as np
import pytest

from echocal.observations.quantiles import Grouped, median, quantiles


@pytest.mark.parametrize("count", [1, 2, 3, 10, 1001, 20_000])
def test_as_numpy(count: int) -> None:
    random = np.random.default_rng(count)
    for values in (random.normal(size=count), np.round(random.normal(size=count), 1)):
        before = values.copy()
        assert median(values) == np.median(values)
        parts = [0.0, 0.005, 0.2, 0.5, 0.8, 0.98, 1.0]
        assert quantiles(values, parts) == np.quantile(values, parts).tolist()
        np.testing.assert_array_equal(values, before)
        values[count // 3] = np.nan
        assert np.isnan(median(values))


@pytest.mark.parametrize(("count", "groups"), [(60, [0, 1, 3]), (20_000, [0, 1, 3]), (20_000, [0, 1, 2, 3])])
def test_medians_of_groups(count: int, groups: list[int]) -> None:
    random = np.random.default_rng(3)
    labels = random.choice(groups, count)
    values = random.normal(size=count)
    for some in (values, np.where(np.arange(count) % 7 == 0, np.nan, values)):
        medians = Grouped(labels).median(some)
        assert np.isnan(medians[2]) == (2 not in groups)
        for group in groups:
            assert medians[group] == np.nanmedian(some[labels == group])
        centers, usual, farthest = Grouped(labels).scatter(some)
        np.testing.assert_array_equal(centers, medians)
        off = np.abs(some - medians[labels])
        np.testing.assert_array_equal(usual, Grouped(labels).median(off))
        assert farthest == np.nanmax(off)
