"""What nobody explains, as a term of a model."""

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

import echocal
from echocal.errors import ModelError, UsageError
from echocal.model import Shape

SHAPE = Shape("temperature", (0.0, 20.0, 40.0), (0.0, 4e-3, 1e-3), (2e-4, 1e-4, 2e-4))


def bump(celsius: np.ndarray) -> np.ndarray:
    return 8e-3 * np.exp(-(((celsius - 22.0) / 5.0) ** 2))


@pytest.fixture(scope="module")
def table(request: pytest.FixtureRequest, seeded: Callable[..., np.random.Generator]) -> pd.DataFrame:
    random = seeded(request)
    celsius, distance = random.uniform(0, 40, 600), random.choice([0.5, 1.0, 2.0], 600)
    reading = distance + bump(celsius) + random.normal(0, 5e-4, 600)
    return pd.DataFrame({"reading_m": reading, "temperature_C": celsius, "distance_m": distance})


@pytest.fixture(scope="module")
def diagnosis(table: pd.DataFrame) -> echocal.Diagnosis:
    return echocal.diagnose(table)


def test_the_shape_is_what_is_left_within_its_band(diagnosis: echocal.Diagnosis) -> None:
    found = diagnosis.unexplained
    assert found is not None
    assert found.against == "temperature"
    assert found.shape is not None
    at = np.array(found.shape.at)
    planted = bump(at) - np.mean(bump(at))
    left = found.shape.of(at) - np.mean(found.shape.of(at))
    assert np.abs(left - planted).max() < 2.5e-3  # what a polynomial of degree 7 makes of it
    assert 1e3 * found.rms_m == pytest.approx(1e3 * np.std(bump(at)), abs=0.5)
    assert f"{1e3 * found.rms_m:.1f} mm" in found.description


def test_the_mean_of_a_shape_is_the_shapes_and_no_cause_is_named_for_it(
    diagnosis: echocal.Diagnosis,
) -> None:
    assert diagnosis.verdict == "unknown"
    assert not [cause for cause in diagnosis.causes if cause.probability >= 0.9]


def test_a_model_with_the_shape_corrects_better(diagnosis: echocal.Diagnosis, table: pd.DataFrame) -> None:
    def rms(model: echocal.Model) -> float:
        corrected = model.correct(
            table["reading_m"].to_numpy(), temperature=table["temperature_C"].to_numpy()
        )
        return float(np.sqrt(np.mean((corrected - table["distance_m"]) ** 2)))

    assert rms(diagnosis.model_with_shape) < 0.6 * rms(diagnosis.model)


@pytest.mark.parametrize("against", ["temperature", "distance", "my column"])
def test_correct_undoes_indicate(against: str) -> None:
    model = echocal.Model("linear", {"zero_error": {"offset": 2e-3}}, shape=Shape(against, *_curve()))
    given = {"temperature": 17.0} | ({"my column": 12.0} if against == "my column" else {})
    assert model.correct(model.indicate(1.3, **given), **given) == pytest.approx(1.3, abs=1e-9)


def _curve() -> tuple[tuple[float, ...], ...]:
    return (0.0, 1.0, 20.0), (0.0, 4e-3, 1e-3), (1e-4, 1e-4, 1e-4)


def test_it_is_held_flat_outside_what_was_seen() -> None:
    assert SHAPE.of([-30.0, 90.0]).tolist() == [0.0, 1e-3]


def test_a_file_keeps_it_and_its_hash(tmp_path: Path) -> None:
    model = echocal.Model("linear", shape=SHAPE)
    model.save(tmp_path / "model.json")
    read = echocal.Model.load(tmp_path / "model.json")
    assert read.shape == SHAPE
    assert read.hash == model.hash != echocal.Model("linear").hash
    assert read.without_shape().hash == echocal.Model("linear").hash


def test_correcting_a_table_uses_a_further_column() -> None:
    from echocal.correct import correct_table

    shape = Shape("fan", (0.0, 10.0), (0.0, 10e-3), (0.0, 0.0))
    table = pd.DataFrame({"reading_m": [1.0, 1.005], "temperature_C": [20.0, 20.0], "fan": [0.0, 5.0]})
    corrected = correct_table(table, echocal.Model("linear", shape=shape)).table["corrected_distance_m"]
    assert corrected.tolist() == pytest.approx([1.0, 1.0], abs=1e-6)


def test_nobody_leaves_it_out_in_silence() -> None:
    model = echocal.Model("linear", shape=SHAPE)
    table = {
        "reading_m": np.full(20, 1.0),
        "temperature_C": np.full(20, 20.0),
        "distance_m": np.full(20, 1.0),
    }
    for use in (
        lambda: echocal.firmware.generate(model),
        lambda: echocal.diagnose(table, base=model),
        lambda: echocal.calibrate(echocal.read_observations(table), model, fit=["zero_error.offset"]),
        lambda: model.distance(6e-3, temperature=20.0),
        lambda: model.time_of_flight(1.0, temperature=20.0),
    ):
        with pytest.raises(ModelError, match="unexplained term"):
            use()


def test_a_column_that_is_not_given_is_asked_for() -> None:
    model = echocal.Model("linear", shape=Shape("radiation", (0.0, 900.0), (0.0, 1e-3), (0.0, 0.0)))
    with pytest.raises(echocal.DataError, match="radiation is not given"):
        model.correct(1.0, temperature=20.0)


def test_where_nothing_is_left_there_is_no_shape() -> None:
    reading = 1.0 + 1e-3 * np.sin(np.arange(100.0) ** 2)
    warmth = 20.0 + 20.0 * np.sin(2.4 * np.arange(100.0))
    table = {"reading_m": reading, "temperature_C": warmth, "distance_m": np.ones(100)}
    with pytest.raises(UsageError, match="no unexplained term"):
        _ = echocal.diagnose(table).model_with_shape
