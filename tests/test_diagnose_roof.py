"""A sonic ranger on a roof: distance constant but unknown, air recorded; see ../shared/data."""

from pathlib import Path

import pytest

import echocal

COLUMNS = {
    "TIMESTAMP": "time",
    "SR_U": "reading_m",
    "Asp_temp_L": "temperature_C",
    "Humidity_L": "humidity_percent",
    "Pressure_L": "pressure_hPa",
    "WindSpeed_S_L": "wind_m_s",
    "SWUpper": "radiation_W_m2",
    "Asp_temp_U": "ignore",
    "Humidity_U": "ignore",
    "Pressure_U": "ignore",
}
JULY = {"since": "2022-07-05", "until": "2022-08-03", "hold_out_after": "2022-07-20"}
JUNE = {"since": "2022-06-09", "until": "2022-06-24"}


@pytest.fixture(scope="module")
def roof(shared: Path) -> Path:
    return shared / "data" / "roof-sr50" / "roof_fixed_target_tidy.csv"


def diagnose(roof: Path, **options: str | None) -> echocal.Diagnosis:
    with pytest.warns(echocal.DataWarning):
        return echocal.diagnose(roof, columns=COLUMNS, constant_distance=True, **options)  # type: ignore[arg-type]


def ids(diagnosis: echocal.Diagnosis) -> set[str]:
    return {cause.id for cause in diagnosis.causes}


def test_july_names_humidity(roof: Path) -> None:
    diagnosis = diagnose(roof, base="linear", reading_speed="331.4", **JULY)
    assert diagnosis.verdict == "named"
    humidity = next(cause for cause in diagnosis.causes if cause.id == "humidity")
    assert humidity.probability >= 0.9
    gain = diagnosis.gain
    assert gain is not None
    assert gain.rms_fixed_speed_m == pytest.approx(15e-3, abs=1e-3)
    assert gain.rms_before_m == pytest.approx(2.5e-3, abs=0.15e-3)
    assert gain.rms_after_m <= 2.2e-3  # no row from 20 July on takes part in the choice
    assert gain.interval_95[0] > 0


def test_july_without_the_reading_speed_names_both(roof: Path) -> None:
    diagnosis = diagnose(roof, base="linear", **JULY)
    assert {"fixed_speed", "humidity"} <= ids(diagnosis)
    gain = diagnosis.gain
    assert gain is not None
    assert gain.rms_before_m == pytest.approx(15e-3, abs=1e-3)
    assert gain.rms_after_m <= 2.2e-3  # no row from 20 July on takes part in the choice
    speed = next(p for c in diagnosis.causes for p in c.parameters if p.name == "speed")
    assert speed.standard_uncertainty > 3  # at an unknown distance nobody can tell which speed


@pytest.mark.parametrize("base", ["linear", "331.4"])
def test_june_finds_temperature_and_claims_no_humidity(roof: Path, base: str) -> None:
    diagnosis = diagnose(roof, base=base, **JUNE)
    assert "fixed_speed" in ids(diagnosis)
    assert "humidity" not in ids(diagnosis)


def test_june_with_temperature_accounted_for_claims_no_humidity(roof: Path) -> None:
    diagnosis = diagnose(roof, base="linear", reading_speed="331.4", **JUNE)
    assert "humidity" not in ids(diagnosis)
    assert any("the temperature changes the echo times" in note for note in diagnosis.notes)


def test_june_reports_the_step_and_does_not_blame_the_air(roof: Path) -> None:
    diagnosis = diagnose(roof, base="linear", reading_speed="331.4", **JUNE)
    assert len(diagnosis.rows["level_steps_at_rows"]) == 1  # 2022-06-24, 0.8 m
    assert diagnosis.gain is not None
    assert diagnosis.gain.rms_before_m < 3e-3


def test_the_tension_of_the_humidity_term_is_told(roof: Path) -> None:
    june = diagnose(roof, base="linear", reading_speed="331.4", **JUNE)
    (note,) = [note for note in june.notes if "humidity" in note and "theoretical size" in note]
    assert "is not claimed" in note
    size, digits = note.split("fitted size is ")[1].split(". ")[0].removesuffix(")").split("(")
    size, uncertainty = float(size), float(digits) * 10.0 ** -len(size.partition(".")[2])
    assert 0.0 < size < 1.0
    assert 0.05 < uncertainty < 0.5  # rows that owe each other something know less than 0.02


def test_no_cause_of_the_air_is_named_for_the_whole_record(roof: Path) -> None:
    diagnosis = diagnose(roof, base="linear", reading_speed="331.4")
    of_the_air = {"humidity", "pressure", "speed_slope", "speed_intercept", "gas_composition"}
    named = {cause.id for cause in diagnosis.causes if cause.probability >= 0.9}
    assert named.isdisjoint(of_the_air)
    assert diagnosis.unexplained is not None


def test_level_steps_before_june_are_steps(roof: Path) -> None:
    diagnosis = diagnose(roof, base="linear", reading_speed="331.4", until="2022-06-06")
    steps = diagnosis.rows["level_steps"]
    assert len(steps) >= 8
    assert {"2022-05-19", "2022-05-20", "2022-05-26", "2022-06-02"} <= {step.time[:10] for step in steps}
    assert all("2022-05-16" <= step.time < "2022-06-07" for step in steps)
    assert all(4e-3 < abs(step.size_m) < 60e-3 for step in steps)  # medians of a day jump by up to 22 mm
    assert "humidity" not in {r.id for r in diagnosis.refuted}
    named = {cause.id for cause in diagnosis.causes if cause.probability >= 0.5}
    assert not named & {"step_change", "drift"}  # they stand for steps that were missed
    assert any("the level changes in steps" in note for note in diagnosis.notes)
