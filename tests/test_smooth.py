"""A correction without a known cause: saved, applied inside of its ranges only, and told where it is not."""

import json
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

import echocal
from echocal.correct import correct_table
from echocal.errors import DataError, ModelError
from echocal.model import Shape, Smooth


def shape(against: str, low: float = 0.0, high: float = 20.0) -> Shape:
    at = tuple(np.linspace(low, high, 5).tolist())
    return Shape(against, at, (0.0, 1e-3, 3e-3, 2e-3, -1e-3), (1e-4,) * 5)


SMOOTH = Smooth(5e-4, (shape("temperature"), shape("fan", 0.0, 4.0)))


def test_terms_add_up_inside_and_add_nothing_outside() -> None:
    given = {"temperature": np.array([5.0, 5.0, 25.0, 5.0]), "fan": np.array([1.0, 9.0, 1.0, np.nan])}
    np.testing.assert_allclose(SMOOTH.of(given), [2.5e-3, 0.0, 0.0, 0.0])
    assert SMOOTH.outside(given).tolist() == [False, True, True, True]
    place, names = SMOOTH.which_outside(given)
    assert [names[p] if p >= 0 else "" for p in place] == ["", "fan", "temperature", "fan"]


@pytest.mark.parametrize("against", ["temperature", "distance", "fan"])
def test_correct_undoes_indicate(against: str, random: np.random.Generator) -> None:
    effects = {"zero_error": {"offset": 2e-3}}
    model = echocal.Model("linear", effects, shape=Smooth(1e-3, (shape(against, 0.5, 20.0),)))
    distance = random.uniform(0.6, 15.0, 50)  # inside of the range by more than the shift
    given = {"temperature": random.uniform(-10.0, 40.0, 50)}
    given |= {"fan": random.uniform(-5.0, 30.0, 50)} if against == "fan" else {}
    again = model.correct(model.indicate(distance, **given), **given)
    np.testing.assert_allclose(again, distance, atol=1e-9)


@pytest.mark.parametrize("against", ["temperature", "distance"])
def test_outside_it_is_the_model_without_it(against: str) -> None:
    model = echocal.Model("linear", shape=Smooth(1e-3, (shape(against, 1.0, 20.0),)))
    reading, celsius = np.array([0.5, 25.0]), np.array([-5.0, 30.0])
    bare = model.without_shape().correct(reading, temperature=celsius)
    np.testing.assert_array_equal(model.correct(reading, temperature=celsius), bare)


def test_a_file_keeps_it_and_its_hash(tmp_path: Path) -> None:
    model = echocal.Model("linear", shape=SMOOTH)
    model.save(tmp_path / "model.json")
    read = echocal.Model.load(tmp_path / "model.json")
    assert read.shape == SMOOTH
    assert read.hash == model.hash != echocal.Model("linear").hash
    text = (tmp_path / "model.json").read_text()
    both = json.loads(text) | {"shape": shape("fan").to_dict(), "hash": None}
    (tmp_path / "both.json").write_text(json.dumps(both))
    with pytest.raises(ModelError, match="a model has one of them at most"):
        echocal.Model.load(tmp_path / "both.json")


@pytest.mark.parametrize(
    ("offset", "terms"), [(0.0, ()), (np.nan, (shape("fan"),)), (0.0, (shape("fan"), shape("fan")))]
)
def test_what_is_no_correction_is_refused(offset: float, terms: tuple[Shape, ...]) -> None:
    with pytest.raises(ModelError, match="one term for each of its columns"):
        Smooth(offset, terms)


def test_its_columns_must_be_recorded_even_if_the_model_assumes_a_value() -> None:
    smooth = Smooth(0.0, (shape("relative_humidity", 0.0, 1.0),))
    model = echocal.Model("linear", air={"relative_humidity": 0.5}, shape=smooth)
    with pytest.raises(DataError, match="relative_humidity is not given"):
        model.correct(1.0, temperature=20.0)


def test_no_firmware_can_contain_it() -> None:
    with pytest.raises(ModelError, match="a smooth correction against temperature, fan"):
        echocal.firmware.generate(echocal.Model("linear", shape=SMOOTH))


def test_rows_outside_have_the_distance_of_the_model_and_a_reason() -> None:
    model = echocal.Model("linear", shape=SMOOTH)
    table = pd.DataFrame(
        {
            "reading_m": [1.0, 1.0, 1.0, np.nan],
            "temperature_C": [5.0, 5.0, 25.0, 5.0],
            "fan": [1.0, 9.0, 1.0, 1.0],
        }
    )
    done = correct_table(table, model)
    assert done.table["corrected_distance_m"].tolist()[:3] == pytest.approx([1.0 - 2.5e-3, 1.0, 1.0])
    assert done.table["unusable"].tolist() == [
        "",
        "fan outside of the smooth correction",
        "temperature_C outside of the smooth correction",
        "reading_m missing",
    ]
    assert done.unusable == {"reading_m missing": 1}
    assert sum(done.marked.values()) == 2
    assert any("without its smooth correction" in note for note in done.notes)


def test_a_verification_says_which_rows_it_did_not_hold_for() -> None:
    table = {
        "reading_m": [1.0025, 1.0],
        "distance_m": [1.0, 1.0],
        "temperature_C": [5.0, 5.0],
        "fan": [1.0, 9.0],
    }
    observations = echocal.read_observations(table)
    model = echocal.Model("linear", shape=SMOOTH)
    found = echocal.verify(observations, maximum_permissible_error=1e-4, model=model)
    assert found.passed
    assert found.outside_smooth == {"fan outside of the smooth correction": 1}


def test_a_column_that_varies_in_one_fifth_of_the_rows_alone_is_no_traceback(
    random: np.random.Generator,
) -> None:
    """Rain of one night: in four of five folds the column is constant but for rounding."""
    rows = 600
    hours = np.arange(rows) / 6.0
    celsius = 12 + 5 * np.sin(2 * np.pi * hours / 24)
    for night in range(5):
        rain = np.where(np.arange(rows) // (rows // 5) == night, random.exponential(0.3, rows), 0.0)
        reading = 2.0 + 3e-3 * np.sin(2 * np.pi * hours / 24) ** 2 + random.normal(0.0, 5e-4, rows)
        table = {"reading_m": reading, "temperature_C": celsius, "rain": rain, "time_s": 3600.0 * hours}
        assert echocal.diagnose(pd.DataFrame(table), constant_distance=True).verdict


def test_a_correction_states_its_own_uncertainty_where_it_acts() -> None:
    inside, outside = (echocal.model.ResidualUncertainty(size) for size in (1e-3, 4e-3))
    smooth = Smooth(0.0, (shape("temperature"),), inside)
    model = echocal.Model("linear", shape=smooth, residual_uncertainty=outside)
    stated = model.standard_uncertainty([1.0, 1.0], temperature=[10.0, 30.0])
    np.testing.assert_allclose(stated, [np.hypot(1e-3, 1e-4), 4e-3], rtol=1e-3)
