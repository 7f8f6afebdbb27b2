"""A base that is a fixed speed: the model of its diagnosis corrects what the diagnosis has seen."""

from typing import Any

import numpy as np
import pytest

import echocal

DEVICE = echocal.Model("linear", {"fixed_speed": {"weight": 1, "speed": 343}})


@pytest.mark.parametrize("recorded", ["reading_m", "echo_us"])
@pytest.mark.parametrize("how", ["correct", "diagnosis", "saved"])
def test_the_model_corrects_the_table_of_its_diagnosis(recorded: str, how: str, tmp_path: Any) -> None:
    """12.7 mm off in the mean before: the indication of the device was taken for that of the law."""
    rng = np.random.default_rng(3)
    row = np.arange(120)
    temperature = 15 + 8 * np.sin(row / 9) + rng.normal(0, 0.2, len(row))
    distance = 1.8 - 0.7 * np.sin(row / 17)
    reading = DEVICE.indicate(distance, temperature=temperature) + rng.normal(0, 1e-3, len(row))
    held = {"reading_m": reading.round(4), "echo_us": (2e6 * reading / 343).round(1)}
    table = {recorded: held[recorded], "distance_m": distance, "temperature_C": temperature.round(2)}
    diagnosis = echocal.diagnose(table, base="343")
    assert "fixed_speed" in {one.id for one in diagnosis.causes}
    model = diagnosis.model
    if how == "saved":
        model.save(tmp_path / "model.json")
        model = echocal.Model.load(tmp_path / "model.json")
    corrected = diagnosis.correct(table) if how == "diagnosis" else echocal.correct(table, model)
    error = np.asarray(corrected.table["corrected_distance_m"]) - distance
    assert abs(error.mean()) < 5e-4
    assert error.std() < 1.5e-3


def test_the_budget_of_such_a_model_is_that_of_its_readings() -> None:
    """The indication of the device grows with its own speed: at 0 degC that of the law is 3.5 % less."""
    model = echocal.Model("linear").with_provenance({"indication_speed": "343"})
    table = {"echo_us": [11_000.0, 12_000.0], "temperature_C": [0.0, 0.0]}
    found = echocal.budget(model, table, uncertainties={"echo_us": 2.0}, trials=0)
    entry = next(one for one in found.entries if one.quantity == "echo_time")
    more = echocal.correct({**table, "echo_us": [11_001.0, 12_001.0]}, model).table["corrected_distance_m"]
    moved = np.asarray(more) - np.asarray(echocal.correct(table, model).table["corrected_distance_m"])
    np.testing.assert_allclose(entry.sensitivity, moved / 1e-6, rtol=1e-6)
