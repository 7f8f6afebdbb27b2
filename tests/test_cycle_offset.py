"""Whole periods that hold for a placement: found, told from causes, and not found where there are none."""

from pathlib import Path

import numpy as np
import pandas as pd
import pytest

import echocal
from echocal.diagnose.findings.parts import Cause
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


def found(table: dict[str, np.ndarray]) -> dict[str, Cause]:
    return {cause.id: cause for cause in echocal.diagnose(table).causes}


@pytest.mark.statistical
def test_placements_that_miss_cycles_are_found_with_their_share(random: np.random.Generator) -> None:
    """22 of 24 tables drawn; the second table makes up for a rare miss."""
    for _ in range(2):
        table = bench(random, cycles=(0.6, 0.3, 0.1))
        causes = found(table)
        if "cycle_offset" in causes:
            break
    cause = causes["cycle_offset"]
    sizes = {p.name: (p.value, p.standard_uncertainty) for p in cause.parameters}
    assert abs(sizes["period"][0] - PERIOD) < 4 * sizes["period"][1] + 0.2e-6
    assert 0.1 < sizes["share"][0] < 0.9
    assert sizes["placements"][0] == 24
    assert "placements are whole periods of 4.2" in cause.because


@pytest.mark.statistical
def test_a_scale_or_an_edge_keeps_its_name_where_no_cycle_is_missed(random: np.random.Generator) -> None:
    """None of 32 tables drawn has cycles; 12 of 16 have their scale's class."""
    for more in ({"scale": 0.006}, {"edge": 0.008}):
        causes = found(bench(random, placements=36, distances=12, **more))
        assert "cycle_offset" not in causes
        assert any(cause.kind == "effect" for cause in causes.values())


@pytest.mark.statistical
@pytest.mark.parametrize("more", [{"tape": 4e-3}, {"apart": 4e-3}, {"apart": 8e-3}, {}])
def test_errors_of_any_size_are_no_lattice(more: dict[str, float], random: np.random.Generator) -> None:
    """One of 65 tables drawn has cycles, so one of three may."""
    assert sum("cycle_offset" in found(bench(random, **more)) for _ in range(3)) <= 1


@pytest.mark.statistical
def test_a_lattice_beside_a_scale_leaves_the_scale(random: np.random.Generator) -> None:
    """The offsets are taken off before the scale is fitted: 0.8 % is 27 mm at 3.4 m."""
    for _ in range(3):  # 13 of 14 tables drawn
        causes = found(bench(random, cycles=(0.6, 0.4), scale=0.008, distances=8, placements=32))
        if "cycle_offset" in causes:
            break
    assert causes["cycle_offset"].probability > 0.5
    assert any(cause.kind == "effect" for cause in causes.values())


@pytest.mark.statistical
def test_stretches_of_time_under_a_constant_distance(random: np.random.Generator) -> None:
    """24 of 24 logs drawn."""
    row = np.arange(600)
    begins = np.sort(random.choice(np.arange(15, 585, 15), 13, replace=False))
    missed = np.searchsorted(begins, row, side="right") % 2
    temperature = 14 + 6 * np.sin(row / 95) + random.normal(0, 0.1, 600)
    reading = 2.0 + random.normal(0, 0.7e-3, 600) + 0.5 * missed * PERIOD * (331.4 + 0.6 * temperature)
    table = {"reading_m": reading, "temperature_C": temperature, "time_s": 600.0 * row}
    diagnosis = echocal.diagnose(table, constant_distance=True)
    assert "cycle_offset" in {cause.id for cause in diagnosis.causes}


def test_a_desk_of_sessions(shared: Path) -> None:
    """The sessions of a ruler and an HC-SR04 differ by 0 or 4.4 mm at each distance below 0.2 m."""
    table = pd.read_csv(shared / "data" / "desk-hcsr04" / "hcsr04_known_distance_tidy.csv").dropna()
    columns = {
        "true_cm": "distance_cm",
        "temp_C": "temperature_C",
        "reading_cm": "reading_cm",
        "obs": "order",
        "file": "group",
    }
    diagnosis = echocal.diagnose(table, columns=columns, reading_speed="331.3+0.606*T")
    (cause,) = [cause for cause in diagnosis.causes if cause.id == "cycle_offset"]
    assert cause.probability > 0.9
    sizes = {p.name: (p.value, p.standard_uncertainty) for p in cause.parameters}
    assert abs(sizes["period"][0] - PERIOD) < 4 * sizes["period"][1]
    near = table[table["true_cm"].between(4.5, 19.5)]  # an independent look
    off = 1e-2 * (near["reading_cm"] - near["true_cm"]).groupby([near["file"], near["true_cm"]]).median()
    phase = np.exp(2j * np.pi * off / (0.5 * 349.0 * PERIOD))
    assert np.abs(phase.mean()) > 0.5


def test_integers_come_out_of_a_staircase(random: np.random.Generator) -> None:
    """Every integer, up to a common one that the offset takes."""
    distance = np.linspace(0.3, 3.0, 40)
    truth = random.integers(-1, 3, 40)
    period = np.full(40, 4.3e-3)
    error = 0.003 + 0.001 * distance + truth * period + random.normal(0, 2e-4, 40)
    placements = Placements(error, np.stack([np.full(40, 5e-3), 2e-3 * distance]), period, np.arange(40))
    _, orders = propose(placements, np.zeros(2), 0)[0]
    assert len(set((orders - truth).tolist())) == 1


def test_the_prior_of_integers_is_a_probability() -> None:
    every = np.stack(np.meshgrid(ORDERS, ORDERS, ORDERS), axis=-1).reshape(-1, 3)
    assert sum(np.exp(log_prior(orders)) for orders in every) == pytest.approx(1.0)
    assert log_prior(np.array([0, 0, 1])) > log_prior(np.array([0, 1, 2])) > log_prior(np.array([-4, 1, 4]))
