"""Causes in the arithmetic of a device do not compete where the echo time is known without it."""

import numpy as np
import pandas as pd
import pytest

import echocal

FIRMWARE = {effect.id for effect in echocal.effects() if effect.stage == "firmware"}


@pytest.fixture
def log(random: np.random.Generator) -> pd.DataFrame:
    """Echo times [us] over 40 degC, and a pressure that varies."""
    air = random.uniform(0.0, 40.0, 300)
    distance = random.choice([0.5, 1.0, 2.0], 300)
    echo = 2e6 * (distance + random.normal(0.0, 1e-3, 300)) / (331.4 + 0.6 * air)
    return pd.DataFrame(
        {
            "echo_us": echo,
            "temperature_C": air,
            "distance_m": distance,
            "pressure_hPa": random.uniform(950.0, 1050.0, 300),
            "temperature_box_C": air + random.normal(3.0, 1.0, 300),
        }
    )


def read(log: pd.DataFrame, speed: float | str | None, name: str) -> pd.DataFrame:
    """The table with a reading that the device made with some speed."""
    used = 331.4 + 0.6 * log["temperature_C"] if isinstance(speed, str | None) else speed
    return log.assign(**{name: 0.5e-6 * log["echo_us"] * used}).drop(columns="echo_us")


def competing(diagnosis: echocal.Diagnosis) -> set[str]:
    return FIRMWARE & {id_ for ids, _ in diagnosis.posterior for id_ in ids}


def all_sets(table: pd.DataFrame, **options: object) -> set[str]:
    """Firmware's causes in any set of the posterior, however improbable."""
    return competing(echocal.diagnose(table, **options))  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("column", "factor"),
    [("echo_us", 1.0), ("time_of_flight_s", 1e-6), ("transit_us", 0.5)],
)
def test_recorded_times(log: pd.DataFrame, column: str, factor: float) -> None:
    table = log.assign(**{column: factor * log["echo_us"]})
    table = table if column == "echo_us" else table.drop(columns="echo_us")
    assert not all_sets(table)


def test_times_beside_readings(log: pd.DataFrame) -> None:
    table = read(log, 343.0, "reading_m").assign(echo_us=log["echo_us"])
    assert not all_sets(table)


def test_readings_of_one_stated_speed_are_times(log: pd.DataFrame) -> None:
    found = all_sets(read(log, 331.4, "reading_m"), reading_speed="331.4")
    assert found <= {"double_correction"}  # the statement may be wrong in this way


def test_a_device_that_compensates_although_one_speed_is_stated(log: pd.DataFrame) -> None:
    table = read(log, None, "reading_m")
    diagnosis = echocal.diagnose(table, reading_speed="331.4")
    assert "double_correction" in {c.id for c in diagnosis.causes if c.in_model}, diagnosis.explain()


def test_a_stated_law_leaves_only_another_thermometer(log: pd.DataFrame) -> None:
    assert all_sets(read(log, "331.3+0.606*T", "reading_m"), reading_speed="331.3+0.606*T") <= {
        "internal_thermometer"
    }


def test_readings_without_a_stated_speed_may_be_wrong(log: pd.DataFrame) -> None:
    diagnosis = echocal.diagnose(read(log, 343.0, "reading_m"))
    assert "fixed_speed" in {cause.id for cause in diagnosis.causes}


def test_a_base_that_is_one_speed_asks_for_it(log: pd.DataFrame) -> None:
    diagnosis = echocal.diagnose(log, base=343)
    assert "fixed_speed" in {cause.id for cause in diagnosis.causes}
    assert competing(diagnosis) == {"fixed_speed"}
