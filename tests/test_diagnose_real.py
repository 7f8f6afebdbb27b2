"""Real records with something known about them: what is found, and what is not claimed."""

import warnings
from pathlib import Path

import pandas as pd
import pytest

import echocal
from echocal.diagnose import Cause

BOX = {
    "Exp Distance": "two_way_distance_m",
    "Measured Time Diff": "echo_s",
    "Temperature": "temperature_K",
    "run": "stand",
    **dict.fromkeys(("Derived k_B", "Derived k_B Error", "Pressure", "HC-SRO4 Raw", "L"), "ignore"),
}
ROCK = {
    "Time [UTC]": "time",
    "Distance [mm]": "reading_mm",
    "Temp Atmos [C]": "temperature in degC",
    "Humidity [%]": "humidity in %",
    "PresOB [mBar]": "pressure in mbar",
    "Bat [V]": "supply_V",
}
OFFSET = {"fixed_delay", "zero_error"}


def session(shared: Path, day: str) -> echocal.Diagnosis:
    """Every session whose day begins so."""
    table = pd.read_csv(shared / "data" / "kb-hcsr04" / "all_runs_tidy.csv")
    chosen = table["day"].str.startswith(day)
    return echocal.diagnose(table[chosen].reset_index(drop=True), columns=BOX)


def offsets(diagnosis: echocal.Diagnosis) -> list[Cause]:
    return [c for c in diagnosis.causes if {c.id, *c.indistinguishable_from} >= OFFSET]


@pytest.mark.parametrize("day", ["2019-05-15", "2019-05-21"])
def test_a_may_session_has_the_delay_and_cannot_tell_it_from_an_offset(shared: Path, day: str) -> None:
    (cause,) = offsets(session(shared, day))
    assert cause.probability >= 0.8
    (size,) = cause.parameters
    meters = size.value if cause.id == "zero_error" else size.value * 345.0 / 2
    microseconds = 1e6 * 2 * meters / 345.0  # at 22 degC
    assert microseconds == pytest.approx(-55.0, abs=15.0)  # what the authors added two weeks later


def test_a_may_session_leaves_open_what_scales(shared: Path) -> None:
    scales = [c for c in session(shared, "2019-05-15").causes if "clock_error" in c.indistinguishable_from]
    assert scales
    assert {"speed_intercept", "temperature_offset"} <= set(scales[0].indistinguishable_from)


def test_where_the_authors_had_corrected_the_delay_none_is_claimed(shared: Path) -> None:
    assert not offsets(session(shared, "2019-06-03"))


@pytest.mark.parametrize("sessions", ["2019-05", "2019"])
def test_sessions_that_differ_are_not_misnamed(shared: Path, sessions: str) -> None:
    diagnosis = session(shared, sessions)
    assert not [c for c in diagnosis.causes if c.kind == "effect" and c.probability >= 0.9 and not c.doubt]
    assert not diagnosis.model.effects


@pytest.mark.slow
def test_bare_rock_names_no_effect(shared: Path) -> None:
    path = shared / "data" / "weather-maxbotix" / "WS3-Orloc.csv"
    codes = {"Distance [mm]": [-500, 9999], "": [-9999]}
    with warnings.catch_warnings(action="ignore"):
        diagnosis = echocal.diagnose(path, columns=ROCK, skip_lines=1, missing=codes, constant_distance=True)
    assert not [c for c in diagnosis.causes if c.kind == "effect" and not c.doubt]
    assert not diagnosis.model.effects
    if diagnosis.unexplained is not None:
        assert diagnosis.unexplained.rms_m < 1e-3  # a sensor that reads whole millimeters
