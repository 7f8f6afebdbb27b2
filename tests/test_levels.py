"""Levels: columns that rise where the distance falls, with a mount height that is stated or fitted."""

from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest
from typer.testing import CliRunner

import echocal
from echocal.cli import app
from echocal.observations.inspection import inspect_log
from echocal.observations.mount import kept_height

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


@pytest.mark.parametrize("name", ["level_m", "reference_level_m"])
def test_a_level_by_its_header_is_never_taken_for_a_distance(name: str, tmp_path: Path) -> None:
    table, _ = tank(7)
    renamed = (
        table.rename(columns={"gauge": name}) if name != "level_m" else table.assign(level_m=table["gauge"])
    )
    found = inspect_log(renamed.drop(columns=["Lvl"]).assign(echo_us=9000.0 - 3000.0 * table["gauge"]))
    proposed = {column.name: column.proposal.request for column in found.columns}
    assert proposed[name] in (name, "")
    renamed.to_csv(tmp_path / "tank.csv", index=False)
    asked = CliRunner().invoke(app, [str(tmp_path / "tank.csv")])
    assert isinstance(asked.exception, echocal.EchocalError)
    assert "distance_m" not in str(asked.exception).replace("reference_level_m", "").split("--column")[0]


def test_the_height_makes_a_level_of_a_column_that_is_called_so() -> None:
    table, _ = tank(8)
    named = table.rename(columns={"Lvl": "level_cm", "gauge": "reference_level_m"})
    read = echocal.read_observations(named, mount_height=HEIGHT)
    said = echocal.read_observations(table, COLUMNS, mount_height=HEIGHT)
    assert read.mount_height == HEIGHT
    assert read.reading == pytest.approx(said.reading)
    assert read.reference_distance == pytest.approx(said.reference_distance)
    with pytest.raises(echocal.UsageError, match="is for a column that holds a level"):
        echocal.read_observations(table, mount_height=HEIGHT)


@pytest.mark.parametrize("given", [True, False], ids=["height given", "height fitted"])
@pytest.mark.parametrize(("factor", "way"), [(100.0, "'reference_level_cm'"), (0.01, "multiply it by 100,")])
def test_a_level_in_another_unit_than_the_distance_is_refused(given: bool, factor: float, way: str) -> None:
    table, _ = tank(9)
    table["reading_m"] = HEIGHT - 0.01 * table.pop("Lvl")
    table["gauge"] *= factor
    with pytest.raises(echocal.DataError, match=f"column 'gauge'.*{way}"):
        echocal.read_observations(
            table, {"gauge": "reference_level_m"}, mount_height=HEIGHT if given else None
        )


def test_a_height_beside_a_file_of_options_wins_or_is_refused(tmp_path: Path) -> None:
    """A file that a command wrote keeps the height apart from the columns."""
    table, _ = tank(10)
    table.to_csv(tmp_path / "tank.csv", index=False)
    log, out = str(tmp_path / "tank.csv"), str(tmp_path / "out")
    columns = ["--column", "Lvl=level_cm", "--column", "gauge=reference_level_m"]
    done = CliRunner().invoke(app, [log, *columns, "--mount-height", "2.6", "-o", out, "--quiet"])
    assert done.exit_code == 0, done.output
    toml = tmp_path / "out" / "tank-options.toml"
    again = ["diagnose", log, "--options", str(toml), "--mount-height", "2.7", "--save-model"]
    assert CliRunner().invoke(app, [*again, str(tmp_path / "m.json")]).exit_code == 0
    assert kept_height(echocal.Model.load(tmp_path / "m.json")) == 2.7
    toml.write_text(
        toml.read_text()
        .replace("level_cm", "level_cm below 2.6 m")
        .replace('level_m"', 'level_m below 2.6 m"')
    )
    refused = CliRunner().invoke(app, [*again, str(tmp_path / "n.json")])
    assert "is for no level: 'Lvl' has a height of its own, 2.6 m" in str(refused.exception)
