"""Steps of an unknown level, weighed together with the causes: docs/method/noises.md, Eq. 40 to 42."""

from dataclasses import replace

import numpy as np
import pandas as pd
import pytest

import echocal
from echocal.diagnose.inference.case import Case
from echocal.diagnose.inference.sums import Sums
from echocal.diagnose.inference.weigh_steps import StepPosterior, _Tried, weigh_steps
from echocal.diagnose.preprocess.base import Base
from echocal.diagnose.preprocess.prepare import prepare
from echocal.diagnose.preprocess.table import Table
from echocal.diagnose.settings import Settings
from echocal.observations import read_observations

Columns = dict[str, np.ndarray]
ROWS = 800
MOVED = 410  # at ten in the morning, hours after the air has warmed: the size is that of the readings


def slow(random: np.random.Generator, rho: float) -> np.ndarray:
    """First-order autoregressive noise of 0.3 mm."""
    error = random.normal(0.0, 3e-4, ROWS)
    for row in range(1, ROWS):
        error[row] = rho * error[row - 1] + (1 - rho**2) ** 0.5 * error[row]
    return error


def log(random: np.random.Generator, slope: float, bump: float = 0.0, rho: float = 0.0) -> Columns:
    """One level for three days; the air cools sharply in the evening. `slope` is of the speed [1/K]."""
    time = 300.0 * np.arange(ROWS)
    hour = time / 3600 % 24
    day = (hour > random.uniform(6, 8)) & (hour < random.uniform(17, 19))
    temperature = 15 + 1.5 * np.sin(2 * np.pi * (hour - 9) / 24) + 7 * day + random.normal(0, 0.03, ROWS)
    reading = (2.0 + slow(random, rho)) * (1 + slope * (temperature - 15))
    reading[MOVED:] += bump
    return {"time_s": time, "temperature_C": temperature, "reading_m": reading}


def prepared(columns: Columns) -> tuple[Table, StepPosterior]:
    """The table with every proposed step, and the posterior over them."""
    base = Base.of("cramer")
    table = prepare(
        read_observations(pd.DataFrame(columns), reading_speed="cramer"), base, None, True, Settings().rows
    )
    steps = weigh_steps(table, base, 0, Settings())
    assert steps is not None
    return table, steps


@pytest.mark.statistical
@pytest.mark.parametrize("rho", [0.0, 0.6])
def test_evening_edges_of_a_thermal_cause_are_no_steps(random: np.random.Generator, rho: float) -> None:
    columns = log(random, slope=3e-4, rho=rho)
    table, _ = prepared(columns)
    assert len(table.steps) >= 4  # that is what the search proposes
    diagnosis = echocal.diagnose(columns, constant_distance=True)
    assert diagnosis.rows["level_steps_at_rows"] == []
    assert {"speed_slope", "temperature_gain", "linear_speed_law"} & {c.id for c in diagnosis.causes}


@pytest.mark.statistical
@pytest.mark.parametrize("slope", [0.0, 3e-4])
def test_a_target_that_moved_is_a_step_beside_a_cause_or_alone(
    random: np.random.Generator, slope: float
) -> None:
    rows = echocal.diagnose(log(random, slope, bump=0.006, rho=0.6), constant_distance=True).rows
    assert [abs(row - 1 - MOVED) <= 2 for row in rows["level_steps_at_rows"]] == [True]
    (step,) = rows["level_steps"]
    assert step.size_m == pytest.approx(0.006, abs=0.003)
    assert 0.5 <= step.probability <= 1.0


def test_the_noise_between_two_steps_has_the_prior_of_their_heights(random: np.random.Generator) -> None:
    """Averaging a height out is the same as a covariance of it, written out for all rows."""
    _, steps = prepared(log(random, slope=3e-4, bump=0.006))
    case, blocks = steps.case, steps.case.folds.fit
    tried = _Tried.of(case, blocks, steps.rows)
    chosen = steps.sets[2]
    columns = case.found.columns.at([*(case.found.steps[place] for place in chosen)])
    y = case.residual - case.residual.mean()
    columns = columns - columns.mean(axis=1, keepdims=True)  # the level is free
    white = next(i for i, noise in enumerate(case.noises) if noise.rho == 0.0)
    covariance = np.eye(ROWS) + columns.T @ columns / tried.variance
    given = tried.averaged(chosen)
    assert given.products[white, -1, -1] == pytest.approx(y @ np.linalg.solve(covariance, y), rel=1e-6)
    cost = given.log_weight[white] - tried.log_weight[white] - tried._log_prior(chosen)
    assert cost == pytest.approx(-0.5 * np.linalg.slogdet(covariance)[1], rel=1e-6)


def test_a_fold_weighs_steps_without_its_rows(random: np.random.Generator) -> None:
    """Held-out residuals may be anything: the evidence of the steps stays the same.

    Under white noise, because the first rows of a block follow rows of the block before.
    """
    _, steps = prepared(log(random, slope=3e-4, bump=0.006))
    case = replace(steps.case, probable=steps.case.noises[:1])
    seen = ~case.folds.held[1]
    hidden = ~seen[case.folds.blocks]
    residual = case.residual.copy()
    residual[hidden] += random.normal(0.0, 3e-3, int(hidden.sum()))
    columns = case.found.columns
    columns.store(residual)
    sums = Sums.gather(columns, case.sums.order, case.folds.blocks, case.sums.correlations)
    other = replace(case, residual=residual, sums=sums)

    def odds(case: Case, blocks: np.ndarray) -> list[float]:
        tried = _Tried.of(case, blocks, steps.rows)
        logs = [tried.log(steps.beside[0], chosen) for chosen in steps.sets]
        return [one - logs[0] for one in logs]

    assert odds(other, seen) == pytest.approx(odds(case, seen), abs=1e-3)
    every = np.ones_like(seen)
    assert odds(other, every) != pytest.approx(odds(case, every), abs=1.0)


def test_steps_divide_rows_only_where_there_are_rows_on_both_sides(random: np.random.Generator) -> None:
    """Before a step, it makes no difference whether a fold keeps it."""
    table, steps = prepared(log(random, slope=0.0, bump=0.006))
    at = int(np.searchsorted(table.row, steps.rows[0]))
    blocks = steps.case.folds.blocks
    every = np.ones(int(blocks.max()) + 1, dtype=bool)
    before = np.array([(blocks[at:] != block).all() for block in range(len(every))])
    undivided = replace(table, groups=0 * table.groups)
    assert before.any()
    assert steps.same(table, undivided, before)
    assert not steps.same(table, undivided, every)
