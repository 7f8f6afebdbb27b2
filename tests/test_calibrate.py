"""Calibration on planted truths: estimates, uncertainties, what cannot be identified."""

from pathlib import Path

import numpy as np
import pytest

from echocal import DataError, Model, ModelError, Regression, UsageError, calibrate
from echocal.calibrate import Calibration
from echocal.observations import Observations


def observations(
    distance: np.ndarray, temperature: np.ndarray, effects: dict, noise: np.ndarray, law: str = "linear"
) -> Observations:
    """What a device with these effects and this noise [m] indicates, recorded as echo times."""
    per_meter = Model(law).time_of_flight(1.0, temperature=temperature)
    reading = Model(law, effects).indicate(distance, temperature=temperature) + noise
    return Observations(
        reading * per_meter, {"temperature": temperature}, distance, np.full(len(distance), "")
    )


@pytest.fixture
def grid() -> tuple[np.ndarray, np.ndarray]:
    distance, temperature = np.meshgrid([0.3, 1.0, 2.0, 4.0], np.linspace(0.0, 50.0, 11))
    return distance.ravel(), temperature.ravel()


TRUTH = {"zero_error": {"offset": -4e-3}, "fixed_delay": {"delay": 31e-6}, "speed_slope": {"slope": 6e-3}}
FIT = ["zero_error.offset", "fixed_delay.delay", "speed_slope.slope"]


def test_recovers_what_was_planted(grid: tuple[np.ndarray, np.ndarray]) -> None:
    found = calibrate(observations(*grid, TRUTH, np.zeros(44)), Model("linear"), FIT)
    np.testing.assert_allclose(found.values, [-4e-3, 31e-6, 6e-3], rtol=1e-9)
    assert found.names == FIT
    assert found.model.effects["fixed_delay"]["delay"] == found["fixed_delay.delay"].value
    assert found.rms < 1e-14


def test_the_model_carries_its_uncertainties(grid: tuple[np.ndarray, np.ndarray], tmp_path: Path) -> None:
    noise = np.random.default_rng(2).normal(0.0, 1e-3, 44)
    held = Model("linear", {"clock_error": {"frequency_error": 1e-4}})
    found = calibrate(observations(*grid, TRUTH, noise), held, FIT)
    found.model.save(tmp_path / "model.json")
    loaded = Model.load(tmp_path / "model.json")
    for estimate in found:
        assert loaded.standard_uncertainties[estimate.name] == pytest.approx(estimate.standard_uncertainty)
    assert loaded.standard_uncertainties["clock_error.frequency_error"] == 0.0
    assert loaded.provenance["calibration"]["rows"]["used"] == 44
    order = [found.names.index(name) for name in loaded.parameter_names if name in found.names]
    places = [loaded.parameter_names.index(found.names[index]) for index in order]
    np.testing.assert_allclose(
        loaded.covariance[np.ix_(places, places)], found.covariance[np.ix_(order, order)]
    )


def test_fits_a_subset_beside_known_effects(grid: tuple[np.ndarray, np.ndarray]) -> None:
    known = {"zero_error": TRUTH["zero_error"]}
    found = calibrate(observations(*grid, TRUTH, np.zeros(44)), Model("linear", known), FIT[1:])
    np.testing.assert_allclose(found.values, [31e-6, 6e-3], rtol=1e-9)
    assert found.model.effects["zero_error"] == known["zero_error"]


@pytest.mark.slow
def test_uncertainties_cover_the_truth(grid: tuple[np.ndarray, np.ndarray]) -> None:
    """Over many noises the estimates scatter as their standard uncertainties say."""
    rng = np.random.default_rng(3)
    truth = np.array([-4e-3, 31e-6, 6e-3])
    scores, within = [], []
    for _ in range(200):
        data = observations(*grid, TRUTH, rng.normal(0.0, 1e-3, 44))
        found = calibrate(data, Model("linear"), FIT)
        scores.append((found.values - truth) / found.standard_uncertainties)
        intervals = found.interval(0.95).values()
        within.append([low <= value <= high for value, (low, high) in zip(truth, intervals, strict=True)])
    # 200 runs: the scatter of a scatter is 1/sqrt(400) = 5 %, of a share of 0.95 is 1.5 %
    np.testing.assert_allclose(np.std(scores, axis=0), 1.0, atol=0.15)
    np.testing.assert_allclose(np.mean(within, axis=0), 0.95, atol=0.05)


