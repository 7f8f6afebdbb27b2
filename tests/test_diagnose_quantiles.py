"""Quantiles of long columns are numpy's to the bit."""

import numpy as np
import pytest

from echocal.diagnose.quantiles import median, quantiles


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
