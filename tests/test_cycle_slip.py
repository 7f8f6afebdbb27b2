"""Rows that miss cycles: no effect takes up their mean error, and an effect beside them keeps its size."""

import numpy as np
import pytest

import echocal

PERIOD = 25e-6  # s
ROWS = 600


def slipping(random: np.random.Generator, *, delay: float = 0.0) -> dict[str, np.ndarray]:
    """A sensor at known distances whose comparator misses a cycle in 4 to 25 % of the rows."""
    time = 600.0 * np.arange(ROWS)
    temperature = (
        12 + 7 * np.sin(2 * np.pi * time / 86400 + random.uniform(0, 6)) + random.normal(0, 0.3, ROWS)
    )
    humidity = np.clip(0.6 + random.normal(0, 0.03, ROWS), 0.0, 1.0)
    distance = random.uniform(0.4, 3.9, ROWS)
    echo = 2 * distance / echocal.speed_of_sound(temperature, humidity) + delay
    echo += random.normal(0, random.uniform(1e-6, 6e-6), ROWS)
    echo += PERIOD * (random.random(ROWS) < random.uniform(0.04, 0.25))
    return {
        "echo_s": echo,
        "temperature_C": temperature,
        "humidity_percent": 100 * humidity,
        "time_s": time,
        "distance_m": distance,
    }


@pytest.mark.statistical
def test_missed_cycles_are_no_offset(random: np.random.Generator) -> None:
    """24 of 24 tables drawn name cycle_slip alone; without the subtraction of the cycles, 4 did."""
    extra = []
    for _ in range(6):
        found = echocal.diagnose(slipping(random), base="cramer")
        extra.append([cause.id for cause in found.causes if cause.id != "cycle_slip"])
        assert [cause.id for cause in found.causes if cause.kind == "noise"] == ["cycle_slip"]
    assert sum(map(bool, extra)) <= 1, extra


@pytest.mark.statistical
def test_a_delay_beside_missed_cycles_keeps_its_size(random: np.random.Generator) -> None:
    delay = random.uniform(30e-6, 60e-6)
    found = echocal.diagnose(slipping(random, delay=delay), base="cramer")
    assert {cause.id for cause in found.causes} <= {"cycle_slip", "fixed_delay", "zero_error"}
    (effect,) = [cause for cause in found.causes if cause.kind == "effect"]
    size = effect.parameters[0].value
    fitted = size if effect.id == "fixed_delay" else 2 * size / 340.0
    off = (fitted - delay + 0.5 * PERIOD) % PERIOD - 0.5 * PERIOD  # all rows may have missed one cycle more
    assert abs(off) < 1.5e-6


def stepping(random: np.random.Generator) -> dict[str, np.ndarray]:
    """A sensor at twelve places for a day each; a fainter echo crosses the threshold whole periods later."""
    place = np.repeat(np.arange(12), 72)
    time = 1200.0 * np.arange(len(place))
    temperature = 12 + 5 * np.sin(2 * np.pi * time / 86400) + random.normal(0, 0.3, len(place))
    distance = random.uniform(0.5, 3.2, 12)[place]
    loud = random.normal(0, 0.15, 12)[place] + random.normal(0, 0.1, len(place)) - np.log(distance)
    rises = np.arange(1, 12)[:, None] / 12  # of the envelope at the crest of each period
    periods = np.argmax(np.log(rises) + loud > np.log(0.1), axis=0)
    early = random.uniform(-150e-6, -100e-6)
    echo = 2 * distance / echocal.speed_of_sound(temperature, 0.5) + PERIOD * periods + early
    echo += random.normal(0, 2e-6, 12)[place] + random.normal(0, 2e-6, len(place))
    return {
        "echo_s": echo,
        "temperature_C": temperature,
        "humidity_percent": np.full(len(place), 50.0),
        "time_s": time,
        "distance_m": distance,
        "stand": place,
    }


@pytest.mark.slow
@pytest.mark.statistical
def test_a_walk_in_whole_periods_is_no_other_scale(random: np.random.Generator) -> None:
    """3 of 40 tables drawn name a scale and exclude the walk; with the walk of single rows, 26 did."""
    scales = {"clock_error", "gas_composition", "reference_scale", "speed_intercept"}
    scales |= {"temperature_gradient", "temperature_offset"}
    wrong = []
    for _ in range(10):
        for cause in echocal.diagnose(stepping(random), base="cramer").causes:
            named = cause.id in scales and cause.probability >= 0.9 and not cause.doubt
            if named and "amplitude_walk" not in cause.indistinguishable_from:
                wrong.append(cause.id)
    assert len(wrong) <= 3, wrong
