"""Tables as people have them: with times in the index, newest row first, in files that are no text."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest
import xarray as xr

import echocal
from echocal import DataError, Model, UsageError
from echocal.correct import correct_files, correct_table

TIMES = pd.date_range("2024-01-01", periods=40, freq="10min")
READING = 2.0 + 1e-3 * np.sin(np.arange(40.0) ** 2)
TABLE = pd.DataFrame({"reading_m": READING, "temperature_C": np.linspace(0.0, 30.0, 40)})

WITH_TIMES: dict[str, Callable[[], Any]] = {
    "a column": lambda: TABLE.assign(time=TIMES),
    "a named index": lambda: TABLE.set_index(TIMES.rename("time")),
    "an index of times": lambda: TABLE.set_index(TIMES),
    "an index and a column": lambda: TABLE.assign(time=TIMES).set_index("time", drop=False),
    "a coordinate": lambda: TABLE.set_index(TIMES.rename("time")).to_xarray(),
    "a coordinate beside the dimension": lambda: xr.Dataset(
        {name: ("row", TABLE[name]) for name in TABLE}, coords={"time": ("row", TIMES)}
    ),
}


@pytest.mark.parametrize("where", WITH_TIMES)
def test_times_are_read_wherever_they_stand(where: str) -> None:
    data = echocal.read_observations(WITH_TIMES[where](), reading_speed=343)
    assert data.time is not None
    assert data.time[-1] == TIMES[-1].to_datetime64()
    assert data.conditions["elapsed_time"].tolist() == (np.arange(40.0) * 600.0).tolist()
    assert list(data.extra) == []


def test_an_index_of_times_is_mapped_and_corrected(tmp_path: Path) -> None:
    table = TABLE.set_index(TIMES.rename("logged"))
    corrected = correct_table(table, Model("linear"), {"logged": "time"})
    pd.testing.assert_frame_equal(corrected.table[list(TABLE.columns)], table)
    table.to_parquet(tmp_path / "in.parquet")
    for out in ("out.parquet", "out.csv"):
        correct_files(tmp_path / "in.parquet", tmp_path / out, Model("linear"), reading_speed="linear")
    written = pd.read_parquet(tmp_path / "out.parquet")
    pd.testing.assert_frame_equal(written[list(TABLE.columns)], pd.read_parquet(tmp_path / "in.parquet"))
    assert pd.read_csv(tmp_path / "out.csv")["logged"].tolist() == TIMES.astype(str).tolist()


def test_repeated_indices_repeat_no_row(tmp_path: Path) -> None:
    TABLE.set_index(pd.Index([7] * 40, name="sensor")).to_parquet(tmp_path / "in.parquet")
    correct_files(tmp_path / "in.parquet", tmp_path / "out.csv", Model("linear"), reading_speed="linear")
    assert pd.read_csv(tmp_path / "out.csv")["sensor"].tolist() == [7] * 40


def test_several_dimensions_are_rows() -> None:
    square = xr.Dataset({name: (("a", "b"), TABLE[name].to_numpy().reshape(8, 5)) for name in TABLE})
    data = echocal.read_observations(square, reading_speed=343)
    assert data.reading is not None
    assert data.reading.tolist() == READING.tolist()
    with pytest.raises(UsageError, match="DataArray is no table: cannot convert an unnamed DataArray"):
        echocal.read_observations(square["reading_m"].rename(None))


@pytest.mark.parametrize("time", [{"time": TIMES[::-1]}, {"time_s": 1e9 - np.arange(40.0)}])
def test_the_newest_row_may_come_first(time: dict[str, Any]) -> None:
    table = TABLE.assign(distance_m=2.0, **time)
    data = echocal.read_observations(table, reading_speed=343)
    assert data.conditions["elapsed_time"].min() == 0.0
    assert any("falls in 39 of 39 rows, as where the newest row comes first" in note for note in data.notes)
    verdict = echocal.diagnose(table, base=343, reading_speed=343).verdict
    assert verdict == echocal.diagnose(table[::-1], base=343, reading_speed=343).verdict


FILES = {
    "JSON that is none": (
        b'{"reading_m": {"0": 2.0}\n',
        r"is JSON that cannot be read \(.*\); write one record a line",
    ),
    "Feather": (b"ARROW1\0\0", r"is an Arrow \(Feather\) file; save it as Parquet"),
    "HDF5": (b"\x89HDF\r\n", "is an HDF5 or NetCDF file; read it with xarray"),
    "NetCDF": (b"CDF\x01", "is a NetCDF file; read it with xarray"),
    "SQLite": (b"SQLite format 3\0", "is an SQLite database; save the table as CSV"),
    "spreadsheet": (b"PK\x03\x04", "is a zip archive or a spreadsheet; save the table as CSV"),
}


@pytest.mark.parametrize("kind", FILES)
def test_files_of_another_kind_are_named(kind: str, tmp_path: Path) -> None:
    content, message = FILES[kind]
    (tmp_path / "table").write_bytes(content)
    with pytest.raises(DataError, match=message):
        echocal.read_observations(tmp_path / "table")
