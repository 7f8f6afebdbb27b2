"""Faults of rows and columns: planted by hand, they must be found, told with row numbers, and repaired.

Tables come from numpy alone; what is planted is a mistake of a person or a logger, no physics.
"""

from collections.abc import Callable

import numpy as np
import pytest

import echocal
from echocal.diagnose.catalogue import find_cause, irregularities
from echocal.diagnose.faults.fahrenheit_celsius import celsius
from echocal.diagnose.faults.mistyped_rows import edits

N = 240
Table = dict[str, np.ndarray]
FAULTS = (*echocal.gross_faults(), *echocal.row_faults())


def clean(seed: int) -> Table:
    random = np.random.default_rng(seed)
    distance = np.round(random.uniform(0.4, 3.9, N), 3)
    humidity = 55 + 20 * np.sin(np.arange(N) / 17) + random.normal(0, 2, N)
    return {
        "reading_m": distance + random.normal(0, 1.5e-3, N),
        "distance_m": distance,
        "temperature_C": 14 + 9 * np.sin(np.arange(N) / 40) + random.normal(0, 0.1, N),
        "humidity_percent": humidity,
        "time_s": 60.0 * np.arange(N),
    }


def mistyped(table: Table) -> list[int]:
    table["reading_m"] = np.round(table["reading_m"], 3)
    rows = [row for row in range(20, 200) if 3.5 < table["reading_m"][row] < 3.9][:2]
    for row in rows:  # 3.456 becomes 4.356
        digits = f"{round(1e3 * table['reading_m'][row]):04d}"
        table["reading_m"][row] = int(digits[1] + digits[0] + digits[2:]) / 1e3
    return rows


def shifted(table: Table) -> list[int]:
    table["reading_m"][102:] = table["reading_m"][100:-2].copy()
    return list(range(102, N))


def stuck(table: Table) -> list[int]:
    table["reading_m"][50:62] = table["reading_m"][50]
    table["distance_m"][50:62] = table["distance_m"][50]
    return list(range(51, 62))


def timeout(table: Table) -> list[int]:
    rows = [30, 77, 140]
    speed = 331.4 + 0.6 * table["temperature_C"]
    table["reading_m"][rows] = speed[rows] * 38e-3 / 2
    return rows


def blanking(table: Table) -> list[int]:
    rows = np.flatnonzero(table["distance_m"] < 0.7)
    table["reading_m"][rows] = 1.1 + 0.02 * np.sin(7.0 * rows)
    return list(rows)


def crosstalk(table: Table) -> list[int]:
    rows = [11, 66, 180]
    table["reading_m"][rows] *= [0.3, 0.55, 0.8]
    return rows


def multipath(table: Table) -> list[int]:
    rows = [11, 66, 180]
    table["reading_m"][rows] *= [2.0, 1.3, 1.15]
    return rows


def censored(table: Table) -> list[int]:
    table["reading_m"] = np.minimum(table["reading_m"], 3.5)
    return list(np.flatnonzero(table["reading_m"] == 3.5))


def swapped(table: Table) -> list[int]:
    warm, humid = table["temperature_C"].copy(), table["humidity_percent"].copy()
    table["temperature_C"][150:], table["humidity_percent"][150:] = humid[150:], warm[150:]
    return list(range(150, N))


def fahrenheit(table: Table) -> list[int]:
    rows = [40, 41, 100]
    table["temperature_C"][rows] = 32 + 1.8 * table["temperature_C"][rows]
    return rows


def all_fahrenheit(table: Table) -> list[int]:
    table["temperature_C"] = 32 + 1.8 * (table["temperature_C"] + 12)
    return list(range(N))


def twice(table: Table) -> list[int]:
    table["reading_m"] = 2 * table["reading_m"]
    return list(range(N))


def inches(table: Table) -> list[int]:
    table["reading_m"] = table["reading_m"] / 2.54
    return list(range(N))


def centimeters(table: Table) -> list[int]:
    table["reading_m"] = 100 * table["reading_m"]
    return list(range(N))