def test_prediction_agrees_with_monte_carlo(grid: tuple[np.ndarray, np.ndarray]) -> None:
    rng = np.random.default_rng(5)
    found = calibrate(observations(*grid, TRUTH, rng.normal(0.0, 1e-3, 44)), Model("linear"), FIT)
    distance, temperature = np.array([0.1, 2.0, 6.0]), np.array([-10.0, 20.0, 60.0])
    prediction = found.predict(distance=distance, temperature=temperature)
    draws = rng.multivariate_normal(found.values, found.covariance, 5000)
    at = {"distance": distance, "temperature": temperature}
    cloud = np.array([found.form.evaluate(draw, at)[0] for draw in draws])
    np.testing.assert_allclose(
        prediction.standard_uncertainty, cloud.std(axis=0), rtol=0.04
    )  # four sd of a scatter from 5000
    np.testing.assert_allclose(
        prediction.observation_standard_uncertainty**2 - prediction.standard_uncertainty**2,
        found.residual_standard_deviation**2,
    )


def test_law_coefficients_go_into_the_law(grid: tuple[np.ndarray, np.ndarray]) -> None:
    echo = Model("331.3+0.606*T").time_of_flight(grid[0], temperature=grid[1])
    data = Observations(echo, {"temperature": grid[1]}, grid[0], np.full(44, ""))
    found = calibrate(data, Model("linear"), ["law.intercept", "law.slope"])
    np.testing.assert_allclose(found.values, [331.3, 0.606], rtol=1e-12)
    np.testing.assert_allclose(found.model.time_of_flight(grid[0], temperature=grid[1]), echo, rtol=1e-12)
    assert calibrate(data, Model("linear"), ["law"]).names == ["law.intercept", "law.slope"]


@pytest.mark.parametrize("loss", ["soft_l1", "huber", "cauchy"])
def test_outliers_do_not_carry_the_robust_fit(grid: tuple[np.ndarray, np.ndarray], loss: str) -> None:
    noise = np.random.default_rng(11).normal(0.0, 1e-3, 44)
    noise[::9] += 0.1
    data = observations(*grid, TRUTH, noise)
    plain, robust = (calibrate(data, Model("linear"), FIT[:1], loss=name) for name in ("linear", loss))
    clean = calibrate(
        observations(*grid, TRUTH, np.where(noise > 0.05, 0.0, noise)), Model("linear"), FIT[:1]
    )
    assert abs(plain.values[0] - clean.values[0]) > 5e-3
    assert abs(robust.values[0] - clean.values[0]) < 3e-3
    assert robust.residual_standard_deviation < 0.3 * plain.residual_standard_deviation


@pytest.mark.slow
def test_robust_uncertainty_covers(grid: tuple[np.ndarray, np.ndarray]) -> None:
    """The sandwich holds where the noise has heavy tails."""
    rng = np.random.default_rng(13)
    scores = []
    for _ in range(200):
        data = observations(*grid, {"zero_error": {"offset": 2e-3}}, 1e-3 * rng.standard_t(2.5, 44))
        found = calibrate(data, Model("linear"), ["zero_error.offset"], loss="huber")
        scores.append((found.values[0] - 2e-3) / found.standard_uncertainties[0])
    assert np.std(scores) == pytest.approx(1.0, abs=0.15)


def test_known_uncertainty_is_taken_as_it_is(grid: tuple[np.ndarray, np.ndarray]) -> None:
    data = observations(*grid, TRUTH, np.zeros(44))
    found = calibrate(data, Model("linear"), ["zero_error.offset"], standard_uncertainty=2e-3)
    assert found["zero_error.offset"].standard_uncertainty == pytest.approx(2e-3 / np.sqrt(44))


def test_bounds_hold_and_are_reported(grid: tuple[np.ndarray, np.ndarray]) -> None:
    data = observations(*grid, TRUTH, np.zeros(44))
    found = calibrate(data, Model("linear"), FIT[:1], bounds={"zero_error.offset": (-1e-3, 1e-3)})
    assert found.at_bounds == []  # the delay, left out, holds the offset up
    found = calibrate(data, Model("linear"), FIT, bounds={"zero_error.offset": (-1e-3, 1e-3)})
    assert found["zero_error.offset"].value == pytest.approx(-1e-3)
    assert found.at_bounds == ["zero_error.offset"]


def test_rows_keep_their_places(grid: tuple[np.ndarray, np.ndarray]) -> None:
    data = observations(*grid, TRUTH, np.zeros(44))
    marked = np.full(44, "", dtype="<U20")
    marked[[0, 7]] = "distance missing"
    data.echo_time[0] = np.nan
    data = Observations(data.echo_time, data.conditions, data.reference_distance, marked)
    found = calibrate(data, Model("linear"), FIT)
    assert found.rows == {"total": 44, "used": 42, "unusable": {"distance missing": 2}}
    assert np.flatnonzero(np.isnan(found.residuals)).tolist() == [0, 7]
    assert found.degrees_of_freedom == 39


