"""A target that moves although its distance is said to be constant is said to move."""

import warnings
from typing import Any

import numpy as np
import pytest

import echocal
from echocal.diagnose.results.brief import brief

ROWS = 160
row = np.arange(ROWS)


def moves(kind: str, rng: np.random.Generator) -> np.ndarray:
    """Distance of each row [m]."""
    at_rest = np.full(ROWS, 1.5)
    ways = {
        "wanders": 1.5 + 0.4 * np.sin(row / rng.uniform(5, 25)) + 0.1 * np.sin(row / 3.1),
        "approaches": np.linspace(3.0, rng.uniform(0.3, 1.0), ROWS),
        "goes off": np.where(row < ROWS / 2, 1.5, 1.5 + 0.02 * (row - ROWS / 2) * rng.uniform(0.5, 2)),
        "anywhere": rng.uniform(0.3, 3.0, ROWS),
        "rests": at_rest,
        "is knocked": at_rest + 0.006 * (row > rng.integers(40, 120)),
        "is placed": np.repeat(rng.uniform(0.4, 3.0, 4), ROWS // 4),
        "is in turbulence": at_rest + rng.normal(0.0, 0.02, ROWS),
    }
    return ways[kind]


def diagnosed(kind: str, seed: int) -> Any:
    rng = np.random.default_rng(seed)
    temperature = 15 + 8 * np.sin(row / 40) + rng.normal(0, 0.1, ROWS)
    reading = moves(kind, rng) + rng.normal(0, 2e-3, ROWS)
    table = {"reading_m": reading.round(3), "temperature_C": temperature.round(2), "time_s": 60.0 * row}
    with warnings.catch_warnings(action="ignore"):
        return echocal.diagnose(table, constant_distance=True)


@pytest.mark.parametrize("kind", ["wanders", "approaches", "goes off", "anywhere"])
def test_a_target_that_moves_is_said_to_move(kind: str) -> None:
    for seed in range(6):
        found = diagnosed(kind, seed)
        assert found.notes[0].startswith("the target moved: constant_distance=True says that it did not")
        assert found.verdict == "unknown"
        assert "noise_growth" not in {cause.id for cause in found.causes}


@pytest.mark.parametrize("kind", ["rests", "is knocked", "is placed", "is in turbulence"])
def test_a_target_at_rest_is_not(kind: str) -> None:
    for seed in range(6):
        assert not any("the target moved" in note for note in diagnosed(kind, seed).notes)


@pytest.mark.parametrize("kind", ["wanders", "approaches", "goes off", "anywhere"])
def test_five_lines_say_that_it_moved_and_what_to_record(kind: str) -> None:
    for seed in range(6):
        said = brief(diagnosed(kind, seed))
        assert said.wrong.startswith("the target moved: constant_distance=True says that it did not")
        for way in ("distance_m", "placements", "reference"):
            assert way in said.next


def stated(kind: str, seed: int) -> echocal.Diagnosis:
    rng = np.random.default_rng(seed)
    reading = moves(kind, rng) + rng.normal(0, 2e-3, ROWS)
    with warnings.catch_warnings(action="ignore"):
        return echocal.diagnose(
            {"reading_m": reading.round(3)}, at={"temperature": 20.0}, reference_distance=1.5
        )


@pytest.mark.parametrize("kind", ["wanders", "approaches", "anywhere", "is placed"])
def test_one_stated_distance_that_readings_contradict_is_said(kind: str) -> None:
    for seed in range(6):
        said = brief(stated(kind, seed))
        assert said.wrong.startswith("the target moved: reference_distance=1.5 says that it did not")
        assert "nothing" not in said.next


@pytest.mark.parametrize("kind", ["rests", "is knocked", "is in turbulence"])
def test_one_stated_distance_of_a_target_at_rest_is_believed(kind: str) -> None:
    for seed in range(6):
        assert not stated(kind, seed).moved