def some_centimeters(table: Table) -> list[int]:
    rows = [22, 90, 91, 170]
    table["reading_m"][rows] *= 100
    return rows


def some_milliseconds(table: Table) -> list[int]:
    echoes(table)
    rows = list(range(60, 85))
    table["echo_us"][rows] /= 1000
    return rows


def exchanged(table: Table) -> list[int]:
    echoes(table)
    table["echo_us"], table["distance_m"] = table["distance_m"], table["echo_us"]
    return list(range(N))


def echoes(table: Table) -> None:
    """Echo times instead of readings."""
    table["echo_us"] = 2e6 * table.pop("reading_m") / (331.4 + 0.6 * table["temperature_C"])


PLANTED: tuple[tuple[str, Callable[[Table], list[int]]], ...] = (
    ("mistyped_rows", mistyped),
    ("shifted_rows", shifted),
    ("stuck_reading", stuck),
    ("timeout", timeout),
    ("blanking_distance", blanking),
    ("crosstalk", crosstalk),
    ("multipath", multipath),
    ("censored_range", censored),
    ("swapped_columns", swapped),
    ("fahrenheit_celsius", fahrenheit),
    ("fahrenheit_celsius", all_fahrenheit),
    ("round_trip_factor", twice),
    ("unit_mixup", inches),
    ("unit_mixup", centimeters),
    ("unit_mixup", some_centimeters),
    ("unit_mixup", some_milliseconds),
    ("swapped_time_distance", exchanged),
)


@pytest.mark.filterwarnings("ignore::echocal.DataWarning")
@pytest.mark.parametrize(("cause", "plant"), PLANTED, ids=[plant.__name__ for _, plant in PLANTED])
def test_a_fault_is_named_with_its_rows(cause: str, plant: Callable[[Table], list[int]]) -> None:
    table = clean(7)
    rows = plant(table)
    diagnosis = echocal.diagnose(table)
    assert diagnosis.verdict == "named"
    found = {c.id: c for c in diagnosis.causes if c.kind in {"row", "gross"}}
    assert list(found) == [cause]
    assert found[cause].probability > 0.9
    assert found[cause].kind == find_cause(cause).kind  # type: ignore[union-attr]
    assert cause in diagnosis.posterior[0][0]
    assert sum(dict(diagnosis.posterior).values()) == pytest.approx(1.0)
    assert any(note.startswith(f"{cause}: ") for note in diagnosis.notes)
    if len(rows) <= 5:
        assert any(f" {row + 1}" in found[cause].because for row in rows)
    total, used, unusable = (diagnosis.rows[name] for name in ("total", "used", "unusable"))
    assert total == N
    assert used + sum(unusable.values()) == N
    assert np.std(diagnosis.traces.before) < 2.5e-3  # what is left is the noise that was put in


@pytest.mark.parametrize("seed", range(12))
def test_a_clean_table_has_no_fault(seed: int) -> None:
    table = clean(seed)
    random = np.random.default_rng(seed)
    table["reading_m"] = table["distance_m"] + 1e-3 * random.standard_t(4, N)
    assert not [c for c in echocal.diagnose(table).causes if c.kind in {"row", "gross"}]


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(8))
@pytest.mark.parametrize(("step", "noise"), [(1e-2, 2e-3), (1e-2, 1e-4), (3e-3, 1.5e-3), (1e-3, 2e-4)])
def test_equal_neighbors_of_a_coarse_reading_are_not_stuck(seed: int, step: float, noise: float) -> None:
    """A target that stands still for a while reads the same where the step hides the noise."""
    random = np.random.default_rng([seed, 3])
    table = clean(seed)
    stays = np.concatenate([np.arange(120), np.repeat(np.arange(120, 135), 8)])
    table = {name: column[stays] for name, column in table.items()} | {"time_s": table["time_s"]}
    table["reading_m"] = step * np.round((table["distance_m"] + random.normal(0, noise, N)) / step)
    assert "stuck_reading" not in {c.id for c in echocal.diagnose(table).causes}


