"""Errors that follow the order of the rows, or a column with few values: several devices in one log."""

import numpy as np
import pandas as pd
import pytest

import echocal

ROWS = 400


def log(random: np.random.Generator) -> pd.DataFrame:
    """Readings of one device at a distance that nobody knows."""
    celsius = 15.0 + 5.0 * np.sin(np.linspace(0.0, 20.0, ROWS)) + random.normal(0.0, 0.2, ROWS)
    reading = 1.6 + random.normal(0.0, 0.5e-3, ROWS)
    return pd.DataFrame({"time_s": 600.0 * np.arange(ROWS), "temperature_C": celsius, "reading_m": reading})


def diagnosed(table: pd.DataFrame) -> echocal.Diagnosis:
    return echocal.diagnose(table, constant_distance=True)


@pytest.mark.statistical
@pytest.mark.parametrize("devices", [2, 3])
def test_devices_that_take_turns_are_found_by_the_order_of_the_rows(
    random: np.random.Generator, devices: int
) -> None:
    table = log(random)
    table["reading_m"] += 8e-3 * (np.arange(ROWS) % devices)
    found = diagnosed(table)
    assert found.verdict == "unknown"
    assert found.remainder is not None
    assert f"period of {devices} rows" in found.remainder.turns
    assert found.remainder.rms_floor_m == pytest.approx(0.5e-3, rel=0.2)


def test_one_device_takes_no_turns(random: np.random.Generator) -> None:
    found = diagnosed(log(random))
    assert found.remainder is None or not found.remainder.turns


def test_stations_that_take_turns_are_no_devices(random: np.random.Generator) -> None:
    distance = np.resize([0.5, 1.0, 2.0, 3.0], ROWS)
    tape = np.resize([4e-3, -3e-3, 5e-3, -6e-3], ROWS)
    table = log(random).assign(distance_m=distance)
    table["reading_m"] = distance + tape + random.normal(0.0, 0.5e-3, ROWS)
    found = echocal.diagnose(table)
    assert found.remainder is None or not found.remainder.turns


@pytest.mark.statistical
@pytest.mark.parametrize("values", [(0, 1), (3, 4, 7)])
def test_a_column_with_few_values_is_tried(random: np.random.Generator, values: tuple[int, ...]) -> None:
    place = random.integers(0, len(values), ROWS)
    table = log(random).assign(fw_version=np.array(values)[place])
    table["reading_m"] += 8e-3 * place
    found = diagnosed(table)
    assert found.verdict == "unknown"
    assert found.unexplained is not None
    assert found.unexplained.against == "fw_version"
    assert found.gain is not None
    assert found.gain.rms_floor_m < 0.4 * found.gain.rms_before_m


@pytest.mark.statistical
def test_such_a_column_without_an_influence_changes_nothing(random: np.random.Generator) -> None:
    table = log(random)
    column = random.integers(0, 2, ROWS)
    assert diagnosed(table.assign(fw_version=column)).verdict == diagnosed(table).verdict


@pytest.mark.statistical
def test_a_switch_may_stand_still_in_whole_parts_of_a_table(random: np.random.Generator) -> None:
    """Folds that never saw it switched have no function of it."""
    on = (np.arange(ROWS) // 20 == 4) & (np.arange(ROWS) % 2 == 0)
    table = log(random).assign(heater=on.astype(float))
    table["reading_m"] += 20e-3 * on
    found = diagnosed(table)
    assert found.gain is not None
    assert found.gain.rms_after_m <= found.gain.rms_before_m
