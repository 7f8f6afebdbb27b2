"""Everyday mistakes of rows, drawn afresh: each is told by its own name, and nothing else is."""

import numpy as np
import pytest

import echocal
from echocal.diagnose.candidates.effects import _in_units

Table = dict[str, np.ndarray]
DRAWS, ENOUGH = 10, 8  # of fresh draws, 19 in 20 are right; fewer than 8 of 10 are then 1 in 90


def others(found: echocal.Diagnosis, *expected: str) -> set[str]:
    """What is told beside what was planted; a step is there wherever readings are printed."""
    told = {cause.id for cause in found.causes} - {*expected, "reading_quantization"}
    return told | ({"unknown"} if found.verdict == "unknown" else set())


def bench(random: np.random.Generator, rows: int, scatter: float, *, known: bool) -> Table:
    """White noise at one distance, or at some that are known."""
    distance = np.full(rows, random.uniform(0.5, 3.0))
    if known:
        distance = np.sort(random.choice(random.uniform(0.5, 3.0, 5).round(2), rows))
    table = {"reading_m": distance + random.normal(0.0, scatter, rows), "temperature_C": np.full(rows, 20.0)}
    return {**table, "distance_m": distance} if known else table


@pytest.mark.statistical
@pytest.mark.parametrize("known", [False, True])
def test_one_wild_row_is_told_and_nothing_else(known: bool, random: np.random.Generator) -> None:
    """Before, half of them were left in, and made a mixture of missed cycles likely."""
    right = 0
    for _ in range(DRAWS):
        rows, scatter = int(random.integers(120, 185)), random.uniform(3e-3, 6e-3)
        table = bench(random, rows, scatter, known=known)
        table["reading_m"][random.integers(rows)] += random.choice([-1, 1]) * scatter * random.uniform(13, 30)
        table["reading_m"] = table["reading_m"].round(3)
        found = echocal.diagnose(table, constant_distance=not known)
        right += found.rows["used"] == rows - 1 and found.verdict == "nothing" and not others(found)
    assert right >= ENOUGH


@pytest.mark.statistical
@pytest.mark.filterwarnings("ignore::echocal.DataWarning")
@pytest.mark.parametrize("known", [False, True])
@pytest.mark.parametrize("answer", ["24.4 m", "0", "-1", "9999", "largest range", "38 ms"])
def test_rows_without_an_echo_are_marked_so(answer: str, known: bool, random: np.random.Generator) -> None:
    """The constant may vary by some centimeters, and one row in three may be one."""
    right = 0
    for _ in range(DRAWS):
        rows = int(random.integers(20, 200))
        table = bench(random, rows, random.choice([1e-3, 3e-3, 8e-3]), known=known)
        lost = random.choice(rows, max(3, int(random.uniform(0.05, 0.4) * rows)), replace=False)
        jitter = random.normal(0.0, 1.0, len(lost))
        values = {
            "24.4 m": 24.4 + 0.02 * jitter,
            "38 ms": 6.52 + 0.002 * jitter,
            "largest range": random.choice([4.5, 5.0, 6.0, 7.65]),
        }
        table["reading_m"][lost] = values.get(answer, 0.0)
        table["reading_mm"] = np.round(1e3 * table.pop("reading_m"))
        if answer not in values:
            table["reading_mm"][lost] = float(answer)
        found = echocal.diagnose(table, constant_distance=not known)
        marked = found.rows["unusable"].get("timeout", 0) == len(lost) == rows - found.rows["used"]
        right += marked and not others(found, "timeout")
    assert right >= ENOUGH