def test_a_frozen_coarse_reading_is_found() -> None:
    table = clean(4)
    table["reading_m"] = np.round(table["reading_m"], 2)
    table["reading_m"][50:62] = table["reading_m"][50]  # while the target moves on
    (found,) = [c for c in echocal.diagnose(table).causes if c.kind == "row"]
    assert found.id == "stuck_reading"
    assert {p.name: p.value for p in found.parameters}["length"] == 12


def test_a_column_that_no_fault_explains_is_still_refused() -> None:
    table = clean(3)
    table["reading_m"] = 170 * table["reading_m"]
    with pytest.raises(echocal.DataError, match="reading_m"):
        echocal.diagnose(table)


def test_a_repair_leaves_the_mean_causes_to_be_found() -> None:
    table = clean(5)
    table["reading_m"] = table["reading_m"] + 0.012
    twice(table)
    table["reading_m"] = table["reading_m"] * np.where(np.arange(N) == 33, 0.4, 1.0)
    ids = {cause.id for cause in echocal.diagnose(table).causes}
    assert {"round_trip_factor"} < ids
    assert ids & {"zero_error", "fixed_delay"}


def test_one_edit_away() -> None:
    meant = {text for text, _, _ in edits("1342")}
    assert {"3142", "1432", "1324", "142", "13420", "13042"} <= meant
    assert "2431" not in meant


def test_fahrenheit_is_undone() -> None:
    assert celsius(np.array([32.0, 212.0])).tolist() == [0.0, 100.0]


@pytest.mark.statistical
@pytest.mark.parametrize("as_recorded", [True, False])
def test_echo_times_say_whether_a_hot_column_is_fahrenheit(
    as_recorded: bool, random: np.random.Generator
) -> None:
    """A warm chamber and a room logged in Fahrenheit have the same numbers, and other echoes."""
    numbers = random.uniform(46.0, 59.5, 200)
    celsius_there = numbers if as_recorded else celsius(numbers)
    echo = 2.0 / (331.4 + 0.6 * celsius_there) + random.normal(0.0, 1e-6, 200)
    table = {"echo_us": 1e6 * echo, "temperature_C": numbers, "distance_m": np.ones(200)}
    diagnosis = echocal.diagnose(table)
    said = [cause.id for cause in diagnosis.causes if cause.in_model or cause.kind == "gross"]
    assert said == ([] if as_recorded else ["fahrenheit_celsius"]), diagnosis.explain()
    assert diagnosis.gain is not None
    assert diagnosis.gain.rms_before_m < 1e-3  # the base of the table as it was made


def test_facts_are_complete() -> None:
    ids = [facts.id for facts in irregularities()]
    assert len(ids) == len(set(ids))
    for facts in irregularities():
        assert 0 < facts.prior < 0.5
        assert facts.sentence.endswith(".")
        assert facts.source
        assert facts.check
        assert facts.to_dict()["parameters"]
        assert find_cause(facts.id) is facts
    assert {facts.id for facts in FAULTS} <= set(ids)


@pytest.mark.statistical
@pytest.mark.slow
def test_a_sensor_that_was_bumped_loses_no_rows(random: np.random.Generator) -> None:
    """Rows before the bump are far from those after it, and none of them is another echo.

    In 9 of 328 tables drawn some rows are lost, in all of them 800 or more rows come before the bump: that
    is a known fault. Four of 12 are no chance (1 in 4,000).
    """
    lost = 0
    for _ in range(12):
        distance = random.uniform(0.3, 4.0, 3000)
        bump = np.where(np.arange(3000) < random.integers(400, 850), 0.0, -0.03)
        table = {
            "time_s": np.arange(3000.0) * 300,
            "distance_m": distance,
            "temperature_C": 15 + 8 * np.sin(np.arange(3000) / 40),
            "reading_m": distance + bump + random.normal(0, 1.5e-3, 3000),
        }
        diagnosis = echocal.diagnose(table)
        lost += diagnosis.rows["used"] < 3000
        assert "step_change" in [c.id for c in diagnosis.causes if c.kind == "effect"]
    assert lost < 4
