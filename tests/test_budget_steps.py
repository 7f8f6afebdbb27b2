"""What rounding to steps and a second statement do to a budget."""

import numpy as np
import pytest

import echocal


def test_a_stated_condition_has_no_thermometer() -> None:
    table = {"echo_us": [1e4, 1.1e4]}
    with pytest.raises(
        echocal.UsageError, match=r"twice, by temperature as a number and by thermometer=DHT22"
    ):
        echocal.budget(
            "cramer", table, at={"temperature": "20+-2"}, uncertainties={"thermometer": "DHT22"}, trials=0
        )


def test_readings_in_whole_centimeters_are_no_better_than_their_step(random: np.random.Generator) -> None:
    """Targets at whole centimeters hide the rounding; a target elsewhere shows it."""
    distance = np.repeat(np.round(random.uniform(0.4, 3.0, 12), 2), 10)
    reading = np.round(distance + random.normal(0.0, 1e-3, 120), 2)
    assert np.std(reading - distance) < 1e-3  # m
    table = {"reading_m": reading, "distance_m": distance, "temperature_C": np.full(120, 20.0)}
    base = echocal.Model("linear")
    diagnosed = echocal.diagnose(table).model
    calibrated = echocal.calibrate(echocal.read_observations(table), base, ["zero_error.offset"]).model
    elsewhere = random.uniform(0.4, 3.0, 400)
    fresh = {
        "reading_m": np.round(elsewhere + random.normal(0.0, 1e-3, 400), 2),
        "temperature_C": np.full(400, 20.0),
    }
    for model in (diagnosed, calibrated):
        found = echocal.budget(model, fresh, trials=0)
        assert found.standard_uncertainty.min() > 0.999 * 0.01 / 12**0.5
        assert np.mean(np.abs(found.distance - elsewhere) < found.expanded_uncertainty) > 0.93


def test_readings_without_scatter_show_no_repeatability() -> None:
    """Two readings have any step, and errors of 1e-13 m are those of arithmetic."""
    distance = np.tile([1.0, 2.0], 20)
    table = {"reading_m": distance, "distance_m": distance, "temperature_C": np.linspace(15.0, 25.0, 40)}
    model = echocal.diagnose(table).model
    assert model.residual_uncertainty is None
    notes = echocal.budget(model, table, trials=0).notes
    assert any("does not state the repeatability" in note for note in notes)
