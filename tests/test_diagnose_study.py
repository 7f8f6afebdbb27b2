"""The study's Table 2: one distance, one row per temperature, a device with one fixed speed."""

from pathlib import Path

import pytest

import echocal

TABLE = Path(__file__).parents[1] / "examples" / "study_table2.csv"


@pytest.fixture(scope="module")
def diagnosis() -> echocal.Diagnosis:
    return echocal.diagnose(TABLE)


def test_the_missing_temperature_is_named(diagnosis: echocal.Diagnosis) -> None:
    assert diagnosis.verdict == "named"
    (cause,) = (cause for cause in diagnosis.causes if cause.kind == "effect")
    assert cause.id == "fixed_speed"
    assert cause.probability > 0.99


def test_the_speed_is_what_a_plain_fit_gives(diagnosis: echocal.Diagnosis) -> None:
    table = echocal.read_observations(TABLE)
    law = 331.4 + 0.6 * table.conditions["temperature"]  # an independent least-squares fit of one number
    shape = 2.0 / law
    speed = float(shape @ table.reading / (shape @ shape))
    found = {p.name: p for p in diagnosis.causes[0].parameters}["speed"]
    assert abs(found.value - speed) < 3 * found.standard_uncertainty


def test_held_out_rows_gain_what_can_be_gained(diagnosis: echocal.Diagnosis) -> None:
    gain = diagnosis.gain
    assert gain is not None
    assert gain.rms_before_m == pytest.approx(56.57e-3, abs=0.05e-3)  # the study's own RMSE
    assert gain.rms_after_m < 3e-3
    assert gain.interval_95[0] > 0.02
    assert gain.fraction_of_reachable is not None
    assert gain.fraction_of_reachable > 0.98


def test_one_distance_is_admitted_to_hide_an_error_of_the_reference(diagnosis: echocal.Diagnosis) -> None:
    assert any("the same reference distance" in note for note in diagnosis.notes)
