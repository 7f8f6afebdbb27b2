import numpy as np
import pytest

import echocal


def read(**columns: object) -> dict[str, np.ndarray]:
    return dict(
        echocal.read_observations({"echo_us": np.full(len(columns["time_s"]), 11660.0), **columns}).conditions
    )


def test_a_rate_is_that_of_a_ramp_in_every_row(random: np.random.Generator) -> None:
    seconds = np.cumsum(random.uniform(1.0, 300.0, 50)) - 1.0
    found = read(time_s=seconds, temperature_C=20 + 1e-3 * (seconds - seconds[0]))["temperature_rate"]
    np.testing.assert_allclose(found, 1e-3, rtol=1e-9)


def test_a_rate_looks_as_far_back_as_ahead() -> None:
    seconds = 60.0 * np.arange(6)
    found = read(time_s=seconds, temperature_C=np.array([20.0, 20.0, 20.0, 26.0, 26.0, 26.0]))
    np.testing.assert_allclose(found["temperature_rate"], [0, 0, 0.05, 0.05, 0, 0], atol=1e-15)


def test_a_thermometer_that_lags_is_undone_between_the_ends() -> None:
    seconds, constant, period = 20.0 * np.arange(400), 150.0, 4000.0
    turn = 2 * np.pi / period
    gain, behind = 1 / np.hypot(1, turn * constant), np.arctan(turn * constant)
    recorded = 20 + 10 * gain * np.sin(turn * seconds - behind)
    rate = read(time_s=seconds, temperature_C=recorded)["temperature_rate"]
    air = recorded + constant * rate
    np.testing.assert_allclose(air[1:-1], (20 + 10 * np.sin(turn * seconds))[1:-1], atol=5e-3)


def test_a_single_row_changes_at_no_rate() -> None:
    assert read(time_s=[0.0], temperature_C=[20.0])["temperature_rate"].tolist() == [0.0]


def test_later_temperatures_stand_further_down_and_go_on_as_the_last_rows_do() -> None:
    found = read(time_s=np.arange(8.0), temperature_C=np.arange(20.0, 28.0))
    np.testing.assert_allclose(found["temperature_later_1"], np.arange(21.0, 29.0))
    np.testing.assert_allclose(found["temperature_later_5"], np.arange(25.0, 33.0))
    still = read(time_s=np.arange(3.0), temperature_C=np.full(3, 20.0))["temperature_later_5"]
    np.testing.assert_allclose(still, 20.0)


def test_later_temperatures_are_later_in_time_whatever_the_order_of_the_rows(
    random: np.random.Generator,
) -> None:
    seconds, celsius = np.arange(12.0), random.normal(20.0, 3.0, 12)
    shuffled = random.permutation(12)
    found = read(time_s=seconds, temperature_C=celsius)
    mixed = read(time_s=seconds[shuffled], temperature_C=celsius[shuffled])
    for rows in range(1, 6):
        np.testing.assert_array_equal(
            mixed[f"temperature_later_{rows}"], found[f"temperature_later_{rows}"][shuffled]
        )


@pytest.mark.statistical
def test_a_thermometer_some_rows_late_is_named_with_the_newest_row_first(random: np.random.Generator) -> None:
    seconds = 60.0 * np.arange(600)
    air = 15 + 8 * np.sin(seconds / 8e3) + 2 * np.sin(seconds / 1.1e3)
    recorded = air[np.maximum(np.arange(600) - 3, 0)] + random.normal(0.0, 0.05, 600)
    distance = random.choice([0.8, 1.6, 2.4], 600)
    reading = distance * (331.4 + 0.6 * recorded) / (331.4 + 0.6 * air) + random.normal(0.0, 2e-4, 600)
    log = {"time_s": seconds, "reading_m": reading, "temperature_C": recorded, "distance_m": distance}
    (cause,) = echocal.diagnose({name: column[::-1].copy() for name, column in log.items()}).causes[:1]
    assert (cause.id, cause.probability) == ("temperature_timestamp_shift", pytest.approx(1.0, abs=0.01))


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
