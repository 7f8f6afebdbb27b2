"""Few readings in whole steps, the same at each station: what they tell about the step and about a size."""

import numpy as np
import pandas as pd
import pytest

import echocal

STATED = {"base": "linear", "reading_speed": "345.8"}  # the device's speed is right at 24 degC


def stations(random: np.random.Generator, count: int) -> np.ndarray:
    """Distances [cm] that stand in steps of 5 cm."""
    return 5.0 * np.sort(random.choice(np.arange(2, 50), count, replace=False))


def table(distance: np.ndarray, reading: np.ndarray, rows: int = 6) -> pd.DataFrame:
    stand = np.repeat(np.arange(len(distance)), rows)
    return pd.DataFrame(
        {
            "stand": stand,
            "distance_cm": np.round(distance[stand], 1),
            "temperature_C": np.full(len(stand), 24.0),
            "reading_cm": reading[stand] if reading.ndim == 1 else reading.ravel(),
        }
    )


def found_step(diagnosis: echocal.Diagnosis) -> tuple[float, str]:
    (cause,) = [c for c in diagnosis.causes if c.id == "reading_quantization"]
    (step,) = [p.value for p in cause.parameters if p.name == "step"]
    return step, cause.because


def test_the_step_of_the_tape_is_not_that_of_the_readings(random: np.random.Generator) -> None:
    distance = stations(random, 6)
    short = random.integers(1, 4)  # so many centimeters at each station: the readings differ by 5 cm
    tape = distance + random.uniform(0.0, 0.9, 6)
    step, because = found_step(echocal.diagnose(table(tape, distance - short), **STATED))
    assert step == pytest.approx(0.01)
    assert "different readings are multiples of 10 mm" in because


def test_a_coarse_step_is_found_between_stations_that_do_not_stand_in_it(random: np.random.Generator) -> None:
    # errors that lie all over the step: else a fine step with an offset is as probable, in 6 of 150 draws
    distance = np.arange(20.0, 220.0, 20.0) + random.permutation(10) + random.random(10)
    rounded = 10.0 * np.floor(distance / 10 + 0.5) + 3.0
    step, because = found_step(echocal.diagnose(table(distance, rounded), **STATED))
    assert step == pytest.approx(0.1)
    assert "different readings differ by multiples of 100 mm" in because


def test_a_step_that_readings_of_one_station_show_is_theirs(random: np.random.Generator) -> None:
    distance = stations(random, 6)
    rows = np.repeat(distance[:, None], 6, axis=1)
    rows[:, 0] += 5.0 * random.choice([-1, 1], 6)
    step, _ = found_step(echocal.diagnose(table(distance, rows), **STATED))
    assert step == pytest.approx(0.05)


def test_identical_readings_do_not_make_a_size_certain(random: np.random.Generator) -> None:
    """An offset of 8 mm before whole centimeters: each station shows it within half a step only."""
    distance = random.uniform(0.0, 9.0, 5) + np.array([15.0, 40.0, 75.0, 120.0, 180.0])
    reading = np.floor(distance - 0.8 + 0.5)
    diagnosis = echocal.diagnose(table(distance, reading), **STATED)
    assert not [note for note in diagnosis.notes if "differs between" in note or "varies between" in note]
