"""What the user states, beside what the table and the air say: contradictions are told with both sides."""

import warnings
from collections.abc import Callable
from typing import Any

import numpy as np
import pandas as pd
import pytest

import echocal
from echocal import DataError, DataWarning, DomainWarning, Model, ModelError, UsageError


def test_a_distance_that_the_table_denies_is_refused(random: np.random.Generator) -> None:
    table = {"reading_m": 2 + random.normal(0, 1e-3, 60), "temperature_C": np.linspace(5, 30, 60)}
    table["target_m"] = np.full(60, 2.0)
    columns = {"target_m": "distance_m"}
    said = "reference_distance says 1 m, and column 'target_m' says 2 m at row 1 .60 of 60 rows"
    with pytest.raises(UsageError, match=said):
        echocal.diagnose(table, columns=columns, reference_distance=1.0)
    assert echocal.diagnose(table, columns=columns, reference_distance=2.01).verdict
    with pytest.raises(UsageError, match=r"columns=\{'target_m': 'ignore'\}"):
        echocal.diagnose(table, columns=columns, reference_distance=1.0)
    assert echocal.diagnose(table, columns={"target_m": "ignore"}, reference_distance=1.9).verdict


def test_a_constancy_that_the_table_denies_is_doubted(random: np.random.Generator) -> None:
    table = {"reading_m": 2 + random.normal(0, 1e-3, 60), "temperature_C": np.linspace(5, 30, 60)}
    table |= {"distance_m": np.repeat([1.0, 2.0], 30), "stand": np.repeat(["a", "b"], 30)}
    with pytest.warns(DataWarning, match="says 1 m at row 1 and 2 m at row 31. The column is not used"):
        echocal.diagnose({name: table[name] for name in table if name != "stand"}, constant_distance=True)
    with warnings.catch_warnings():
        warnings.filterwarnings("error", "--constant-distance", DataWarning)
        echocal.diagnose(table, constant_distance=True)  # constant at each stand


@pytest.mark.parametrize(
    ("speed", "meant"),
    [
        (58, "58 us/cm, out and back, is 344.8 m/s"),
        (29.1, "29.1 us/cm, one way, is 343.6 m/s"),
        (34300, "34300 cm/s is 343.0 m/s"),
        (0.0343, "0.0343 cm/us is 343.0 m/s"),
        (0.343, "0.343 mm/us is 343.0 m/s"),
        (0.017, "0.017 cm/us of the whole path is 340.0 m/s"),
        (148, "148 us/inch, out and back, is 343.2 m/s"),
        (1235, "1235 km/h is 343.1 m/s"),
        (-343, "give a positive one"),
        (0, "give a positive one"),
        (5, "5 m/s; the speed of sound in air lies within 200 .. 600 m/s; say"),
    ],
)
def test_a_reading_speed_in_another_unit_is_refused_with_the_speed_it_means(speed: float, meant: str) -> None:
    table = {"reading_m": np.linspace(1, 2, 60), "distance_m": np.linspace(1, 2, 60)}
    with pytest.raises((UsageError, ModelError)) as refused:
        echocal.diagnose({**table, "temperature_C": np.full(60, 20.0)}, reading_speed=speed)
    assert meant in str(refused.value)


@pytest.mark.parametrize("each", [1, 2, 3])
def test_placements_of_few_rows_are_judged_or_refused(each: int, random: np.random.Generator) -> None:
    """A row alone at its level tells nothing of it; two rows of each placement do."""
    stand = np.arange(60) // each
    table = {"reading_m": 2 + random.normal(0, 1e-3, 60), "temperature_C": np.linspace(5, 30, 60)}
    table["stand"] = np.array([f"place {number}" for number in stand])
    if each == 1:
        with pytest.raises(DataError, match=r"60 usable rows have 60 of them.*column 'stand' changes"):
            echocal.diagnose(table, constant_distance=True)
    else:
        assert echocal.diagnose(table, constant_distance=True).verdict


@pytest.mark.parametrize(
    ("call", "said"),
    [
        (
            lambda: echocal.speed_of_sound(20, 50),
            "relative_humidity is 50, not 0 .. 1.05: it is",
        ),
        (lambda: echocal.speed_of_sound(500, 0.5), "temperature is 500, not -100 .. 200"),
        (lambda: echocal.speed_of_sound([20.0], [50.0]), "relative_humidity is 50"),
        (lambda: echocal.speed_of_sound(np.full(1000, 293.15), 0.5), "temperature is 293.15"),
        (lambda: echocal.distance(0.01, 20.0, 0.5, 1013.25), "1013 hPa is 101300"),
        (lambda: echocal.time_of_flight(1.0, 20.0, 0.5, 101325, 400), "400 ppm is 4e-4"),
        (lambda: echocal.error(1.0, np.array([20.0]), np.array([50.0])), "relative_humidity is 50"),
        (lambda: echocal.distance(8700, 20.0), "time_of_flight is 8700, not at most 1: it is in s: 8700 us"),
        (
            lambda: echocal.time_of_flight(1500, 20.0),
            "distance is 1500, not at most 100: it is in m: 1500 mm",
        ),
        (lambda: Model("343").correct(pd.Series([8700, 8701])), "indication is 8700, not at most 100"),
        (lambda: Model("343").distance(np.array([8700.0])), "time is 8700, not at most 1"),
        (lambda: echocal.absorption(20.0, 50.0, 101325.0, 40e3), "relative_humidity is 50"),
    ],
)
def test_another_unit_of_the_air_is_told(call: Callable[[], Any], said: str) -> None:
    with pytest.warns(DomainWarning) as warned:
        call()
    assert len(warned) == 1
    assert said in str(warned[0].message)
    assert warned[0].filename == __file__


def test_unusual_air_is_no_other_unit() -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        echocal.speed_of_sound(-60.0, 1.0, 30e3)
        echocal.speed_of_sound(np.linspace(-90, 150, 100), 1.02, 110e3, 0.1)
        assert np.isnan(echocal.speed_of_sound(np.nan, 0.5))


def logged(**changed: Any) -> echocal.Observations:
    times = pd.date_range("2024-05-01", periods=60, freq="h").to_numpy().copy()
    for rows, value in changed.values():
        times[rows] = value if isinstance(value, np.datetime64) else times[rows] + value
    with warnings.catch_warnings(action="ignore"):
        return echocal.read_observations(
            {"time": times, "echo_us": np.full(60, 8700), "temperature_C": [20.0] * 60}
        )


def test_rows_of_a_clock_that_was_not_set_have_no_time() -> None:
    data = logged(unset=(slice(3, 9), np.datetime64("1970-01-01T00:00:07")))
    assert data.unusable_counts == {"time before 1990": 6}
    assert np.nanmax(data.conditions["elapsed_time"]) == 59 * 3600.0


def test_a_clock_that_goes_back_or_stands_still_is_told() -> None:
    back = logged(back=(slice(40, None), np.timedelta64(-3, "D"))).notes
    assert any("time goes back in 1 row, first at row 41, by 255600 s" in note for note in back)
    still = logged(still=(slice(40, 44), np.datetime64("2024-05-02T15:00"))).notes
    assert any("time is that of the row before in 4 rows, first at row 41" in note for note in still)
    assert not any("goes back" in note or "row before" in note for note in logged().notes)
