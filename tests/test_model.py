import numpy as np
import pytest

import echocal


def test_round_trip_over_arrays() -> None:
    model = echocal.Model("cramer", {"fixed_delay": {"delay": 31e-6}, "zero_error": {"offset": 2e-3}})
    distance = np.linspace(0.02, 4.0, 7)[:, None]
    temperature = np.linspace(-10.0, 50.0, 5)
    indication = model.indicate(distance, temperature=temperature, relative_humidity=0.4)
    assert indication.shape == (7, 5)
    back = model.correct(indication, temperature=temperature, relative_humidity=0.4)
    np.testing.assert_allclose(back, np.broadcast_to(distance, (7, 5)), rtol=0, atol=1e-12)


def test_unknown_effect_names_the_known_ones() -> None:
    with pytest.raises(echocal.ModelError, match="fixed_delay"):
        echocal.Model("cramer", {"fixed_dely": {}})
