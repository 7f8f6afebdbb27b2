"""Tables and requests that a user gets wrong, and the one line that says so."""

import re
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest

import echocal
from echocal import DataError, UsageError

ECHO = {"echo_us": [11660.0, 11700.0, 11500.0]}

TABLES: dict[str, tuple[dict[str, Any], dict[str, Any], type[Exception], str]] = {
    "complex numbers": (
        {"echo_us": [11660.0 + 1j, 11700.0]},
        {},
        DataError,
        "column 'echo_us' holds complex numbers (complex128); give the real part, or its magnitude",
    ),
    "true and false": (
        {**ECHO, "temperature_C": [True, False, True]},
        {},
        DataError,
        "column 'temperature_C' holds true and false, and a temperature is a number; "
        "if it is something else: columns={'temperature_C': 'extra'}",
    ),
    "no columns": ({}, {}, DataError, "the table has no columns"),
    "lists in a column": (
        {"echo_us": [[1.0], [1.0, 2.0]]},
        {},
        DataError,
        "column 'echo_us' holds lists of different lengths; give one value for each row",
    ),
    "no echo column": (
        {"SR_U": [2.0], "battery": [4.6]},
        {},
        DataError,
        "no column holds an echo time or a distance reading; accepted: echo_us, echo_ms, echo_s, reading_m, "
        "reading_cm, reading_mm, reading_inch, reading_ft. The table has: SR_U, battery. "
        "Say which it is: columns={",
    ),
    "misspelled echo column": (
        {"time": ["2026-01-01"], "ehco_us": [5800.0]},
        {},
        DataError,
        "Did you mean: columns={'ehco_us': 'echo_us'}",
    ),
    "no column that could be an echo": (
        {"temperature_C": [20.0], "distance_m": [1.0]},
        {},
        DataError,
        "The table has: temperature_C, distance_m. Record one of them",
    ),
    "unknown unit": (
        {**ECHO, "temperature_R": [500.0] * 3},
        {},
        DataError,
        "column 'temperature_R' has unknown unit 'R'; accepted: temperature_C, temperature_K, "
        "temperature_F. Rename it, or say what it is: columns={",
    ),
    "no unit": (
        {**ECHO, "humidity": [50.0] * 3},
        {},
        DataError,
        "column 'humidity' has no unit; accepted: humidity_percent",
    ),
    "humidity 143 % throughout": (
        {**ECHO, "humidity_percent": [143.0, 144.0, 150.0]},
        {},
        DataError,
        "column 'humidity_percent' has a median of 144, outside 0 .. 100; values in another unit, or in "
        "tenths, must be converted before; without it: columns={'humidity_percent': 'ignore'}",
    ),
    "an error code throughout": (
        {**ECHO, "humidity_percent": [143.0, 143.0, 150.0]},
        {},
        DataError,
        "column 'humidity_percent' has a median of 143, outside 0 .. 100; an error code? "
        "missing={'humidity_percent': 143}",
    ),
    "humidity as a fraction": (
        {**ECHO, "humidity_percent": [0.43, 0.44, 0.5]},
        {},
        DataError,
        "column 'humidity_percent' has a median of 0.44: as humidity_percent 0.0044, as relative_humidity "
        "0.44. "
        "Say which it is: columns={'humidity_percent': 'relative_humidity'}",
    ),
    "Fahrenheit by the look of it": (
        {**ECHO, "temperature_C": [66.0, 68.0, 70.0]},
        {},
        DataError,
        "column 'temperature_C' has a median of 68: as temperature_C 68 degC, as temperature_F 20 degC. "
        "Say which it is: columns={'temperature_C': 'temperature_F'} (or rename it), "
        "or if it is right as it stands: trust=['temperature_C']",
    ),
    "Kelvin by the look of it": (
        {**ECHO, "temperature_C": [295.0] * 3},
        {},
        DataError,
        "as temperature_C 295 degC, as temperature_K 21.85 degC",
    ),
    "pressure in hPa by the look of it": (
        {**ECHO, "pressure_Pa": [1013.0] * 3},
        {},
        DataError,
        "as pressure_Pa 1013 Pa, as pressure_hPa 1.013e+05 Pa",
    ),
    "echo in seconds by the look of it": (
        {"echo_us": [0.0117] * 3},
        {},
        DataError,
        "as echo_us 1.17e-08 s, as echo_s 0.0117 s",
    ),
    "distance in cm by the look of it": (
        {**ECHO, "distance_m": [200.0] * 3},
        {},
        DataError,
        "as distance_m 200 m, as distance_cm 2 m",
    ),
    "text in a number": (
        {**ECHO, "temperature_C": ["20.0", "open", "20.5"]},
        {},
        DataError,
        "column 'temperature_C' has text in 1 of 3 rows, first at row 2: 'open'; "
        "if it means \"no value\": missing=['open']",
    ),
    "decimal comma": (
        {**ECHO, "temperature_C": ["20,0", "20,1", "20,5"]},
        {},
        DataError,
        "has text in 3 of 3 rows, first at row 1: '20,0'; a decimal comma? pass decimal=','",
    ),
    "all NaN": (
        {**ECHO, "humidity_percent": [np.nan] * 3},
        {},
        DataError,
        "column 'humidity_percent' has no value in any of 3 rows; "
        "if it is not needed: columns={'humidity_percent': 'ignore'}",
    ),
    "no usable row": (
        {"echo_us": [0.0, 0.0, 0.0]},
        {},
        DataError,
        "no row can be used: 3 echo_us out of range. echo_us has 3 values at or below 0, first at row 1: 0.0",
    ),
    "mixed shapes": (
        {"echo_us": [11660.0, 11700.0], "temperature_C": [20.0]},
        {},
        DataError,
        "columns must be one-dimensional and of equal length; got echo_us (2,), temperature_C (1,)",
    ),
    "a matrix": ({"echo_us": np.ones((2, 2))}, {}, DataError, "got echo_us (2, 2)"),
    "no rows": ({"echo_us": []}, {}, DataError, "the table has a header (echo_us) and no rows"),
    "mapping of a column that is not there": (
        {"SR_U": [2.0], "Asp_temp_L": [20.0]},
        {"columns": {"SR_L": "reading_m"}},
        UsageError,
        "no column 'SR_L'; did you mean 'SR_U'? The table has: SR_U, Asp_temp_L",
    ),
    "mapping in the wrong case": (
        {"SR_U": [2.0]},
        {"columns": {"sr_u": "reading_m"}},
        UsageError,
        "no column 'sr_u'; did you mean 'SR_U'?",
    ),
    "mapping onto an unknown name": (
        {"SR_U": [2.0]},
        {"columns": {"SR_U": "readng_m"}},
        UsageError,
        "'SR_U' = 'readng_m' names no quantity; did you mean 'reading_m'? Accepted: echo_us, echo_ms,",
    ),
    "mapping onto an unknown unit": (
        {"SR_U": [2.0]},
        {"columns": {"SR_U": "distance reading in furlongs"}},
        UsageError,
        "'SR_U' = 'distance reading in furlongs' has no known unit; accepted: reading_m, reading_cm, ",
    ),
    "mapping without a unit": (
        {"SR_U": [2.0]},
        {"columns": {"SR_U": "temperature"}},
        UsageError,
        "'SR_U' = 'temperature' has no known unit; accepted: temperature_C, ",
    ),
    "two columns for one quantity": (
        {"echo_us": [11660.0], "echo_ms": [11.66]},
        {},
        DataError,
        "columns 'echo_us' and 'echo_ms' both hold echo time; say which not to use: "
        "columns={'echo_ms': 'ignore'}",
    ),
    "echo and reading disagree": (
        {**ECHO, "reading_m": [4.0, 4.0, 4.0], "temperature_C": [20.0] * 3},
        {},
        DataError,
        "'echo_us' and 'reading_m' disagree in 3 of 3 rows: the reading is 1.998 times "
        "speed (linear) x echo time / 2 (median)",
    ),
    "a law that needs a temperature": (
        {"reading_m": [2.0]},
        {},
        DataError,
        "'linear' needs a temperature and the table has none; map one",
    ),
    "no law": ({"reading_m": [2.0]}, {"reading_speed": "fast"}, echocal.ModelError, "fast"),
    "numbers as time": (
        {**ECHO, "time": [0.0, 1.0, 2.0]},
        {},
        DataError,
        "column 'time' holds numbers, not ISO 8601 times; rename it to its unit: time_s,",
    ),
    "a time that is not ISO 8601": (
        {**ECHO, "time": ["2024-05-31", "31/05/2024", ""]},
        {},
        DataError,
        "column 'time' has 1 of 3 rows that are not ISO 8601 (2024-05-31T13:45:00), "
        "first at row 2: '31/05/2024'",
    ),
    "times with and without offset": (
        {**ECHO, "time": ["2024-05-31T10:00:00Z", "2024-05-31T10:00:00", ""]},
        {},
        DataError,
        "column 'time' has times with and without an offset, first without at row 2",
    ),
    "a local time that occurs twice": (
        {**ECHO, "time": ["2024-10-27T01:00:00", "2024-10-27T02:30:00", "2024-10-27T04:00:00"]},
        {"time_zone": "Europe/Copenhagen"},
        DataError,
        "column 'time' has 1 local times that a clock change skips or repeats, first at row 2",
    ),
    "an unknown time zone": (
        {**ECHO, "time": ["2024-05-31"] * 3},
        {"time_zone": "Mars/Olympus"},
        UsageError,
        "unknown time zone 'Mars/Olympus'; IANA names are like UTC or Europe/Copenhagen, offsets like +02:00",
    ),
    "an order that is no position": (
        {**ECHO, "order": ["first", "2", "3"]},
        {},
        DataError,
        "column 'order' must hold the position in a burst, one whole number a row; row 1 has 'first'",
    ),
    "an error code for a column that is not there": (
        ECHO,
        {"missing": {"echo": [-9999]}},
        UsageError,
        "error codes for column 'echo', which is not there; did you mean 'echo_us'? It has echo_us",
    ),
    "trust in a column that is not there": (ECHO, {"trust": ["echo"]}, UsageError, "no column 'echo'"),
}


