"""Rows that judge a model take no part in its choice and its fit; rows that belong together stay so."""

import numpy as np
import pytest

import echocal
from echocal.diagnose.preprocess.base import Base
from echocal.diagnose.preprocess.folds import Folds
from echocal.diagnose.preprocess.prepare import prepare
from echocal.diagnose.preprocess.table import Table
from echocal.diagnose.settings import Settings
from echocal.diagnose.validation.gain import measure
from echocal.model import Model

ROWS, SETTINGS = 60, Settings()
Mask = np.ndarray


def table(random: np.random.Generator, stands: int) -> Table:
    """Rows at so many known distances in turn; at one unknown distance if there are none."""
    known = {"distance_m": np.linspace(0.5, 3.0, stands)[np.arange(ROWS) % stands]} if stands else {}
    reading = known.get("distance_m", 1.5) + random.normal(0.0, 1e-3, ROWS)
    drawn = {"reading_m": reading, "temperature_C": random.uniform(10.0, 30.0, ROWS), **known}
    observations = echocal.read_observations(drawn, reading_speed="linear")
    return prepare(observations, Base.of("linear"), None, not stands, SETTINGS.rows)


@pytest.mark.parametrize("stands", [0, 6])
def test_no_row_is_judged_by_a_model_that_was_fitted_to_it(random: np.random.Generator, stands: int) -> None:
    """The model of a fold has a scale that says which blocks it was fitted to."""
    drawn = table(random, stands)
    folds = Folds.of(drawn, SETTINGS.rows)
    place = 2.0 ** np.arange(len(folds.fit))

    def fitted(blocks: Mask) -> Model:
        scale = 1e-3 * float(place[blocks].sum())
        return Model("linear", effects={"clock_error": {"frequency_error": scale}})

    found = measure(drawn, folds, fitted).error
    for block in range(len(folds.fit)):
        own = folds.blocks == block
        model = fitted(np.arange(len(folds.fit)) != block)
        corrected = model.correct(drawn.indication, temperature=drawn.conditions["temperature"])
        level = drawn.reference[own] if drawn.reference is not None else corrected[~own].mean()
        np.testing.assert_allclose(found[own], corrected[own] - level, atol=1e-12)


@pytest.mark.parametrize("stands", [0, 6])
def test_within_a_fold_its_rows_are_not_seen(random: np.random.Generator, stands: int) -> None:
    folds = Folds.of(table(random, stands), SETTINGS.rows)
    for held in folds.held:
        inner = folds.within(folds.fit & ~held)
        assert not (inner.fit & held).any()
        assert not any((fold & held).any() for fold in inner.held)
        assert len(inner.held) == len(folds.held) - 1


def test_rows_that_belong_together_are_held_out_together(random: np.random.Generator) -> None:
    at_stations = table(random, 6)
    blocks = Folds.of(at_stations, SETTINGS.rows).blocks
    assert all(len(np.unique(blocks[at_stations.groups == one])) == 1 for one in range(6))


def test_rows_at_one_level_are_held_out_in_runs(random: np.random.Generator) -> None:
    """In 400 of 400 tables drawn; where noise looks like a step, each level has runs of its own."""
    drawn = [Folds.of(table(random, 0), SETTINGS.rows).blocks.tolist() for _ in range(5)]
    assert drawn.count(np.repeat(np.arange(5), ROWS // 5).tolist()) >= 4


def test_each_unknown_level_takes_a_row(random: np.random.Generator) -> None:
    """Pairs of rows at unknown distances: half of the rows are spent on the levels."""
    told = []
    for _ in range(5):
        stand = np.repeat(np.arange(60), 2)
        reading = 1.0 + 0.02 * stand + random.normal(0.0, 1e-3, 120)
        celsius = random.uniform(10.0, 30.0, 120)
        drawn = {"reading_m": reading, "temperature_C": celsius, "stand": stand.astype(str)}
        told.append(echocal.diagnose(drawn, constant_distance=True).noise["standard_deviation_m"])
    assert np.median(told) == pytest.approx(1e-3, rel=0.15)  # 0.71e-3 without
