"""Air along the path that differs from that at the thermometer is no cause that changes with time."""

import numpy as np
import pytest
from scipy.signal import lfilter

import echocal

ROWS, STEP = 1200, 1.5  # half an hour

Table = dict[str, np.ndarray]

CHANGING = {
    "temperature_self_heating",
    "drift",
    "step_change",
    "temperature_lag",
    "temperature_timestamp_shift",
}
"""Causes that change with time: what a slow difference of the air looks like."""


def session(random: np.random.Generator, kelvin: float) -> Table:
    """Random distances every 1.5 s; the path differs by an autoregression with a memory of half an hour."""
    keep = np.exp(-STEP / 1800.0)
    shocks = random.normal(size=ROWS)
    shocks[1:] *= np.sqrt(1.0 - keep**2)
    apart = kelvin * np.asarray(lfilter([1.0], [1.0, -keep], shocks))
    distance = random.uniform(0.3, 3.5, ROWS).round(3)
    warm = 21.0 + 0.5 * np.sin(np.arange(ROWS) / 300.0) + random.normal(0.0, 0.05, ROWS)
    recorded, true = (echocal.speed_of_sound(warm + one, law="linear") for one in (0.0, apart))
    reading = distance * recorded / true + random.normal(0.0, 1e-3, ROWS)
    return {
        "time_s": STEP * np.arange(ROWS),
        "temperature_C": warm,
        "distance_m": distance,
        "reading_m": reading,
    }


def changing(diagnosis: echocal.Diagnosis) -> set[str]:
    """Causes that change with time and are claimed, alone or as the first of a class."""
    return {cause.id for cause in diagnosis.causes if cause.probability > 0.9} & CHANGING


@pytest.mark.statistical
def test_slow_air_is_no_cause_that_changes_with_time(random: np.random.Generator) -> None:
    """Of 30 sessions one in five had such a cause with more than 0.9 without this noise, none has with it."""
    answers = [echocal.diagnose(session(random, 0.25), base="linear") for _ in range(12)]
    assert sum(bool(changing(one)) for one in answers) <= 1
    named = [any(cause.id == "slow_air" for cause in one.causes) for one in answers]
    assert sum(named) >= 5, named


@pytest.mark.statistical
def test_still_air_has_no_slow_air(random: np.random.Generator) -> None:
    answers = [echocal.diagnose(session(random, 0.0), base="linear") for _ in range(8)]
    assert not [one for one in answers if any(cause.id == "slow_air" for cause in one.causes)]


@pytest.mark.statistical
def test_a_self_heating_far_beyond_the_air_is_named(random: np.random.Generator) -> None:
    table = session(random, 0.0)
    warmed = 3.0 * (1.0 - np.exp(-table["time_s"] / 400.0))
    table["temperature_C"] = table["temperature_C"] + warmed
    recorded, true = (
        echocal.speed_of_sound(table["temperature_C"] - one, law="linear") for one in (0, warmed)
    )
    table["reading_m"] = table["reading_m"] * recorded / true
    answer = echocal.diagnose(table, base="linear")
    assert "temperature_self_heating" in {cause.id for cause in answer.causes if cause.probability > 0.9}


@pytest.mark.statistical
def test_without_times_nothing_is_slow(random: np.random.Generator) -> None:
    table = session(random, 0.25)
    del table["time_s"]
    assert "slow_air" not in {cause.id for cause in echocal.diagnose(table, base="linear").causes}


def told_of_the_session(diagnosis: echocal.Diagnosis) -> bool:
    return any("one session of 30 min" in note for note in diagnosis.notes)


@pytest.mark.statistical
def test_what_may_be_the_air_of_one_session_is_told(random: np.random.Generator) -> None:
    """A constant 0.4 K may be the air of this half hour, or last. 60 us of delay cannot be this air."""
    table = session(random, 0.0)
    recorded, true = (
        echocal.speed_of_sound(table["temperature_C"] + one, law="linear") for one in (0.0, 0.4)
    )
    small = echocal.diagnose({**table, "reading_m": table["reading_m"] * recorded / true}, base="linear")
    assert small.model.effects
    assert told_of_the_session(small)
    large = echocal.diagnose({**table, "reading_m": table["reading_m"] + 0.01}, base="linear")
    assert large.model.effects
    assert not told_of_the_session(large)


@pytest.mark.statistical
def test_two_sessions_can_tell(random: np.random.Generator) -> None:
    """The same 0.4 K, over two sessions a day apart."""
    table = session(random, 0.0)
    table["time_s"] = table["time_s"] + 86400.0 * (np.arange(ROWS) >= ROWS // 2)
    recorded, true = (
        echocal.speed_of_sound(table["temperature_C"] + one, law="linear") for one in (0.0, 0.4)
    )
    answer = echocal.diagnose({**table, "reading_m": table["reading_m"] * recorded / true}, base="linear")
    assert answer.model.effects
    assert not any("one session" in note for note in answer.notes)
