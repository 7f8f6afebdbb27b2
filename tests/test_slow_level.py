"""A level that moves under a distance that is only assumed to be constant."""

import numpy as np
import pytest

import echocal


def log(random: np.random.Generator, rise: float) -> dict[str, np.ndarray]:
    """Ten days, a row each half hour; the level rises by `rise` [m]."""
    row = np.arange(480)
    temperature = 12 + 7 * np.sin(2 * np.pi * row / 48) + random.normal(0, 0.3, 480)
    reading = 2.5 - rise * row / 480 + random.normal(0, 1e-3, 480)
    return {"reading_m": reading, "temperature_C": temperature, "time_s": 1800.0 * row}


@pytest.mark.statistical
def test_a_rising_level_is_said_and_not_corrected(random: np.random.Generator) -> None:
    diagnosis = echocal.diagnose(log(random, 0.02), constant_distance=True)
    causes = {cause.id: cause for cause in diagnosis.causes}
    assert "drift" not in causes
    assert "drift" not in diagnosis.model.effects
    level = causes["slow_level"]
    assert level.indistinguishable_from == ("drift",)
    sizes = {p.name: p.value for p in level.parameters}
    assert sizes["movement"] == pytest.approx(-0.02, abs=0.002)
    assert "only assumed to be constant" in level.because


@pytest.mark.statistical
def test_a_drift_over_known_distances_keeps_its_name(random: np.random.Generator) -> None:
    table = log(random, 0.02)
    table["distance_m"] = np.full(480, 2.5)
    causes = {cause.id for cause in echocal.diagnose(table).causes}
    assert "drift" in causes
    assert "slow_level" not in causes


@pytest.mark.statistical
def test_a_still_level_is_not_said_to_move(random: np.random.Generator) -> None:
    """None of 40 logs drawn."""
    causes = {cause.id for cause in echocal.diagnose(log(random, 0.0), constant_distance=True).causes}
    assert "slow_level" not in causes
