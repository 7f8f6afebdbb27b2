import subprocess
import sys
import warnings
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import polars as pl
import pytest

import echocal
from echocal.quantities import QUANTITIES

TABLE = {"echo_us": [11660.0, 11700.0, 11500.0], "temperature_C": [20.0, 18.5, 25.0]}


@pytest.mark.parametrize(
    ("name", "value", "field", "expected"),
    [
        ("echo_us", 11660.0, "echo_time", 0.01166),
        ("echo_ms", 11.66, "echo_time", 0.01166),
        ("echo_s", 0.01166, "echo_time", 0.01166),
        ("transit_us", 5830.0, "echo_time", 0.01166),
        ("distance_m", 2.0, "reference_distance", 2.0),
        ("distance_cm", 73.3, "reference_distance", 0.733),
        ("distance_mm", 1234.0, "reference_distance", 1.234),
        ("distance_inch", 10.0, "reference_distance", 0.254),
        ("distance_ft", 10.0, "reference_distance", 3.048),
        ("reading_ft", 10.0, "reading", 3.048),
        ("two_way_distance_cm", 73.3, "reference_distance", 0.3665),
        ("temperature_C", 21.5, "temperature", 21.5),
        ("temperature_K", 273.15, "temperature", 0.0),
        ("temperature_F", 68.0, "temperature", 20.0),
        ("humidity_percent", 55.0, "relative_humidity", 0.55),
        ("relative_humidity", 0.55, "relative_humidity", 0.55),
        ("pressure_Pa", 101325.0, "pressure", 101325.0),
        ("pressure_hPa", 1013.0, "pressure", 101300.0),
        ("pressure_kPa", 101.3, "pressure", 101300.0),
        ("co2_ppm", 420.0, "co2_mole_fraction", 420e-6),
        ("supply_V", 4.9, "supply_voltage", 4.9),
        ("angle_deg", 90.0, "angle", np.pi / 2),
        ("wind_m_s", 3.0, "wind_speed", 3.0),
        ("wind_km_h", 36.0, "wind_speed", 10.0),
        ("radiation_W_m2", 700.0, "radiation", 700.0),
        ("amplitude", 0.4, "amplitude", 0.4),
    ],
)
def test_units(name: str, value: float, field: str, expected: float) -> None:
    base: dict[str, list[float]] = {} if field == "echo_time" else {"echo_us": [11660.0]}
    data = echocal.read_observations({**base, name: [value]})
    values = data.conditions.get(field, getattr(data, field, None))
    assert values is not None
    assert values[0] == pytest.approx(expected, rel=1e-15, abs=1e-15)


@pytest.mark.parametrize(
    "request_",
    ["reading_m", "distance reading in m", "distance reading in metres", "reading [m]", "Reading in m"],
)
def test_requests_by_name_and_by_phrase(request_: str) -> None:
    data = echocal.read_observations({"SR_U": [2.0]}, {"SR_U": request_}, reading_speed="343")
    assert data.reading is not None
    assert data.reading[0] == 2.0
    assert data.echo_time[0] == pytest.approx(4.0 / 343.0, rel=1e-15)
    assert data.source_names["reading"] == "SR_U"


def test_reading_speed_may_be_a_law_or_an_expression() -> None:
    table = {"reading_m": [2.0], "temperature_C": [20.0]}
    fixed, linear, expression = (
        echocal.read_observations(table, reading_speed=speed).echo_time[0]
        for speed in ("343.4", None, "331.4+0.6*T")
    )
    assert fixed == pytest.approx(linear, rel=1e-15)
    assert expression == linear


@pytest.mark.parametrize("form", ["pandas", "polars", "lazy", "arrow", "xarray", "mapping"])
def test_tables_of_other_libraries(form: str) -> None:
    frame = pd.DataFrame(TABLE)
    source: Any = {
        "pandas": lambda: frame,
        "polars": lambda: pl.DataFrame(TABLE),
        "lazy": lambda: pl.LazyFrame(TABLE),
        "arrow": lambda: pl.DataFrame(TABLE).to_arrow(),
        "xarray": lambda: frame.to_xarray(),
        "mapping": lambda: TABLE,
    }[form]()
    data = echocal.read_observations(source)
    np.testing.assert_array_equal(data.conditions["temperature"], TABLE["temperature_C"])
    assert data.usable.all()


@pytest.mark.parametrize("ending", [".csv", ".csv.gz", ".tsv", "_semicolon.csv", ".parquet"])
def test_files(ending: str, tmp_path: Path) -> None:
    path = tmp_path / f"log{ending}"
    frame = pd.DataFrame(TABLE)
    if ending == ".parquet":
        frame.to_parquet(path)
    else:
        frame.to_csv(path, index=False, sep={".tsv": "\t", "_semicolon.csv": ";"}.get(ending, ","))
    data = echocal.read_observations(path)
    np.testing.assert_allclose(data.echo_time, np.array(TABLE["echo_us"]) * 1e-6, rtol=1e-15)


