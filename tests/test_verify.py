import warnings

import pytest

import echocal

TABLE = {
    "reading_mm": [1998.0, 2004.0, 1000.5, 1990.0],
    "distance_mm": [2000.0, 2000.0, 1000.0, None],
    "temperature_C": [20.0, 20.0, 20.0, 20.0],
}


def observations() -> echocal.Observations:
    with warnings.catch_warnings(action="ignore"):
        return echocal.read_observations(TABLE)


@pytest.mark.parametrize(
    ("bound", "passed", "exceeding"), [(3.9e-3, False, 1), (4.1e-3, True, 0), (1e-4, False, 3)]
)
def test_rows_against_the_bound(bound: float, passed: bool, exceeding: int) -> None:
    result = echocal.verify(observations(), maximum_permissible_error=bound)
    assert (result.passed, result.exceeding, result.count) == (passed, exceeding, 3)
    assert result.maximum_error == pytest.approx(4e-3)
    assert result.mean_error == pytest.approx((-2e-3 + 4e-3 + 0.5e-3) / 3)
    assert result.worst == {"row": 2}
    assert result.unusable == {"distance_mm missing": 1}


def test_rows_corrected_by_a_model() -> None:
    offset = echocal.Model("linear", {"zero_error": {"offset": 1e-3}})
    data = echocal.read_observations({name: values[:2] for name, values in TABLE.items()})
    before = echocal.verify(data, maximum_permissible_error=3.5e-3)
    after = echocal.verify(data, maximum_permissible_error=3.5e-3, model=offset)
    assert not before.passed
    assert after.passed
    assert after.maximum_error == pytest.approx(before.maximum_error - 1e-3, abs=1e-12)


def test_a_simulated_device_over_a_grid() -> None:
    device = echocal.Model("linear", {"fixed_speed": {"weight": 1.0, "speed": 343.0}})
    result = echocal.verify_model(
        device,
        maximum_permissible_error=0.05,
        temperature=(0, 50, 2),
        distance=[1.0, 2.0],
        relative_humidity=0.5,
    )
    assert result.count == 52
    assert result.worst == {"temperature": 50.0, "distance": 2.0, "relative_humidity": 0.5}
    assert result.maximum_error == pytest.approx(2.0 * (343.0 / (331.4 + 0.6 * 50.0) - 1.0), rel=1e-12)
    assert not result.passed


def test_a_base_simulation_has_no_error() -> None:
    result = echocal.verify_model(
        echocal.Model("cramer"), maximum_permissible_error=1e-9, temperature=20.0, distance=2.0
    )
    assert result.passed
    assert result.count == 1


def test_what_cannot_be_verified() -> None:
    with pytest.raises(echocal.DataError, match="verification needs a column for reference distance"):
        echocal.verify(echocal.read_observations({"echo_us": [11660.0]}), maximum_permissible_error=1e-3)
    with pytest.raises(echocal.UsageError, match="must be a positive length"):
        echocal.verify(observations(), maximum_permissible_error=0.0)


def test_an_uncertainty_that_adds_nothing_is_noted() -> None:
    found = echocal.verify(observations(), maximum_permissible_error=5e-3, uncertainties={"law": "published"})
    assert found.notes == (
        "the stated uncertainty of the speed of sound adds nothing to that of an error: "
        "what was examined does not read it",
    )
    corrected = echocal.verify(
        observations(),
        maximum_permissible_error=5e-3,
        model=echocal.Model("cramer"),
        uncertainties={"law": "published"},
    )
    assert corrected.notes == ()
    assert corrected.guard_band > 0.0
