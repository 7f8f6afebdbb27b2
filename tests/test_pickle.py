"""Models and diagnoses travel to other processes and are copied."""

import copy
import pickle
from collections.abc import Callable
from concurrent.futures import ProcessPoolExecutor
from importlib.metadata import version
from multiprocessing import get_context
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import echocal
from echocal.model import Shape

TEMPERATURE = np.linspace(-10.0, 40.0, 101)
SHAPE = Shape("temperature", (0.0, 20.0), (0.0, 2e-3), (1e-4, 1e-4))
MODELS = {
    "law": echocal.Model("cramer", air={"relative_humidity": 0.4}),
    "expression": echocal.Model("331.30000000000013+0.60612345678901234*T"),
    "effects": echocal.Model(
        "linear",
        {"fixed_delay": {"delay": 3.3e-5}, "zero_error": {"offset": 1.7e-3}},
        covariance=[[1e-12, 1e-10], [1e-10, 1e-6]],
        provenance={"rows": 12},
    ),
    "shape": echocal.Model("linear", {"fixed_delay": {"delay": 3e-5}}, shape=SHAPE),
}
WAYS: dict[str, Callable[[Any], Any]] = {
    "pickle": lambda thing: pickle.loads(pickle.dumps(thing)),
    "copy": copy.copy,
    "deepcopy": copy.deepcopy,
}


def table(seed: int) -> dict[str, Any]:
    noise = np.random.default_rng(seed).normal(0.0, 1e-3, 60)
    temperature = np.linspace(0.0, 40.0, 60)
    return {"reading_m": 1.5 * 343.0 / (331.4 + 0.6 * temperature) + noise, "temperature_C": temperature}


def diagnosed(seed: int) -> echocal.Diagnosis:
    return echocal.diagnose(table(seed), reference_distance=1.5)


@pytest.mark.parametrize("way", WAYS.values(), ids=WAYS.keys())
@pytest.mark.parametrize("model", MODELS.values(), ids=MODELS.keys())
def test_a_model_is_the_same_bit_for_bit(model: echocal.Model, way: Callable[[Any], Any]) -> None:
    other = way(model)
    assert other is not model
    assert (other.hash, other.provenance) == (model.hash, model.provenance)
    again = other.correct(1.5, temperature=TEMPERATURE)
    np.testing.assert_array_equal(again, model.correct(1.5, temperature=TEMPERATURE))


@pytest.mark.parametrize("model", MODELS.values(), ids=MODELS.keys())
def test_equal_models_are_equal(model: echocal.Model) -> None:
    other = copy.deepcopy(model).with_provenance({"from": "elsewhere"})
    assert other == model
    assert len({other, model}) == 1
    assert all((model == another) is (model is another) for another in MODELS.values())
    assert model != model.law


def test_a_model_cannot_be_edited() -> None:
    model = MODELS["effects"]
    with pytest.raises(echocal.ModelError, match="a model does not change; build another one"):
        model.effects["fixed_delay"]["delay"] = 0.0  # type: ignore[index]
    with pytest.raises(echocal.ModelError, match="'law' cannot be set"):
        model.law = "cramer"  # type: ignore[misc]
    with pytest.raises(ValueError, match="read-only"):
        model.covariance[0, 0] = 1.0  # type: ignore[index]
    own = dict(model.effects["fixed_delay"])
    own["delay"] = 1e-5
    assert echocal.Model(model.law, {"fixed_delay": own}) != model


@pytest.mark.parametrize("way", WAYS.values(), ids=WAYS.keys())
def test_a_diagnosis_is_the_same(way: Callable[[Any], Any]) -> None:
    diagnosis = diagnosed(1)
    other = way(diagnosis)
    assert (other.to_dict(), other.explain()) == (diagnosis.to_dict(), diagnosis.explain())
    assert other.predict(1.5, temperature=20.0) == diagnosis.predict(1.5, temperature=20.0)


@pytest.mark.slow
def test_a_pool_of_processes_diagnoses() -> None:
    with ProcessPoolExecutor(2, mp_context=get_context("spawn")) as pool:
        found = list(pool.map(diagnosed, (1, 2)))
    for seed, diagnosis in zip((1, 2), found, strict=True):
        here = diagnosed(seed).to_dict()
        assert {**diagnosis.to_dict(), "seconds": 0} == {**here, "seconds": 0}


def test_a_calibration_and_its_rows_travel() -> None:
    observations = echocal.read_observations({**table(1), "distance_m": np.full(60, 1.5)})
    found = echocal.calibrate(observations, echocal.Model("linear"), fit=["zero_error"])
    other = pickle.loads(pickle.dumps(found))
    assert other.to_dict() == found.to_dict()


def test_the_version_is_that_of_the_package() -> None:
    manifest = (Path(__file__).parents[1] / "Cargo.toml").read_text()
    assert f'version = "{echocal.__version__}"' in manifest
    assert version("echocal") == echocal.__version__
