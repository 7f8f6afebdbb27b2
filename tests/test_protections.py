"""A log in other words or other units is read, or asked for with the option that mends it."""

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

import echocal

Run = Callable[..., tuple[int, str]]


@pytest.fixture
def table(random: np.random.Generator) -> pd.DataFrame:
    """Echoes of a sensor without fault."""
    temperature, distance = random.uniform(0.0, 40.0, 60), random.uniform(0.3, 3.0, 60)
    echo = 2e6 * distance / (331.4 + 0.6 * temperature)
    return pd.DataFrame({"echo_us": echo, "distance_m": distance, "temperature_C": temperature})


def test_feet_are_read_as_feet(table: pd.DataFrame) -> None:
    table["distance_ft"] = table.pop("distance_m") / 0.3048
    read = echocal.read_observations(table)
    expected = table["echo_us"] * 0.5e-6 * (331.4 + 0.6 * table["temperature_C"])
    np.testing.assert_allclose(read.reference_distance, expected, rtol=1e-12)


def test_a_time_difference_beside_a_true_distance_is_asked_for(table: pd.DataFrame, run: Run) -> None:
    """Not the true distance as a reading: every error would be zero."""
    table.columns = pd.Index(["Measured Time Diff", "Real Distance (m)", "Temperature (C)"])
    table.to_csv(Path("log.csv"), index=False)
    code, said = run("diagnose", "log.csv")
    assert code == 3
    assert '"Measured Time Diff=echo_us"' in " ".join(said.split())
    assert "=reading_m" not in said
    assert run("diagnose", "log.csv", "--column", "Measured Time Diff=echo_us", "-q")[0] == 0


@pytest.mark.parametrize(
    ("name", "holds"),
    [("quality", "echo_quality"), ("signal_quality", "echo_quality"), ("Air quality", "extra")],
)
def test_a_quality_number_is_proposed_as_that_of_the_echo(
    name: str, holds: str, table: pd.DataFrame, run: Run, random: np.random.Generator
) -> None:
    table[name] = random.integers(152, 210, len(table))
    table.to_csv(Path("log.csv"), index=False)
    assert run("inspect", "log.csv", "-o", "log.toml", "-q")[0] == 0
    assert (
        f'"{name}" = "{holds}"' in Path("log.toml").read_text()
        or f'{name} = "{holds}"' in Path("log.toml").read_text()
    ) == (holds != "extra")


@pytest.mark.parametrize("name", ["quality", "Quality number", "sonic_quality", "Qualität"])
def test_a_quality_number_is_read_by_its_name(
    name: str, table: pd.DataFrame, random: np.random.Generator
) -> None:
    table[name] = random.permutation(len(table)) + 152
    read = echocal.read_observations(table)
    np.testing.assert_array_equal(read.conditions["echo_quality"], table[name])
    assert any(f"'{name}' as echo_quality" in note for note in read.notes)


@pytest.mark.parametrize("name", ["quality", "quality_flag", "link quality", "Air quality", "GPS quality"])
def test_a_flag_and_other_qualities_are_none(
    name: str, table: pd.DataFrame, random: np.random.Generator
) -> None:
    few = name == "quality"
    table[name] = random.integers(0, 4, len(table)) if few else random.permutation(len(table))
    read = echocal.read_observations(table)
    assert "echo_quality" not in read.conditions
    assert any("few different values" in note for note in read.notes) == few
