"""Noise that grows with the distance: named where it has no memory, and far rows make no cause."""

import numpy as np
import pytest
from scipy.signal import lfilter

import echocal

STANDS, EACH, SHOT = 5, 60, 1.5e-3

Table = dict[str, np.ndarray]


def table(random: np.random.Generator, rho: float) -> Table:
    """Five stands, the temperature swept at each; the standard deviation in proportion to the distance."""
    distance = np.repeat(np.linspace(0.4, 3.8, STANDS), EACH)
    warm = np.tile(25.0 + 15.0 * np.sin(np.linspace(0.0, 2 * np.pi, EACH)), STANDS)
    shocks = random.normal(size=len(distance))
    shocks[1:] *= np.sqrt(1 - rho**2)
    errors = SHOT * distance / 2.0 * np.asarray(lfilter([1.0], [1.0, -rho], shocks))
    stand = np.repeat(np.arange(STANDS), EACH)
    return {"reading_m": distance + errors, "temperature_C": warm, "distance_m": distance, "stand": stand}


@pytest.mark.statistical
@pytest.mark.parametrize(("rho", "name"), [(0.0, "noise_growth"), (0.8, "correlated_noise")])
def test_growing_noise_is_named_by_its_memory(rho: float, name: str, random: np.random.Generator) -> None:
    answers = [echocal.diagnose(table(random, rho)) for _ in range(12)]
    found = [{cause.id for cause in one.causes if cause.probability > 0.5} for one in answers]
    other = {"noise_growth", "correlated_noise"} - {name}
    assert sum(name in one for one in found) >= 10
    assert sum(bool(other & one) for one in found) <= 2
    assert sum(one.noise["growth_with_distance"] > 0.0 for one in answers) >= 10
    assert sum(bool(one.model.effects) for one in answers) <= 1