def test_rows_keep_their_number_and_order() -> None:
    table = {
        "echo_us": [11660.0, None, 11500.0, 0.0, 11400.0],
        "humidity_percent": [40.0, 41.0, 143.0, 42.0, 43.0],
        "remark": ["", "door open", "", "", ""],
        "fan_mA": [1.0, 2.0, 3.0, 4.0, 5.0],
    }
    with pytest.warns(echocal.DataWarning, match="3 of 5 rows cannot be used"):
        data = echocal.read_observations(table)
    expected = ["", "echo_us missing", "humidity_percent out of range", "echo_us out of range", ""]
    assert data.unusable.tolist() == expected
    assert len(data) == 5
    assert data.echo_time[4] == pytest.approx(0.0114)
    assert list(data.extra) == ["fan_mA"]
    assert "humidity_percent has 1 value above 100, first at row 3: 143.0" in data.notes


def test_error_codes_by_column_and_for_all() -> None:
    table = {"reading_mm": [1171.0, 9999.0, -9999.0, 1170.0], "ticks": [9999.0, 2.0, -9999.0, 4.0]}
    with pytest.warns(echocal.DataWarning):
        data = echocal.read_observations(
            table, missing={"reading_mm": 9999, "": [-9999]}, reading_speed="343"
        )
    assert data.unusable.tolist() == ["", "reading_mm missing", "reading_mm missing", ""]
    np.testing.assert_array_equal(data.extra["ticks"], [9999.0, 2.0, np.nan, 4.0])


def test_an_unnamed_error_code_is_pointed_out() -> None:
    data = echocal.read_observations({"reading_mm": [1171.0, 9999.0, 1170.0]}, reading_speed="343")
    assert (
        "reading_mm holds 9999 in 1 row; if it is an error code: missing={'reading_mm': 9999}" in data.notes
    )


@pytest.mark.parametrize(
    ("texts", "zone", "elapsed"),
    [
        (["2024-05-31T10:00:00Z", "2024-05-31T10:10:00Z"], "UTC", 600.0),
        (["2024-05-31 10:00:00", "2024-05-31 10:10:00.5"], "UTC", 600.5),
        (["2020/02/23 20:37:17", "2020/02/23 20:42:16"], "UTC", 299.0),
        (["2024-03-31T01:30:00", "2024-03-31T03:30:00"], "Europe/Copenhagen", 3600.0),
        (["2024-05-31T10:00:00+02:00", "2024-05-31T10:00:00+00:00"], "UTC", 7200.0),
    ],
)
def test_times(texts: list[str], zone: str, elapsed: float) -> None:
    data = echocal.read_observations({"echo_us": [11660.0, 11660.0], "time": texts}, time_zone=zone)
    assert data.conditions["elapsed_time"].tolist() == [0.0, elapsed]
    assert data.time is not None


def test_seconds_count_from_the_first_row() -> None:
    data = echocal.read_observations({"echo_us": [11660.0, 11660.0], "time_s": [1.7e9, 1.7e9 + 2.5]})
    assert data.conditions["elapsed_time"].tolist() == [0.0, 2.5]


def test_labels() -> None:
    table = {
        "echo_us": [1e4] * 4,
        "stand": ["b", "b", "a", None],
        "order": ["Obs. 1", "Obs. 2", "Obs. 10", "Obs. 1"],
    }
    data = echocal.read_observations(table)
    assert data.labels["stand"].tolist() == [0, 0, 1, -1]
    assert data.labels["order"].tolist() == [1, 2, 10, 1]


def test_column_file(tmp_path: Path) -> None:
    columns = tmp_path / "columns.toml"
    columns.write_text('SR_U = "reading_m"\n"Asp temp" = "temperature_C"\nbattery = "ignore"\n')
    table = {"SR_U": [2.0], "Asp temp": [20.0], "battery": [4.6]}
    data = echocal.read_observations(table, columns)
    assert list(data.conditions) == ["temperature"]
    assert not data.extra


def test_a_clean_table_warns_of_nothing() -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        echocal.read_observations(TABLE)


def test_require_names_what_is_missing() -> None:
    data = echocal.read_observations({"echo_us": [11660.0]})
    with pytest.raises(
        echocal.DataError, match="diagnosis needs at least 5 usable rows; the table has 1 of 1 row"
    ):
        data.require("diagnosis", rows=5)
    with pytest.raises(echocal.DataError, match="needs a column for temperature; accepted: temperature_C, "):
        data.require("diagnosis", conditions=["temperature"])
    with pytest.raises(echocal.DataError, match=r"reference distance; accepted: distance_m, .*columns="):
        data.require("verification", reference_distance=True)


EXAMPLES = Path(__file__).parents[1] / "examples"


def test_shipped_examples_read_without_a_word() -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        study = echocal.read_observations(EXAMPLES / "study_table2.csv", reading_speed="343")
        warehouse = echocal.read_observations(EXAMPLES / "warehouse.csv")
    assert (len(study), len(warehouse)) == (27, 480)
    assert study.notes == warehouse.notes == ()
    recorded = [name for name in warehouse.conditions if QUANTITIES[name].derived_from is None]
    assert recorded == ["temperature", "relative_humidity", "pressure", "elapsed_time"]


def test_the_made_example_is_what_its_script_makes() -> None:
    script = EXAMPLES / "make_warehouse.py"
    made = subprocess.run([sys.executable, str(script)], capture_output=True, text=True, check=True).stdout
    assert made == (EXAMPLES / "warehouse.csv").read_text()
