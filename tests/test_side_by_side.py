"""Several rangers in columns beside each other: one is chosen, or each is a table."""

import re
import shlex
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from typer.testing import CliRunner

import echocal
from echocal.cli import app
from echocal.observations.inspection import inspect_log

FAST = echocal.Model("linear", {"clock_error": {"frequency_error": 0.01}})


def two(seed: int = 1) -> pd.DataFrame:
    """The left one has a fast clock, the right one is right; both look at the same wall."""
    rng = np.random.default_rng(seed)
    distance = np.repeat(np.linspace(0.4, 2.6, 12), 8)
    temperature = 15 + 10 * rng.random(len(distance))
    left = FAST.indicate(distance, temperature=temperature) + rng.normal(0, 1e-3, len(distance))
    right = distance + rng.normal(0, 1e-3, len(distance))
    return pd.DataFrame(
        {
            "left (cm)": (100 * left).round(2),
            "right (mm)": (1000 * right).round(1),
            "distance_m": distance,
            "temperature_C": temperature.round(2),
        }
    )


COLUMNS = {"left (cm)": "reading_cm", "right (mm)": "reading_mm"}


def test_each_ranger_is_a_table() -> None:
    found = echocal.diagnose_many(two(), by="left (cm),right (mm)", columns=COLUMNS)
    left, right = (found.tables[name].diagnosis for name in COLUMNS)
    assert any("clock_error" in (one.id, *one.indistinguishable_from) for one in left.causes)
    assert right.verdict == "nothing" or not any(one.in_model for one in right.causes)
    alone = echocal.diagnose(two(), columns={**COLUMNS, "right (mm)": "ignore"})
    assert left.gain.rms_before_m == pytest.approx(alone.gain.rms_before_m)


def test_the_command_takes_both(tmp_path: Path) -> None:
    two().to_csv(tmp_path / "robot.csv", index=False)
    arguments = ["diagnose", str(tmp_path / "robot.csv"), "--by", "left (cm),right (mm)"]
    for column, request in COLUMNS.items():
        arguments += ["--column", f"{column}={request}"]
    done = CliRunner().invoke(app, arguments)
    assert done.exit_code == 0, done.output
    assert "left (cm)" in done.output


def test_two_that_may_be_the_reading_are_told() -> None:
    table = two().rename(columns={"left (cm)": "sonar1 (cm)", "right (mm)": "sonar2 (mm)"})
    with pytest.raises(echocal.DataError) as refused:
        echocal.diagnose(table)
    assert "sonar1" in str(refused.value)
    read = echocal.read_observations(table.assign(echo_us=2e4 * table["distance_m"] / 3.43))
    assert not any("by=" in note for note in read.notes)


@pytest.mark.parametrize(
    ("right", "columns"), [("right (mm)", {"right (mm)": "temperature_C"}), ("right", {})]
)
def test_a_column_that_is_no_ranger_is_refused(right: str, columns: dict[str, str]) -> None:
    table = two().rename(columns={"right (mm)": right})
    with pytest.raises(echocal.UsageError, match=f"say what '{re.escape(right)}' holds"):
        echocal.diagnose_many(table, by=f"left (cm),{right}", columns={"left (cm)": "reading_cm", **columns})


def test_rangers_need_no_meaning_beside_their_units() -> None:
    units = echocal.diagnose_many(two(), by=",".join(COLUMNS))
    said = echocal.diagnose_many(two(), by=",".join(COLUMNS), columns=COLUMNS)
    for name, own in units.tables.items():
        assert own.diagnosis.gain.rms_after_m == said.tables[name].diagnosis.gain.rms_after_m


def test_a_list_of_names_is_as_their_text() -> None:
    text, listed = (
        echocal.diagnose_many(two(), by=by, columns=COLUMNS) for by in (",".join(COLUMNS), list(COLUMNS))
    )
    assert list(listed.tables) == list(text.tables) == list(COLUMNS)
    assert listed.verdict == text.verdict


@pytest.mark.parametrize(
    ("by", "says"),
    [([], "no name of a column"), ([1, 2], "no name of a column"), (["left (cm)", "x"], "'x'")],
)
def test_a_list_that_names_no_columns_is_refused(by: list[str], says: str) -> None:
    with pytest.raises((echocal.UsageError, echocal.DataError)) as refused:
        echocal.diagnose_many(two(), by=by, columns=COLUMNS)
    assert says in str(refused.value)


