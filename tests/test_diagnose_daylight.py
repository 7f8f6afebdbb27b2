"""A thermometer in a sun that nobody recorded: only the clock tells."""

from collections.abc import Callable

import numpy as np
import pandas as pd
import pytest

import echocal
from echocal.observations.clock import hour_angle


@pytest.fixture(scope="module")
def log(request: pytest.FixtureRequest, seeded: Callable[..., np.random.Generator]) -> pd.DataFrame:
    """Ten days around an equinox, every ten minutes; the housing is 3 K too warm at 13:00 local time."""
    random = seeded(request)
    hour = np.arange(1440) / 6.0
    weather = np.interp(hour, np.arange(0, 253, 12), random.normal(0.0, 3.0, 22))
    air = 15.0 + 6.0 * np.sin(2 * np.pi * (hour - 10.0) / 24.0) + weather
    sun = np.clip(np.sin(np.pi * (hour % 24 - 7.0) / 12.0), 0.0, None)  # up from 7 to 19 h
    recorded = air + 3.0 * sun
    reading = 2.0 * (331.4 + 0.6 * recorded) / (331.4 + 0.6 * air) + random.normal(0.0, 1e-3, 1440)
    time = pd.date_range("2024-03-15", periods=1440, freq="10min").strftime("%Y-%m-%dT%H:%M:%S")
    return pd.DataFrame({"time": time, "reading_m": reading, "temperature_C": recorded})


@pytest.mark.parametrize("known", [{"reference_distance": 2.0}, {"constant_distance": True}])
def test_the_clock_stands_in_for_the_sun(log: pd.DataFrame, known: dict[str, float]) -> None:
    diagnosis = echocal.diagnose(log, **known)  # type: ignore[arg-type]
    cause = next(c for c in diagnosis.causes if c.id == "temperature_daylight")
    assert cause.probability >= 0.9
    sizes = {p.name: p.value for p in cause.parameters}
    assert sizes["gain"] == pytest.approx(3.0, abs=0.3)
    assert sizes["lag"] * 12 / np.pi == pytest.approx(1.0, abs=0.3)  # h


def test_a_recorded_sun_is_believed_rather_than_the_clock(log: pd.DataFrame) -> None:
    hour = np.arange(len(log)) / 6.0
    sun = 900.0 * np.clip(np.sin(np.pi * (hour % 24 - 7.0) / 12.0), 0.0, None)
    diagnosis = echocal.diagnose(log.assign(radiation_W_m2=sun), reference_distance=2.0)
    ids = {c.id for c in diagnosis.causes}
    assert "temperature_radiation" in ids
    assert "temperature_daylight" not in ids


def test_without_times_of_day_it_does_not_compete(log: pd.DataFrame) -> None:
    seconds = log.drop(columns="time").assign(time_s=600.0 * np.arange(len(log)))
    diagnosis = echocal.diagnose(seconds, reference_distance=2.0)
    assert not [ids for ids, _ in diagnosis.posterior if "temperature_daylight" in ids]


def test_the_hour_is_that_of_the_zone() -> None:
    noon = np.array(["2024-07-01T10:00", "2024-01-01T11:00", "NaT"], dtype="datetime64[ns]")
    angle = hour_angle(noon, "Europe/Copenhagen")  # 12:00 there, in summer and in winter
    assert angle[:2] == pytest.approx([0.0, 0.0], abs=1e-12)
    assert np.isnan(angle[2])