OPTIONS: dict[str, tuple[dict[str, Any], str]] = {
    "lines that are no number": ({"skip_lines": 1.5}, "skip_lines is 1.5; give the number of lines"),
    "an encoding that is no text": ({"encoding": "zlib"}, "unknown encoding 'zlib'"),
    "an encoding with a NUL": ({"encoding": "a\0"}, "unknown encoding"),
    "trust in a number": ({"trust": [3]}, "trust lists names of columns"),
}


@pytest.mark.parametrize("case", OPTIONS)
def test_options_that_make_no_sense(case: str, tmp_path: Path) -> None:
    options, message = OPTIONS[case]
    (tmp_path / "log.csv").write_text("echo_us\n11660\n")
    with pytest.raises(UsageError, match=re.escape(message)):
        echocal.read_observations(tmp_path / "log.csv", **options)


@pytest.mark.parametrize("case", TABLES)
def test_tables(case: str) -> None:
    table, options, error, message = TABLES[case]
    with pytest.raises(error, match=re.escape(message)):
        echocal.read_observations(table, **options)


def test_humidity_143_in_one_row() -> None:
    humidity = np.full(1000, 50.0)
    humidity[811:868] = 143.0
    with pytest.warns(
        echocal.DataWarning, match="has 57 values above 100, first at row 812: 143.0"
    ) as caught:
        echocal.read_observations({"echo_us": np.full(1000, 11660.0), "humidity_percent": humidity})
    assert "57 of 1000 rows cannot be used: 57 humidity_percent out of range" in str(caught[0].message)


