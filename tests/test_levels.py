"""Levels: columns that rise where the distance falls, with a mount height that is stated or fitted."""

from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest
from typer.testing import CliRunner

import echocal
from echocal.cli import app

HEIGHT = 2.6
CAUSE = echocal.Model("linear", {"clock_error": {"frequency_error": 0.01}})
UNITS = {"m": 1.0, "cm": 100.0, "mm": 1000.0, "inch": 1 / 0.0254, "ft": 1 / 0.3048}


def tank(seed: int, offset: float = 0.0) -> tuple[pd.DataFrame, np.ndarray]:
    """A tank whose device is 1 % long, with a gauge beside it; and the true level."""
    rng = np.random.default_rng(seed)
    row = np.arange(160.0)
    temperature = 15 + 8 * np.sin(row / 9 + rng.uniform(0, 6)) + rng.normal(0, 0.2, len(row))
    level = 0.9 + 0.7 * np.sin(row / rng.uniform(12, 25)) + rng.normal(0, 0.05, len(row))
    reading = CAUSE.indicate(HEIGHT - level, temperature=temperature) + rng.normal(0, 1e-3, len(row))
    table = pd.DataFrame(
        {
            "Lvl": (100 * (HEIGHT - reading)).round(2),
            "gauge": (level + offset).round(4),
            "temperature_C": temperature.round(2),
        }
    )
    return table, level


COLUMNS = {"Lvl": "level_cm", "gauge": "reference_level_m"}


@pytest.mark.parametrize("unit", UNITS)
def test_a_level_is_the_distance_below_its_mount(unit: str) -> None:
    distance = np.array([1.4, 0.8, 2.35])
    table = {"Lvl": (HEIGHT - distance) * UNITS[unit], "temperature_C": [20.0, 21.0, 22.0]}
    read = echocal.read_observations(table, {"Lvl": f"level_{unit}"}, mount_height=HEIGHT)
    assert read.reading is not None
    np.testing.assert_allclose(read.reading, distance, rtol=0, atol=1e-12)
    assert read.mount_height == HEIGHT
    said = echocal.read_observations(table, {"Lvl": f"level in {unit} below 2.6 m"})
    assert np.array_equal(said.echo_time, read.echo_time)


def test_the_diagnosis_is_that_of_the_distances() -> None:
    table, _ = tank(1)
    distances = pd.DataFrame(
        {
            "reading_cm": 100 * HEIGHT - table["Lvl"],
            "distance_m": HEIGHT - table["gauge"],
            "temperature_C": table["temperature_C"],
        }
    )
    levels = echocal.diagnose(table, columns=COLUMNS, mount_height=HEIGHT)
    plain = echocal.diagnose(distances)
    assert levels.verdict == plain.verdict == "named"
    assert [one.id for one in levels.causes] == [one.id for one in plain.causes]
    assert levels.gain.rms_after_m == pytest.approx(plain.gain.rms_after_m, rel=1e-6)


def test_a_level_is_corrected_to_a_level_in_every_kind_of_file(tmp_path: Path) -> None:
    table, level = tank(2)
    model = echocal.diagnose(table, columns=COLUMNS, mount_height=HEIGHT).model
    model.save(tmp_path / "model.json")
    corrected = echocal.correct(table, model, {"Lvl": "level_cm", "gauge": "ignore"})
    found = corrected.table["corrected_level_m"].to_numpy()
    assert abs((found - level).mean()) < 1e-3
    assert (found - level).std() < 2e-3
    assert "corrected_distance_m" not in corrected.table
    table.to_csv(tmp_path / "in.csv", index=False)
    table.to_parquet(tmp_path / "in.parquet")
    for source in ("csv", "parquet"):
        for kind, read in (("csv", pd.read_csv), ("parquet", pd.read_parquet)):
            arguments = ["correct", str(tmp_path / f"in.{source}"), "-o", str(tmp_path / f"out.{kind}")]
            arguments += ["--model", str(tmp_path / "model.json"), "--column", "Lvl=level_cm"]
            for _ in range(2):  # the second run recognizes the output of the first
                done = CliRunner().invoke(app, arguments)
                assert done.exit_code == 0, done.output
            written: Any = read(tmp_path / f"out.{kind}")
            assert list(written.columns)[-4] == "corrected_level_m"
            np.testing.assert_allclose(written["corrected_level_m"], found, rtol=0, atol=1e-8)


