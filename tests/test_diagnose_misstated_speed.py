"""A scale error that a wrong statement about the device explains as well."""

import numpy as np
import pandas as pd
import pytest

import echocal

ROWS = 120


def table(random: np.random.Generator, speed: float, clock: float = 0.0) -> pd.DataFrame:
    """Readings of a device that converts with one speed; its clock is fast by a part."""
    distance = np.repeat(np.linspace(0.4, 3.2, 12), ROWS // 12)
    celsius = 18.0 + random.normal(0.0, 2.0, ROWS)
    echo = 2.0 * distance / (331.4 + 0.6 * celsius) * (1.0 + clock) + random.normal(0.0, 1.5e-6, ROWS)
    return pd.DataFrame({"temperature_C": celsius, "distance_m": distance, "reading_m": speed * echo / 2.0})


def asked(table: pd.DataFrame, speed: float) -> list[str]:
    """Doubts of causes in the model that ask for another reading speed."""
    found = echocal.diagnose(table, reading_speed=speed)
    return [cause.doubt for cause in found.causes if cause.in_model and "--reading-speed" in cause.doubt]


@pytest.mark.statistical
@pytest.mark.parametrize(("true", "stated"), [(331.4, 343.0), (340.0, 344.8)])
def test_a_wrong_speed_is_asked_for(random: np.random.Generator, true: float, stated: float) -> None:
    (doubt,) = asked(table(random, true), stated)
    assert f"try --reading-speed {true:g}" in doubt
    assert asked(table(random, true), true) == []


@pytest.mark.statistical
def test_a_clock_that_no_speed_explains_is_not_doubted(random: np.random.Generator) -> None:
    rows = table(random, 343.0, clock=-0.005)
    assert asked(rows, 343.0) == []
    assert {"clock_error", "interrupt_loss"} & {
        id_
        for cause in echocal.diagnose(rows, reading_speed=343.0).causes
        for id_ in (cause.id, *cause.indistinguishable_from)
    }


@pytest.mark.statistical
def test_recorded_echo_times_have_no_reading_speed(random: np.random.Generator) -> None:
    rows = table(random, 343.0, clock=0.0232)  # as 343 m/s for readings made with 350.9 m/s
    rows["echo_us"] = rows.pop("reading_m") * 2e6 / 343.0
    found = echocal.diagnose(rows)
    assert not any("--reading-speed" in cause.doubt for cause in found.causes)
