"""Causes beside a larger one: the shortlist has the forms that are best beside another cause, too."""

import numpy as np
import pytest

import echocal

ROWS = 600


@pytest.mark.statistical
def test_a_step_is_placed_beside_a_wrong_speed(random: np.random.Generator) -> None:
    distance, celsius = random.uniform(0.5, 3.5, ROWS), random.uniform(5.0, 35.0, ROWS)
    first = int(random.integers(150, 450))
    reading = distance * 343.0 / (331.4 + 0.6 * celsius) + random.normal(0.0, 1e-3, ROWS)
    reading[first:] += 6e-3
    table = {
        "reading_m": reading,
        "distance_m": distance,
        "temperature_C": celsius,
        "time_s": 60.0 * np.arange(ROWS),
    }
    found = {cause.id: cause for cause in echocal.diagnose(table, base="linear").causes}
    assert {"fixed_speed", "step_change"} <= set(found)
    begins = {p.name: p.value for p in found["step_change"].parameters}["time"]
    assert abs(begins / 60.0 - first) <= 3


@pytest.mark.statistical
def test_a_station_that_is_an_outlier_as_a_whole_is_kept(random: np.random.Generator) -> None:
    distance = np.repeat([0.5, 0.8, 1.1, 1.4, 1.7, 3.0], 40)
    reading = distance + random.normal(0.0, 1e-3, len(distance))
    reading[-40:] -= 0.12  # something at the edge of the beam answers first
    reading[7] += 0.5  # and one wild row
    celsius = random.uniform(15.0, 25.0, len(distance))
    table = {"reading_m": reading, "distance_m": distance, "temperature_C": celsius}
    diagnosis = echocal.diagnose(table)
    assert diagnosis.rows["used"] == len(distance) - 1
    told = {one.id for one in (*diagnosis.causes, *diagnosis.refuted)}
    assert "beam_edge" in told
    assert not diagnosis.model.effects  # one placement shows it, and no other can confirm it
    assert diagnosis.verdict == "ambiguous"


@pytest.mark.statistical
def test_white_noise_is_kept_beside_two_causes(random: np.random.Generator) -> None:
    """Beside either cause alone, the signal of the other is similar to autocorrelated noise."""
    rows = 3000
    distance, celsius = random.uniform(0.3, 4.0, rows), random.uniform(5.0, 25.0, rows)
    first = int(random.integers(600, 2400))
    reading = distance + 0.5 * (331.4 + 0.6 * celsius) * 35e-6 + random.normal(0.0, 1.5e-3, rows)
    reading[first:] -= 6e-3
    table = {
        "reading_m": reading,
        "distance_m": distance,
        "temperature_C": celsius,
        "time_s": 300.0 * np.arange(rows),
    }
    diagnosis = echocal.diagnose(table)
    found = {cause.id for cause in diagnosis.causes}
    assert "step_change" in found
    assert found & {"fixed_delay", "zero_error"}
    assert "correlated_noise" not in found
    assert diagnosis.noise["autoregression"] < 0.5


@pytest.mark.statistical
def test_a_cause_that_may_be_two_others_says_so(random: np.random.Generator) -> None:
    """A slope and a scale make what a clock that warms and a scale make, of other sizes."""
    rows = 400
    distance = np.repeat(np.linspace(0.4, 3.8, 5), rows // 5)
    celsius = np.tile(np.linspace(4.0, 44.0, rows // 5), 5)
    reading = distance * (1 + 20e-6 * (celsius - 25.0) + 5e-3) + random.normal(0.0, 1e-3, rows)
    diagnosis = echocal.diagnose({"reading_m": reading, "distance_m": distance, "temperature_C": celsius})
    alike = {"speed_slope", "temperature_gain", "clock_temperature_coefficient"}
    warm = [c for c in diagnosis.causes if c.in_model and alike & {c.id, *c.indistinguishable_from}]
    assert any(alike <= {c.id, *c.indistinguishable_from} for c in warm)