def test_a_height_that_is_not_given_is_fitted_in_every_draw() -> None:
    """15 draws: with distances beside the levels, the corrected level is right without the height."""
    close = 0
    for seed in range(15):
        table, level = tank(seed)
        table["distance_m"] = (HEIGHT - table["gauge"]).round(4)
        columns = {"Lvl": "level_cm", "gauge": "ignore"}
        diagnosis = echocal.diagnose(table, columns=columns)
        assert any("is not given and is fitted" in note for note in diagnosis.notes)
        corrected = echocal.correct(table, diagnosis.model, columns).table["corrected_level_m"]
        close += bool(abs((corrected - level).mean()) < 2e-3 and (corrected - level).std() < 2e-3)
    assert close == 15


def test_a_reference_level_with_another_zero_is_fitted() -> None:
    """A gauge whose zero is 0.37 m elsewhere; without its height the sum with the reading tells it."""
    table, _ = tank(3, offset=0.37)
    table["reading_m"] = (HEIGHT - table.pop("Lvl") / 100).round(4)
    diagnosis = echocal.diagnose(table, columns={"gauge": "reference_level_m"})
    assert "clock_error" in {id_ for one in diagnosis.causes for id_ in (one.id, *one.indistinguishable_from)}
    assert diagnosis.gain.rms_after_m is not None
    assert diagnosis.gain.rms_after_m < 2e-3


@pytest.mark.parametrize(
    ("columns", "height", "says"),
    [
        (COLUMNS, None, "'Lvl' holds a level, and distance = mount height - level"),
        (COLUMNS, -1.0, "above 0 and at most 100"),
        ({"gauge": "ignore", "Lvl": "reading_cm"}, 2.6, "is for a column that holds a level"),
        ({"gauge": "ignore", "Lvl": "level_m"}, 2.6, "as level_cm"),
        ({"gauge": "ignore", "Lvl": "level_cm below the roof"}, None, "'level_cm below 2.6 m'"),
    ],
)
def test_what_is_no_level_or_has_no_height_is_refused(
    columns: dict[str, str], height: float | None, says: str
) -> None:
    table, _ = tank(4)
    with pytest.raises((echocal.DataError, echocal.UsageError), match=says):
        echocal.read_observations(table, columns, mount_height=height)


def test_a_model_with_a_fitted_height_takes_no_other() -> None:
    table, _ = tank(5)
    table["distance_m"] = HEIGHT - table.pop("gauge")
    model = echocal.diagnose(table, columns={"Lvl": "level_cm"}).model
    with pytest.raises(echocal.UsageError, match="fitted the mount height"):
        echocal.correct(table, model, {"Lvl": "level_cm"}, mount_height=2.7)


def test_a_level_above_the_sensor_is_no_row_that_can_be_used() -> None:
    table = {"Lvl": [120.0, 261.0, 260.0, 90.0], "temperature_C": [20.0] * 4}
    with pytest.warns(echocal.DataWarning, match=r"2 values at or above 260, first at row 2: 261"):
        read = echocal.read_observations(table, {"Lvl": "level_cm"}, mount_height=HEIGHT)
    assert read.usable.tolist() == [True, False, False, True]


def test_a_column_named_level_is_what_it_was() -> None:
    """Only who says it is a level makes it one."""
    read = echocal.read_observations(
        {"reading_m": [1.0, 1.1], "level_m": [0.2, 0.3], "temperature_C": [20, 21]}
    )
    assert list(read.extra) == ["level_m"]
    assert read.mount_height is None


def test_the_command_takes_the_height_from_a_file_of_options(tmp_path: Path) -> None:
    table, _ = tank(6)
    table.to_csv(tmp_path / "tank.csv", index=False)
    options = 'mount-height = 2.6\n[column]\n"Lvl" = "level_cm"\n"gauge" = "reference_level_m"\n'
    (tmp_path / "log.toml").write_text(options)
    arguments = ["diagnose", str(tmp_path / "tank.csv"), "--options", str(tmp_path / "log.toml")]
    done = CliRunner().invoke(app, [*arguments, "--json", str(tmp_path / "d.json")])
    assert done.exit_code == 0, done.output
    wrong = CliRunner().invoke(app, ["diagnose", str(tmp_path / "tank.csv"), "--column", "Lvl=level_cm"])
    assert isinstance(wrong.exception, echocal.UsageError)
    assert "--mount-height METERS" in str(wrong.exception)
