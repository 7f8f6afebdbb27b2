"""What rounding to steps and a second statement do to a budget."""

from pathlib import Path

import numpy as np
import pytest

import echocal
from echocal.budget.instruments import INSTRUMENTS


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


def in_centimeters(random: np.random.Generator, count: int) -> dict[str, np.ndarray]:
    distance = random.uniform(0.4, 3.0, count)
    reading = np.round(distance + random.normal(0.0, 1e-3, count), 2)
    return {"reading_m": reading, "distance_m": distance, "temperature_C": np.full(count, 20.0)}


def test_a_step_that_the_model_knows_counts_once(random: np.random.Generator, tmp_path: Path) -> None:
    table = in_centimeters(random, 150)
    base = echocal.Model("linear")
    diagnosed = echocal.diagnose(table).model
    calibrated = echocal.calibrate(echocal.read_observations(table), base, ["zero_error.offset"]).model
    diagnosed.save(tmp_path / "model.json")
    for model in (diagnosed, calibrated, echocal.Model.load(tmp_path / "model.json")):
        plain = echocal.budget(model, table, trials=0)
        named = echocal.budget(model, table, uncertainties={"resolution_mm": 10}, trials=0)
        coarser = echocal.budget(model, table, uncertainties={"resolution_cm": 5}, trials=0)
        np.testing.assert_allclose(named.standard_uncertainty, plain.standard_uncertainty, rtol=0.01)
        more = coarser.standard_uncertainty**2 - plain.standard_uncertainty**2
        np.testing.assert_allclose(more, (0.05**2 - 0.01**2) / 12, rtol=0.02)
        assert any("has the rounding to steps of 10 mm" in note for note in named.notes)
        assert not any("resolution_mm" in note for note in plain.notes), plain.notes


@pytest.mark.parametrize("step", [10.0, 1.0, 25.4])
def test_a_table_in_steps_is_told_its_step(random: np.random.Generator, step: float) -> None:
    reading = step * np.round(random.uniform(400, 3000, 60) / step)
    table = {"reading_mm": reading, "temperature_C": np.full(60, 20.0)}
    notes = echocal.budget("linear", table, trials=0).notes
    assert any(f"in steps of {step:g} mm: state them, resolution_mm={step:g}" in note for note in notes)
    stated = {"resolution_mm": step}
    assert not any(
        "in steps" in n for n in echocal.budget("linear", table, uncertainties=stated, trials=0).notes
    )
    free = {**table, "reading_mm": reading + random.uniform(-0.4, 0.4, 60)}
    assert not any("in steps" in note for note in echocal.budget("linear", free, trials=0).notes)


def test_coarser_readings_than_those_of_the_model_are_told(random: np.random.Generator) -> None:
    distance = random.uniform(0.4, 3.0, 120)
    fine = {
        "reading_m": np.round(distance + random.normal(0.0, 1e-3, 120), 3),
        "distance_m": distance,
        "temperature_C": np.full(120, 20.0),
    }
    notes = echocal.budget(echocal.diagnose(fine).model, in_centimeters(random, 50), trials=0).notes
    assert any("steps of 10 mm, and the model knows of steps of 1 mm" in note for note in notes), notes


@pytest.mark.parametrize(("part", "wide"), [("SHT40", 0.03), ("SHT41", 0.02)])
def test_limits_follow_the_humidity(part: str, wide: float) -> None:
    own = INSTRUMENTS["hygrometer"][part].half_width([0.1, 0.25, 0.5, 0.9])
    assert own.tolist() == [wide, 0.018, 0.018, wide]