@pytest.mark.statistical
def test_another_unit_is_no_lost_echo(random: np.random.Generator) -> None:
    """Rows in another unit scatter as the others, and their mean is off by the factor alone."""
    told = []
    for _ in range(DRAWS):
        rows = int(random.integers(40, 200))
        table = bench(random, rows, 4e-3, known=False)
        table["reading_m"][random.choice(rows, rows // 8, replace=False)] *= 0.1
        told.append({cause.id for cause in echocal.diagnose(table, constant_distance=True).causes})
    assert sum("unit_mixup" in ids for ids in told) >= ENOUGH, told
    assert not any("timeout" in ids for ids in told)


@pytest.mark.statistical
def test_a_second_thing_in_the_beam_is_no_lost_echo(random: np.random.Generator) -> None:
    """Its echoes follow the air, as those of the target do."""
    told = []
    for _ in range(DRAWS):
        rows = 1000
        air = np.cumsum(random.normal(0.0, 2e-4, rows))
        reading = 2.8 * (1 + air) + random.normal(0.0, 2e-3, rows)
        other = random.choice(rows, 50, replace=False)
        reading[other] = (2.0 * (1 + air) + random.normal(0.0, 2e-3, rows))[other]
        table = {"reading_m": reading.round(3), "temperature_C": np.full(rows, 20.0)}
        told.append({cause.id for cause in echocal.diagnose(table, constant_distance=True).causes})
    assert sum("timeout" in ids for ids in told) <= DRAWS - ENOUGH, told


@pytest.mark.statistical
@pytest.mark.parametrize("where", ["jump", "end", "middle"])
def test_a_reading_that_freezes_is_stuck(where: str, random: np.random.Generator) -> None:
    """Most rows may be frozen ones: the live rows alone say how they scatter."""
    right = 0
    for _ in range(DRAWS):
        live, frozen = int(random.integers(25, 60)), int(random.integers(50, 120))
        step = random.choice([0.1, 1.0])
        cm = random.uniform(60.0, 300.0) + random.normal(0.0, random.uniform(0.6, 2.5) * step, live + frozen)
        last = random.uniform(40.0, 400.0) if where == "jump" else cm[live]
        first = live // 2 if where == "middle" else live
        cm[first : first + frozen] = last
        table = {"reading_cm": step * np.round(cm / step), "temperature_C": np.full(len(cm), 21.0)}
        found = echocal.diagnose(table, constant_distance=True)
        marked = found.rows["unusable"].get("stuck_reading", 0)
        right += frozen - 1 <= marked <= frozen + 2 and not others(found, "stuck_reading")
    assert right >= ENOUGH


@pytest.mark.statistical
def test_rows_one_step_off_do_not_scatter_more_than_others(random: np.random.Generator) -> None:
    """More than half of the rows are exact. Half of such tables had a noise of less than 0.3 mm."""
    right = 0
    for _ in range(DRAWS):
        cm = np.repeat(np.sort(random.choice(np.arange(5.0, 200.0, 5.0), 8, replace=False)), 6)
        off = random.choice(len(cm), int(random.integers(2, 6)), replace=False)
        reading = cm.copy()
        reading[off] += random.choice([1, -1], len(off))
        table = {"reading_cm": reading, "distance_cm": cm}
        found = echocal.diagnose(table, reading_speed="343", at={"temperature": "20+-2"})
        of_a_mean = 1e-3 / 6**0.5  # the six rows of a placement count as one
        right += found.rows["used"] == len(cm) and found.noise["standard_deviation_m"] > of_a_mean
    assert right >= ENOUGH


def test_a_parameter_at_its_bound_is_within_it() -> None:
    """Otherwise a table whose best drift is the largest one ends in an error."""
    for scale in np.random.default_rng(1).uniform(1e-9, 1e-3, 2000):
        for at in (0.0, 3e-6):
            low, high = _in_units((-1e-5, 1e-5), at, float(scale))
            assert -1e-5 <= at + low * scale < at + high * scale <= 1e-5


def test_too_few_rows_of_one_placement_are_no_matter_of_stands(random: np.random.Generator) -> None:
    with pytest.raises(echocal.DataError, match=r"8 usable rows have 1 of them.*at least 8 rows more"):
        echocal.diagnose(bench(random, 8, 1e-3, known=False), constant_distance=True)


@pytest.mark.statistical
def test_a_reading_that_freezes_in_calm_air_is_stuck_when_the_target_moves(
    random: np.random.Generator,
) -> None:
    """All runs are long there. Before, the frozen rows were a time-out in most draws."""
    right = 0
    for _ in range(DRAWS):
        rows, frozen = int(random.integers(8, 30)), int(random.integers(5, 8))
        distance = np.repeat(random.permutation(np.linspace(0.4, 3.0, 8)).round(2), rows)
        echo_us = 2e6 * distance / 343.4 + random.normal(0.0, 0.4, 8 * rows)
        first = rows * int(random.integers(1, 8))
        echo_us[first : first + frozen] = echo_us[first - 1]
        table = {"echo_us": echo_us.round(), "distance_m": distance}
        table["temperature_C"] = np.full(8 * rows, 20.0)
        found = echocal.diagnose(table)
        right += found.rows["unusable"] == {"stuck_reading": frozen}
    assert right >= ENOUGH
