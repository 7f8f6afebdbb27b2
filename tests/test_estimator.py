"""`EchoCorrector`: an estimator as scikit-learn has them."""

import pickle
from typing import Any

import numpy as np
import pandas as pd
import pytest

import echocal

pytest.importorskip("sklearn")

from sklearn.base import clone
from sklearn.model_selection import cross_val_score
from sklearn.pipeline import make_pipeline
from sklearn.preprocessing import FunctionTransformer
from sklearn.utils.estimator_checks import parametrize_with_checks

from echocal import EchoCorrector

DEVICE = echocal.Model("cramer", {"zero_error": {"offset": 8e-3}, "fixed_delay": {"delay": 30e-6}})
FIT = ["zero_error", "fixed_delay"]
EXPECTED = {
    "check_positive_only_tag_during_fit": "a temperature may be below 0; an echo time below 0 is a row "
    "without a distance, and no error"
}


@parametrize_with_checks(
    [EchoCorrector(parameters=["zero_error"])], expected_failed_checks=lambda _: EXPECTED
)
def test_the_conventions_of_scikit_learn(estimator: Any, check: Any) -> None:
    check(estimator)


@pytest.mark.slow
@parametrize_with_checks([EchoCorrector()], expected_failed_checks=lambda _: EXPECTED)
def test_the_conventions_with_a_diagnosis(estimator: Any, check: Any) -> None:
    check(estimator)


@pytest.fixture
def echoes(random: np.random.Generator) -> tuple[pd.DataFrame, np.ndarray]:
    distance, celsius = np.tile([0.5, 1.0, 2.0, 3.0], 30), random.uniform(-10.0, 35.0, 120)
    echo = DEVICE.time_of_flight(distance, temperature=celsius, relative_humidity=0.4)
    echo = echo + random.normal(0.0, 5e-7, 120)
    table = {"echo_us": 1e6 * echo, "temperature_C": celsius, "humidity_percent": np.full(120, 40.0)}
    return pd.DataFrame(table), distance


@pytest.mark.parametrize("parameters", [FIT, None])
def test_it_learns_what_the_sensor_gets_wrong(
    parameters: list[str] | None, echoes: tuple[pd.DataFrame, np.ndarray]
) -> None:
    table, distance = echoes
    corrector = EchoCorrector(parameters=parameters).fit(table, distance)
    assert np.abs(corrector.predict(table) - distance).max() < 1e-3
    assert corrector.score(table, distance) > 0.9999
    assert corrector.get_feature_names_out().tolist() == ["corrected_distance_m"]
    expected = echocal.correct(table, corrector.model_).table["corrected_distance_m"]
    np.testing.assert_array_equal(corrector.transform(table)[:, 0], expected)


def test_names_and_units_of_a_table_are_read_and_an_array_has_an_order(
    echoes: tuple[pd.DataFrame, np.ndarray],
) -> None:
    table, distance = echoes
    other = pd.DataFrame(
        {"Temp (K)": table["temperature_C"] + 273.15, "RH": 40.0, "echo_ms": table["echo_us"] / 1e3}
    )
    named = EchoCorrector(parameters=FIT, columns={"RH": "humidity_percent"}).fit(other, distance)
    by_order = EchoCorrector(parameters=FIT).fit(table.to_numpy(), distance)
    np.testing.assert_allclose(named.predict(other), by_order.predict(table.to_numpy()), atol=1e-9)
    more = np.column_stack([table.to_numpy(), np.arange(120.0)])
    np.testing.assert_array_equal(
        EchoCorrector(parameters=FIT).fit(more, distance).predict(more), by_order.predict(table.to_numpy())
    )
    with pytest.raises(echocal.DataError, match="no column holds an echo time"):
        EchoCorrector().fit(table.rename(columns={"echo_us": "a"}), distance)
    with pytest.raises(echocal.DataError, match="temperature_C"):
        EchoCorrector(parameters=FIT).fit(
            table.assign(temperature_C=table["temperature_C"] + 273.15), distance
        )
    with pytest.raises(echocal.DataError, match="y is the reference distance"):
        EchoCorrector().fit(table.assign(distance_m=1.0), distance)


def test_a_row_with_nan_stays_a_row(echoes: tuple[pd.DataFrame, np.ndarray]) -> None:
    table, distance = echoes
    table.loc[3, "temperature_C"] = np.nan
    with pytest.warns(echocal.DataWarning, match="temperature_C missing"):
        corrector = EchoCorrector(parameters=FIT).fit(table, distance)
    assert np.flatnonzero(np.isnan(corrector.predict(table))).tolist() == [3]


def test_it_goes_through_a_pipeline_a_clone_and_a_pickle(echoes: tuple[pd.DataFrame, np.ndarray]) -> None:
    table, distance = echoes
    seconds = table.assign(echo_us=table["echo_us"] / 1e6)
    scaled = FunctionTransformer(lambda t: t.assign(echo_us=1e6 * t["echo_us"]))
    pipeline = make_pipeline(scaled, EchoCorrector(parameters=FIT))
    assert cross_val_score(pipeline, seconds, distance, cv=3).min() > 0.9999
    corrector = pipeline[-1].set_output(transform="pandas").fit(table, distance)
    again = pickle.loads(pickle.dumps(corrector))
    pd.testing.assert_frame_equal(again.transform(table), corrector.transform(table))
    assert list(corrector.transform(table)) == ["corrected_distance_m"]
    assert not hasattr(clone(corrector), "model_")


def test_a_fault_that_only_the_fit_repaired_is_told(echoes: tuple[pd.DataFrame, np.ndarray]) -> None:
    table, distance = echoes
    table = table.rename(columns={"temperature_C": "temperature_F"})  # the values stay in degC
    corrector = EchoCorrector().fit(table, distance)
    with pytest.warns(echocal.DataWarning, match="not checked: fahrenheit_celsius"):
        corrector.predict(table)
