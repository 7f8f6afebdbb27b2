"""A model, and the code made of it, say which class and which member the diagnosis found."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest

import echocal
from echocal.model.origin import diagnosed


@pytest.mark.statistical
def test_the_header_says_what_the_diagnosis_says(random: np.random.Generator, tmp_path: Path) -> None:
    distance = np.tile([0.4, 1.0, 2.0, 3.0], 50)
    reading = 1.006 * distance + random.normal(0.0, 1e-3, 200)
    table = {"reading_m": reading, "distance_m": distance, "temperature_C": random.uniform(5.0, 35.0, 200)}
    diagnosis = echocal.diagnose(table)
    diagnosis.model.save(tmp_path / "model.json")
    model = echocal.Model.load(tmp_path / "model.json")
    (cause, *_) = [one for one in diagnosis.causes if one.in_model and one.kind == "effect"]
    made = echocal.firmware.generate(model, temperature=(1.0, 0, 40))
    header = made.files["echocal_correction.h"]
    assert f"* - verdict: {diagnosis.verdict}\n" in header
    count = 1 + len(cause.indistinguishable_from)
    assert count > 1  # a scale has many causes
    assert f"cause {cause.id}: one of {count} causes that the data cannot separate" in header
    assert f"one of them acts: {cause.probability:.3f}" in header
    assert f"that it is {cause.id} itself: {cause.probability_alone:.3f}" in header
    gain = diagnosis.gain
    assert f"{1e3 * gain.rms_before_m:.2f} mm with the base, {1e3 * gain.rms_after_m:.2f} mm" in header
    assert f"{100 * gain.variance_removed:.0f} % (" in header
    assert made.report["provenance"]["diagnosis"] == diagnosed(model.provenance)


def test_a_model_without_a_diagnosis_has_no_such_lines() -> None:
    made = echocal.firmware.generate(echocal.Model("linear"), temperature=(1.0, 0, 40))
    assert "Diagnosis" not in made.files["echocal_correction.h"]
    assert "diagnosis" not in made.report["provenance"]


@pytest.mark.parametrize(
    "provenance",
    [
        {"causes": 3, "gain": [], "verdict": None},
        {"causes": [None, {}, {"id": 1}, {"id": "a", "probability": "high", "indistinguishable_from": 2}]},
        {"gain": {"rms_before_m": None}},
        {"gain": {"rms_before_m": 1.0, "rms_after_m": 1.0, "variance_removed_interval_95": [1]}},
    ],
)
def test_notes_of_others_are_left_out(provenance: dict[str, Any]) -> None:
    assert diagnosed(provenance) == []
