"""Odd objects in a table, distances in other units, names that no file can have: one line each, no crash."""

import re
import sys
from decimal import Decimal
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pyarrow as pa
import pytest
from numpy.typing import NDArray

import echocal
from echocal import DataError
from echocal.cli import main
from echocal.correct import correct_files

ODD: dict[str, tuple[Any, str]] = {
    "a list": ([1.0, 2.0], "a value of type list"),
    "a dict": ({"a": 1}, "a value of type dict"),
    "a set": ({1}, "a value of type set"),
    "a tuple": ((1, 2), "a value of type tuple"),
    "an array": (np.array([1.0, 2.0]), "a value of type ndarray"),
    "a series": (pd.Series([1.0]), "a value of type Series"),
    "bytes": (b"1.0", "a value of type bytes"),
    "a complex number": (1 + 2j, "a value of type complex"),
    "an interval": (pd.Interval(0, 1), "a value of type Interval"),
    "an object": (object(), "a value of type object"),
    "a signaling NaN": (Decimal("sNaN"), "a signaling NaN"),
}
HASHED = {"a tuple", "bytes", "a complex number", "an interval", "an object"}  # may number a stand


@pytest.mark.parametrize("kind", ODD)
@pytest.mark.parametrize(
    "column", ["reading_m", "temperature_C", "time", "time_s", "stand", "group", "order"]
)
def test_odd_objects_are_named_with_column_and_row(column: str, kind: str) -> None:
    odd, told = ODD[kind]
    usual = {"time": "2024-01-01", "order": 1}.get(column, 2.0)
    table = pd.DataFrame({"reading_m": [2.0] * 4, "x": [1.0] * 4})
    table[column] = pd.Series([usual, None, odd, usual], dtype=object)
    table["x"] = pd.Series([1.0, 2.0, odd, 3.0], dtype=object)  # and one that holds no numbers
    if column in {"stand", "group"} and kind in HASHED:
        data = echocal.read_observations(table, reading_speed=343)
        assert data.labels[column].tolist() == [0, -1, 1, 0]
        return
    message = f"column '{column}' holds {told} at row 3; give one number or text a row"
    with pytest.raises(DataError, match=re.escape(message)):
        echocal.read_observations(table, reading_speed=343)


@pytest.mark.parametrize("kind", ["extra", "mapped"])
def test_columns_of_arrow_that_hold_maps(kind: str) -> None:
    maps = pa.array([[("a", 1)], None], pa.map_(pa.string(), pa.int64()))
    table = pa.table({"reading_m": [2.0, 2.1], "m": maps})
    if kind == "extra":
        assert echocal.read_observations(table, reading_speed=343).extra == {}
        return
    with pytest.raises(DataError, match="column 'm' holds a value of type list at row 1"):
        echocal.read_observations(table, {"m": "temperature_C"}, reading_speed=343)


def test_numbers_that_no_float_holds() -> None:
    table = {"echo_us": [11660.0] * 3, "temperature_C": [20.0, 10**400, -(10**5000)]}
    with pytest.warns(echocal.DataWarning, match="temperature_C has 1 value above 100, first at row 2: inf"):
        assert echocal.read_observations(table).usable.tolist() == [True, False, False]
    with pytest.raises(DataError, match=r"one whole number a row; row 1 has '9{60}\.\.\.'"):
        echocal.read_observations({"echo_us": [11660.0], "order": ["9" * 5000]})


def test_half_a_character_is_no_crash() -> None:
    table = {"echo_us": ["11660", "\ud800"], "\ud800": ["a", "\ud800"]}
    with pytest.raises(DataError, match=re.escape("first at row 2: '\\ud800'")):
        echocal.read_observations(table)


def test_years_that_would_wrap_around() -> None:
    times = ["2024-01-01", "9999-12-31", "0001-01-01", "2024-01-02T00:00:00.123456789"]
    with pytest.warns(
        echocal.DataWarning, match="no time of the years 1678 to 2261 in 2 rows, first at row 2: 9999-12-31"
    ):
        data = echocal.read_observations({"echo_us": [11660.0] * 4, "time": times})
    assert data.unusable.tolist() == ["", "time out of range", "time out of range", ""]
    assert data.time is not None
    assert data.time[3] == np.datetime64("2024-01-02T00:00:00.123456789")
    with pytest.raises(DataError, match="rows that are not ISO 8601"):
        echocal.read_observations({"echo_us": [11660.0], "time": ["now"]})


@pytest.mark.parametrize("name", ["a" * 300, "a\0b", "a\ud800b"])
def test_what_cannot_be_the_name_of_a_file(name: str, tmp_path: Path) -> None:
    told = r"File name too long|cannot be the name of a file"
    for read in (echocal.read_observations, echocal.diagnose):
        with pytest.raises(DataError, match=told):
            read(name)
    with pytest.raises(DataError, match=told):
        correct_files(name, tmp_path / "out.csv", echocal.Model("linear"))
    with pytest.raises(echocal.ModelError, match=told):
        echocal.Model.load(name)


def wall(random: np.random.Generator, count: int = 60) -> dict[str, Any]:
    return {
        "echo_us": 11660.0 + random.normal(0.0, 5.0, count),
        "temperature_C": np.linspace(5.0, 30.0, count),
        "distance_m": np.linspace(1.0, 2.0, count),
    }


@pytest.mark.parametrize("reading", [{}, {"reading_m": np.full(60, 2.0)}])
@pytest.mark.parametrize("distance", [np.full(60, 2000.0), np.linspace(300.0, 4000.0, 60)])
def test_millimeters_for_meters_are_told_and_no_crash(
    distance: NDArray[np.float64], reading: dict[str, Any], random: np.random.Generator
) -> None:
    table = {**wall(random), **reading, "distance_m": distance}
    with pytest.raises(DataError, match=r"'distance_m' has a median of .* as distance_mm .* Say which it is"):
        echocal.diagnose(table, reading_speed="linear")


def test_distances_without_end_are_told_and_no_crash(random: np.random.Generator) -> None:
    with pytest.raises(DataError, match="60 distance_m out of range"):
        echocal.diagnose({**wall(random), "distance_m": np.full(60, np.inf)})


@pytest.mark.parametrize("count", [30, 60])
def test_distances_that_a_constant_distance_leaves_aside(count: int, random: np.random.Generator) -> None:
    diagnosis = echocal.diagnose(wall(random, count), constant_distance=True)
    assert any("(1 to 2 m) are not used" in note for note in diagnosis.notes)


BOUND = ("--maximum-permissible-error-mm", "5")
LONG = "a" * 300
COMMANDS = {
    ("correct", LONG, "-o", "out.csv"): 3,
    ("diagnose", LONG): 3,
    ("calibrate", LONG, "--fit", "zero_error.offset"): 3,
    ("verify", LONG, *BOUND): 3,
    ("sweep", "--temperature", "20", "--model", LONG): 2,
    ("diagnose", "log.csv", "--base", f"{LONG}.json"): 2,
    ("firmware", LONG, "-o", "made"): 2,
}


@pytest.mark.parametrize("command", COMMANDS, ids=lambda command: command[0])
def test_a_name_that_is_too_long_on_the_command_line(
    command: tuple[str, ...], capsys: Any, monkeypatch: Any, tmp_path: Path
) -> None:
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(sys, "argv", ["echocal", *command])
    with pytest.raises(SystemExit) as ended:
        main()
    told = capsys.readouterr().err
    assert (ended.value.code, told.count("\n")) == (COMMANDS[command], 1)
    assert "File name too long" in told
    assert not list(tmp_path.iterdir())
