"""Sizes beyond the usual ones, and members of a class beside a noise."""

import numpy as np
import pandas as pd
import pytest

import echocal

ROWS = 360


def speed(celsius: np.ndarray) -> np.ndarray:
    return 331.4 + 0.6 * celsius


def wrong_slope(random: np.random.Generator, distance: np.ndarray) -> pd.DataFrame:
    """The air warms three tenths more than the thermometer says: far beyond any usual thermometer or law."""
    celsius = (
        20.0 + 10.0 * np.sin(np.linspace(0.0, 12.0, len(distance))) + random.normal(0.0, 0.3, len(distance))
    )
    reading = distance * speed(celsius) / speed(celsius + 0.3 * (celsius - 20.0))
    reading += random.normal(0.0, 0.5e-3, len(distance))
    return pd.DataFrame({"temperature_C": celsius, "distance_m": distance, "reading_m": reading})


@pytest.mark.statistical
def test_a_size_beyond_reason_is_kept_without_a_name(random: np.random.Generator) -> None:
    """Its gain is true: it holds at every distance."""
    diagnosis = echocal.diagnose(wrong_slope(random, random.uniform(0.4, 3.5, ROWS)))
    assert diagnosis.model.effects
    assert diagnosis.gain is not None
    assert diagnosis.gain.rms_after_m < 0.3 * diagnosis.gain.rms_before_m
    doubts = [cause.doubt for cause in diagnosis.causes if cause.in_model and cause.kind == "effect"]
    assert any("times the usual one" in doubt for doubt in doubts)


@pytest.mark.statistical
def test_members_of_a_class_keep_their_odds_beside_a_noise(random: np.random.Generator) -> None:
    """In a room at one temperature a delay and an offset are the same, and a clock and a tape."""
    distance = np.repeat(np.linspace(0.4, 3.4, 12), ROWS // 12)
    celsius = 21.0 + random.normal(0.0, 0.05, ROWS)
    late = 80e-6 + random.exponential(60e-6, ROWS)  # the pin is polled
    echo = 1.004 * (2.0 * distance / speed(celsius) + late + random.normal(0.0, 2e-6, ROWS))
    table = pd.DataFrame({"temperature_C": celsius, "distance_m": distance, "echo_us": 1e6 * echo})
    diagnosis = echocal.diagnose(table)
    assert "polling_jitter" in {cause.id for cause in diagnosis.causes}

    def probability(id_: str) -> float:
        return sum(p for ids, p in diagnosis.posterior if id_ in ids)

    assert 1 / 5 < probability("fixed_delay") / probability("zero_error") < 5
    assert 1 / 10 < probability("clock_error") / probability("reference_scale") < 10


@pytest.mark.parametrize("hours", [1.0, pytest.param(30.0, marks=pytest.mark.statistical)])
def test_an_hour_of_the_sun_is_no_daylight(random: np.random.Generator, hours: float) -> None:
    time = pd.date_range("2026-06-01T10:00", periods=ROWS, freq=pd.Timedelta(hours=hours / ROWS))
    celsius = 20.0 + random.normal(0.0, 0.5, ROWS)
    distance = random.uniform(0.5, 3.0, ROWS)
    reading = distance * (1.0 + 2e-3 * np.linspace(0.0, 1.0, ROWS)) + random.normal(0.0, 1e-3, ROWS)
    table = pd.DataFrame(
        {"time": time.astype(str), "temperature_C": celsius, "distance_m": distance, "reading_m": reading}
    )
    sets = [ids for ids, _ in echocal.diagnose(table).posterior]
    assert any("temperature_daylight" in ids for ids in sets) == (hours > 12.0)


@pytest.mark.statistical
def test_a_thermometer_in_a_screen_without_a_fan_is_named(random: np.random.Generator) -> None:
    """It lags by a quarter of an hour, and nobody knows the distance."""
    seconds = 300.0 * np.arange(2000)
    air = 12.0 + 7.0 * np.sin(2 * np.pi * seconds / 86400.0) + np.cumsum(random.normal(0.0, 0.15, 2000))
    shown = air.copy()
    for row in range(1, 2000):
        shown[row] = shown[row - 1] + (air[row] - shown[row - 1]) * (1.0 - np.exp(-300.0 / 950.0))
    reading = 2.0 * speed(shown) / speed(air) + random.normal(0.0, 1e-3, 2000)
    table = pd.DataFrame({"time_s": seconds, "temperature_C": shown, "reading_m": reading})
    diagnosis = echocal.diagnose(table, constant_distance=True)
    (lag,) = (cause for cause in diagnosis.causes if cause.id == "temperature_lag")
    assert lag.in_model
    assert not lag.doubt
    assert lag.parameters[0].value == pytest.approx(950.0, rel=0.25)


@pytest.mark.statistical
def test_no_needless_cause_beside_an_unexplained_term(random: np.random.Generator) -> None:
    """At one distance an offset of the thermometer and a gradient of the air are one column: never both."""
    count = 1000
    time = 1800.0 * np.arange(count)
    day = 2 * np.pi * time / 86400.0
    air = 12.0 + 5.0 * np.sin(day) + np.convolve(random.normal(0.0, 0.4, count), np.ones(40) / 6.0, "same")
    humidity = np.clip(70.0 - 3.0 * (air - 12.0) + random.normal(0.0, 3.0, count), 5.0, 99.0)
    town = 12.5 + 0.85 * (air - 12.0) + np.convolve(random.normal(0.0, 0.8, count), np.ones(40) / 6.0, "same")
    shown = np.concatenate([town[:1], town[:-1]])
    echo = 2.0 * 2.4 / (331.3 * np.sqrt(1.0 + air / 273.15)) + random.normal(0.0, 3e-6, count)
    table = pd.DataFrame(
        {"time_s": time, "temperature_C": shown, "humidity_percent": humidity, "echo_us": 1e6 * echo}
    )
    found = echocal.diagnose(table, base="cramer", constant_distance=True)
    both = {"temperature_offset", "temperature_gradient"}
    assert sum(p for ids, p in found.posterior if both <= set(ids)) < 0.1
