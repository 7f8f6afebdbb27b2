"""Whole periods that hold for a placement: found, told from causes, and not found where there are none."""

from pathlib import Path

import numpy as np
import pandas as pd
import pytest

import echocal
from echocal.diagnose.noises.common.lattice import ORDERS, Placements, log_prior, propose

PERIOD = 25e-6  # s


def bench(
    random: np.random.Generator,
    *,
    placements: int = 24,
    distances: int = 6,
    tape: float = 0.5e-3,
    apart: float = 0.3e-3,
    cycles: tuple[float, ...] = (1.0,),
    scale: float = 0.0,
    edge: float = 0.0,
) -> dict[str, np.ndarray]:
    """Ten rows a placement; `cycles` are the probabilities of 0, 1, ... missed cycles of a placement."""
    placement = np.repeat(np.arange(placements), 10)
    at = np.sort(random.uniform(0.3, 3.8, distances)).round(3)
    station = placement % distances
    distance, row = at[station], np.arange(len(placement))
    temperature = 14 + 9 * np.sin(row / 40 + random.uniform(0, 6)) + random.normal(0, 0.1, len(row))
    error = random.normal(0, 1e-3, len(row)) + random.normal(0, tape, distances)[station]
    error += random.normal(0, apart, placements)[placement]
    missed = random.choice(len(cycles), size=placements, p=cycles)[placement]
    error += 0.5 * missed * PERIOD * (331.4 + 0.6 * temperature)
    error += scale * distance - edge * np.maximum(distance - random.uniform(1.0, 2.0), 0.0)
    return {
        "reading_m": distance + error,
        "distance_m": distance,
        "temperature_C": temperature,
        "humidity_percent": 55 + 20 * np.sin(row / 17) + random.normal(0, 2, len(row)),
        "time_s": 60.0 * row,
    }


def found(table: dict[str, np.ndarray]) -> dict[str, echocal.diagnose.Cause]:  # type: ignore[name-defined]
    return {cause.id: cause for cause in echocal.diagnose(table).causes}