def test_regression_has_units_and_predicts() -> None:
    x = np.linspace(0.0, 50.0, 26)
    reading = 2.07 - 3.4e-3 * x + 6e-6 * x**2
    data = Observations(2.0 * reading / 343.0, {"temperature": x}, None, np.full(26, ""))
    found = calibrate(data, Regression.polynomial("temperature", 2, law="343"))
    np.testing.assert_allclose(found.values, [2.07, -3.4e-3, 6e-6], rtol=1e-9)
    assert [e.unit for e in found] == ["m", "m/degC", "m/degC^2"]
    assert found.predict(temperature=30.0).value == pytest.approx(2.07 - 0.102 + 5.4e-3)
    assert found.r_squared == pytest.approx(1.0)
    assert found.model.values == tuple(found.values)


def refuse(error: type[Exception], text: str, *arguments: object, **options: object) -> None:
    with pytest.raises(error, match=text):
        calibrate(*arguments, **options)  # type: ignore[arg-type]


def test_what_acts_alike_is_named() -> None:
    distance = np.full(9, 2.0)
    temperature = np.linspace(0.0, 40.0, 9)
    data = observations(distance, temperature, TRUTH, np.zeros(9), law="343")
    refuse(
        ModelError,
        r"zero_error.offset and fixed_delay.delay: on these rows they act alike",
        data,
        Model("343"),
        ["zero_error.offset", "fixed_delay.delay"],
    )
    alike = ["temperature_offset.offset", "speed_intercept.intercept", "fixed_delay.delay"]
    data = observations(distance, temperature, TRUTH, np.zeros(9))
    refuse(
        ModelError, "temperature_offset.offset and speed_intercept.intercept:", data, Model("linear"), alike
    )
    cold = Observations(data.echo_time, {"temperature": np.zeros(9)}, distance, data.unusable)
    refuse(ModelError, "speed_slope.slope: no influence", cold, Model("linear"), ["speed_slope"])


def test_mistakes_are_explained(grid: tuple[np.ndarray, np.ndarray]) -> None:
    data = observations(*grid, TRUTH, np.zeros(44))
    linear = Model("linear")
    refuse(
        UsageError,
        "unknown effect 'fixed_dely'; did you mean 'fixed_delay'",
        data,
        linear,
        ["fixed_dely.delay"],
    )
    refuse(UsageError, "fixed_delay has: fixed_delay.delay", data, linear, ["fixed_delay.dealy"])
    refuse(UsageError, "say what to fit", data, linear)
    refuse(UsageError, "say what to fit", data, linear, "zero_error")
    refuse(UsageError, "distinct", data, linear, ["zero_error", "zero_error.offset"])
    refuse(UsageError, "no coefficients to fit", data, Model("cramer"), ["law.slope"])
    refuse(UsageError, "unknown loss 'hubr'", data, linear, ["zero_error"], loss="hubr")
    refuse(UsageError, "fits all of its own", data, Regression(("1",)), ["1"])
    refuse(
        UsageError, "want low < high", data, linear, ["zero_error"], bounds={"zero_error.offset": (1.0, 0.0)}
    )
    refuse(UsageError, "44 of them", data, linear, ["zero_error"], standard_uncertainty=np.ones(3))
    refuse(DataError, "no column 'humidty'", data, Regression(("1", "humidty")))
    refuse(UsageError, "cannot read the term", data, Regression(("1", "distance^x")))
    refuse(UsageError, "already has speed_slope", data, Model("linear", {"speed_slope": {}}), ["law.slope"])
    bare = Observations(data.echo_time, data.conditions, None, data.unusable)
    refuse(DataError, "needs a reference distance", bare, linear, ["zero_error"])
    one = Observations(data.echo_time[:1], {"temperature": np.zeros(1)}, grid[0][:1], data.unusable[:1])
    refuse(DataError, "1 parameters need at least 2 usable rows; the data has 1", one, linear, ["zero_error"])
    data.echo_time[4] = np.nan
    refuse(DataError, "first at row 5", data, linear, ["zero_error"])


def test_json_holds_what_was_found(grid: tuple[np.ndarray, np.ndarray]) -> None:
    found: Calibration = calibrate(observations(*grid, TRUTH, np.zeros(44)), Model("linear"), FIT)
    entry = found.to_dict()
    assert entry["schema"] == "echocal.calibration/1"
    assert [p["name"] for p in entry["parameters"]] == FIT
    assert np.shape(entry["covariance"]) == (3, 3)
    np.testing.assert_allclose(np.diag(entry["correlation"]), 1.0)
