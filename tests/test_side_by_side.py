"""Several rangers in columns beside each other: one is chosen, or each is a table."""

import shlex
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from typer.testing import CliRunner

import echocal
from echocal.cli import app

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
    ("columns", "says"),
    [
        ({"left (cm)": "reading_cm", "right (mm)": "temperature_C"}, "say what 'right \\(mm\\)' holds"),
        ({"left (cm)": "reading_cm"}, "say what 'right \\(mm\\)' holds"),
    ],
)
def test_a_column_that_is_no_ranger_is_refused(columns: dict[str, str], says: str) -> None:
    with pytest.raises(echocal.UsageError, match=says):
        echocal.diagnose_many(two(), by="left (cm),right (mm)", columns=columns)


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
