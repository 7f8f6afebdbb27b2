"""Tables as loggers wrote them."""

from pathlib import Path

import numpy as np
import pytest

import echocal

ROOF = {
    "SR_U": "distance reading in m",
    "Asp_temp_L": "temperature_C",
    "Humidity_L": "humidity_percent",
    "Pressure_L": "pressure_hPa",
    "TIMESTAMP": "time",
    "WindSpeed_S_L": "wind_m_s",
}


def test_roof(shared: Path) -> None:
    path = shared / "data" / "roof-sr50" / "roof_fixed_target_tidy.csv"
    with pytest.warns(echocal.DataWarning, match="1 of 11163 rows cannot be used: 1 SR_U missing"):
        data = echocal.read_observations(path, ROOF, reading_speed="331.4")
    assert len(data) == 11163
    assert data.echo_time[0] == pytest.approx(2 * 1.881 / 331.4, rel=1e-15)
    assert data.unusable[11104] == "SR_U missing"
    assert data.conditions["elapsed_time"][:3].tolist() == [0.0, 600.0, 1200.0]
    assert data.time is not None
    assert data.time[0] == np.datetime64("2022-05-16T12:30")
    assert {"Roll", "Pitch", "LoggerTemp", "Humidity_U"} <= set(data.extra)


def test_bare_rock_the_loggers_own_line_is_found(shared: Path) -> None:
    path = shared / "data" / "weather-maxbotix" / "WS3-Orloc.csv"
    codes = {"Distance [mm]": [-500, 9999], "": [-9999]}
    with pytest.warns(echocal.DataWarning):
        data = echocal.read_observations(path, missing=codes, reading_speed=343)
    assert len(data) == 5130
    assert data.source_names["reading"] == "Distance [mm]"
    assert data.time is not None


def test_bare_rock(shared: Path) -> None:
    path = shared / "data" / "weather-maxbotix" / "WS3-Orloc.csv"
    columns = {
        "Time [UTC]": "time",
        "Distance [mm]": "reading_mm",
        "Temp Atmos [C]": "temperature in degC",
        "Humidity [%]": "humidity in %",
        "PresOB [mBar]": "pressure in mbar",
        "Bat [V]": "supply_V",
    }
    with pytest.warns(echocal.DataWarning, match="first at row 4148: 124.99"):
        data = echocal.read_observations(
            path, columns, skip_lines=1, missing={"Distance [mm]": [-500, 9999], "": [-9999]}
        )
    assert len(data) == 5130
    assert data.unusable_counts == {"Distance [mm] missing": 25, "Temp Atmos [C] out of range": 1}
    assert data.unusable[0] == "Distance [mm] missing"
    assert data.reading is not None
    assert data.reading[1] == 1.182
    assert np.isnan(data.extra["NumTicks [Cnt]"][0])


def test_bare_rock_without_its_codes_points_at_them(shared: Path) -> None:
    path = shared / "data" / "weather-maxbotix" / "WS3-Orloc.csv"
    columns = {"Distance [mm]": "reading_mm", "Temp Atmos [C]": "temperature_C"}
    with pytest.warns(echocal.DataWarning, match=r"holds 9999 in 24 rows.*missing={'Distance \[mm\]': 9999}"):
        echocal.read_observations(path, columns, skip_lines=1)


def test_gzip_with_spaces_in_the_header(shared: Path) -> None:
    path = shared / "data" / "weather-maxbotix" / "StPaul_Log4.csv.gz"
    columns = {"Distace [mm]": "reading_mm", "Temp Atmos [C]": "temperature_C", "Time [UTC]": "time"}
    with pytest.warns(echocal.DataWarning):
        data = echocal.read_observations(path, columns)
    assert len(data) == 10279


def test_two_way_distance_and_kelvin(shared: Path) -> None:
    path = shared / "data" / "kb-hcsr04" / "all_runs_tidy.csv"
    columns = {
        "Exp Distance": "two_way_distance_m",
        "Measured Time Diff": "echo_s",
        "Temperature": "temperature_K",
        "run": "stand",
    }
    data = echocal.read_observations(path, columns)
    assert len(data) == 14455
    assert data.reference_distance is not None
    np.testing.assert_allclose(data.reference_distance, data.extra["L"], rtol=0, atol=1e-12)
    assert data.conditions["temperature"][0] == pytest.approx(20.0)
    assert data.labels["stand"].max() == 119
    assert any("'Pressure' is not used as pressure" in note for note in data.notes)


def test_echo_times_come_back_from_readings(shared: Path) -> None:
    path = shared / "data" / "desk-hcsr04" / "hcsr04_known_distance_tidy.csv"
    columns = {
        "true_cm": "distance_cm",
        "temp_C": "temperature_C",
        "reading_cm": "reading_cm",
        "obs": "order",
        "file": "group",
    }
    with pytest.warns(echocal.DataWarning, match="95 of 3412 rows cannot be used: 95 temp_C missing"):
        data = echocal.read_observations(path, columns, reading_speed="331.3+0.606*T")
    assert data.echo_time[0] == pytest.approx(2 * 0.73302 / (331.3 + 0.606 * 29.1), rel=1e-14)
    assert data.labels["order"].max() == 10
    assert data.labels["group"].max() == 21
