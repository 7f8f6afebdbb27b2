import numpy as np
import pytest

import echocal


def read(**columns: object) -> dict[str, np.ndarray]:
    return dict(
        echocal.read_observations({"echo_us": np.full(len(columns["time_s"]), 11660.0), **columns}).conditions
    )


def test_a_rate_is_that_of_a_ramp_and_zero_at_the_first_row() -> None:
    seconds = np.cumsum(np.random.default_rng().uniform(1.0, 300.0, 50)) - 1.0
    found = read(time_s=seconds, temperature_C=20 + 1e-3 * (seconds - seconds[0]))["temperature_rate"]
    assert found[0] == 0.0
    late = seconds - seconds[0] > 30.0
    np.testing.assert_allclose(found[late], 1e-3, rtol=1e-9)


def test_a_rate_looks_back_and_not_ahead() -> None:
    seconds = 60.0 * np.arange(6)
    found = read(time_s=seconds, temperature_C=np.array([20.0, 20.0, 20.0, 26.0, 26.0, 26.0]))
    np.testing.assert_allclose(found["temperature_rate"], [0, 0, 0, 0.1, 0, 0], atol=1e-15)


def test_later_temperatures_stand_further_down_and_the_last_stays() -> None:
    found = read(time_s=np.arange(8.0), temperature_C=np.arange(20.0, 28.0))
    assert found["temperature_later_1"].tolist() == [21.0, 22.0, 23.0, 24.0, 25.0, 26.0, 27.0, 27.0]
    assert found["temperature_later_5"].tolist() == [25.0, 26.0, 27.0, 27.0, 27.0, 27.0, 27.0, 27.0]


@pytest.mark.parametrize(
    "labels",
    [
        {"group": [1, 1, 1, 2, 2]},
        {"order": [1, 2, 3, 1, 2]},
        {"group": list("aaabb"), "order": [0, 1, 2, 0, 1]},
    ],
)
def test_positions_in_bursts_count_from_the_first(labels: dict[str, list[object]]) -> None:
    found = read(time_s=np.arange(5.0), temperature_C=np.full(5, 20.0), **labels)
    assert found["position_in_group"].tolist() == [0.0, 1.0, 2.0, 0.0, 1.0]


def test_nothing_is_derived_without_a_time() -> None:
    data = echocal.read_observations({"echo_us": [11660.0, 11670.0], "temperature_C": [20.0, 21.0]})
    assert list(data.conditions) == ["temperature"]