def test_a_trusted_column_is_taken_at_its_word() -> None:
    table = {**ECHO, "temperature_C": [66.0, 68.0, 70.0]}
    data = echocal.read_observations(table, trust=["temperature_C"])
    assert data.conditions["temperature"].tolist() == [66.0, 68.0, 70.0]


def test_a_dry_table_is_no_fraction() -> None:
    assert echocal.read_observations({**ECHO, "humidity_percent": [0.0, 0.0, 0.0]}).usable.all()


def test_single_rows_where_echo_and_reading_disagree() -> None:
    table = {**ECHO, "reading_m": [2.001, 4.0, 1.974], "temperature_C": [20.0] * 3}
    with pytest.warns(echocal.DataWarning, match="1 echo_us and reading_m disagree"):
        data = echocal.read_observations(table)
    assert data.unusable.tolist() == ["", "echo_us and reading_m disagree", ""]


def test_what_is_no_table() -> None:
    with pytest.raises(UsageError, match="expected a path, a table or a mapping of columns, got int"):
        echocal.read_observations(3)


def test_duplicate_columns_of_a_frame() -> None:
    frame = pd.DataFrame([[1.0, 2.0]], columns=["echo_us", "echo_us"])
    with pytest.raises(DataError, match="the table has more than one column 'echo_us'"):
        echocal.read_observations(frame)