def test_what_one_command_diagnoses_the_printed_command_corrects(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    two().to_csv("robot.csv", index=False)
    arguments = ["diagnose", "robot.csv", "--by", "left (cm),right (mm)", "--models", "models"]
    for column, request in COLUMNS.items():
        arguments += ["--column", f"{column}={request}"]
    told = CliRunner().invoke(app, arguments).output
    command = next(line for line in told.splitlines() if line.startswith("echocal correct"))
    done = CliRunner().invoke(app, shlex.split(command)[1:])
    assert done.exit_code == 0, done.output
    for file in ("left_cm_", "right_mm_"):
        table = pd.read_csv(next(Path("robot-corrected").glob(f"{file}*.csv")))
        assert np.std(table["corrected_distance_m"] - table["distance_m"]) < 1.5e-3
        assert abs(np.mean(table["corrected_distance_m"] - table["distance_m"])) < 1.5e-3
    again = CliRunner().invoke(app, [*shlex.split(command)[1:-1], "robot.parquet"])
    assert isinstance(again.exception, echocal.UsageError)
    assert "give one table, and a folder" in str(again.exception)


def test_a_second_ranger_is_told_with_the_guess(tmp_path: Path) -> None:
    table = two().rename(columns={"left (cm)": "sonar_left", "right (mm)": "sonar_right"})
    table["sonar_right"] /= 10.0
    table.to_csv(tmp_path / "robot.csv", index=False)
    told = str(CliRunner().invoke(app, [str(tmp_path / "robot.csv"), "-o", str(tmp_path)]).exception)
    assert "'sonar_left' as reading_cm" in told
    assert "and so 'sonar_right': for both, echocal diagnose LOG --by sonar_left,sonar_right" in told


@pytest.mark.parametrize(
    ("words", "told"),
    [
        ([], "each is corrected by its own model: give their folder, --models DIR"),
        (["--models", "models"], "models has no model of column 'rigth'; did you mean 'right'?"),
        (["--models", "absent"], "absent is no folder of models"),
    ],
)
def test_rangers_without_a_model_are_told(
    words: list[str], told: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("models").mkdir()
    for name in ("left", "right"):
        FAST.save(f"models/{name}.json")
    two().rename(columns={"left (cm)": "left", "right (mm)": "right"}).to_csv("robot.csv", index=False)
    done = CliRunner().invoke(app, ["correct", "robot.csv", "-o", "new", "--by", "left,rigth", *words])
    assert done.exit_code != 0
    assert told in str(done.exception)
    assert not Path("new").exists()


NAMES = {"left_cm": 100.0, "s1_mm": 1000.0, "left_us": 2e6 / 343, "left": 100.0}


@pytest.mark.parametrize("name", NAMES)
def test_rangers_beside_a_reference_are_no_other_quantity(name: str, tmp_path: Path) -> None:
    """The values say that they are readings of the distance, whatever they are called."""
    unit, other = name.rpartition("_")[2], name.replace("left", "right").replace("s1", "s2")
    table = two(5)
    table = pd.DataFrame(
        {
            "distance_m": table["distance_m"].round(3),
            name: (NAMES[name] * table["left (cm)"] / 100).round(1),
            other: (NAMES[name] * table["right (mm)"] / 1000).round(1),
            "temperature_C": table["temperature_C"],
        }
    )
    table.to_csv(tmp_path / "robot.csv", index=False)
    found = inspect_log(tmp_path / "robot.csv")
    proposed = {column.name: column.proposal for column in found.columns}
    role = "echo_us" if unit == "us" else f"reading_{unit if unit in ('cm', 'mm') else 'cm'}"
    assert proposed["distance_m"].request == "distance_m"
    assert proposed[name].request == role
    assert proposed[name].guess
    assert f"and so '{other}'" in proposed[name].reason
    assert f"{name},{other}" in proposed[name].reason
    with pytest.raises(echocal.DataError) as refused:
        echocal.diagnose(table)
    assert "sensor indicates 'distance_m'" not in str(refused.value)
    if unit == name:  # no unit says which it is
        return
    each = echocal.diagnose_many(table, by=f"{name},{other}")
    assert [own.diagnosis.rows["used"] for own in each.tables.values()] == [96, 96]


def test_what_does_not_follow_the_reference_is_no_ranger(tmp_path: Path) -> None:
    table = two(6)[["distance_m", "temperature_C"]].round(3)
    rng = np.random.default_rng(6)
    table["wall_cm"], table["width_cm"] = 250.0, rng.uniform(40, 260, len(table)).round(1)
    table.to_csv(tmp_path / "robot.csv", index=False)
    proposed = {
        column.name: column.proposal.request for column in inspect_log(tmp_path / "robot.csv").columns
    }
    assert not {proposed["wall_cm"], proposed["width_cm"]} & {"reading_cm"}
