"""Noises and steps: planted by hand, named with their parameters, and not where they are not."""

from collections.abc import Callable

import numpy as np
import pytest

import echocal
from echocal.observations.quantization_grid import find_grid

N = 400
Table = dict[str, np.ndarray]
Random = np.random.Generator


def clean(random: Random) -> Table:
    distance = np.round(random.uniform(0.4, 3.9, N), 3)
    warm = 14 + 9 * np.sin(np.arange(N) / 40) + random.normal(0, 0.1, N)
    noise = random.normal(0, 1e-3, N)
    return {"reading_m": distance + noise, "distance_m": distance, "temperature_C": warm}


def slips(table: Table, random: Random) -> float:
    speed = 331.4 + 0.6 * table["temperature_C"]
    missed = random.random(N) < 0.15 + 0.1 * table["distance_m"]
    table["reading_m"] = table["reading_m"] + missed * speed * 25e-6 / 2
    return float(missed.mean())


def jitter(table: Table, random: Random) -> float:
    speed = 331.4 + 0.6 * table["temperature_C"]
    table["reading_m"] = table["reading_m"] + random.exponential(50e-6, N) * speed / 2
    return 50e-6


def growth(table: Table, random: Random) -> float:
    table["reading_m"] = table["distance_m"] + random.normal(0, 1e-3, N) * (1 + 1.5 * table["distance_m"])
    return 1.5


def reading_steps(table: Table, _: Random) -> float:
    table["reading_m"] = np.round(table["reading_m"] / 5e-3) * 5e-3
    return 5e-3


def reading_cut(table: Table, _: Random) -> float:
    table["reading_m"] = np.floor(table["reading_m"] * 100) / 100
    return 1e-2


def ticks(table: Table, _: Random) -> float:
    speed = 331.4 + 0.6 * table["temperature_C"]
    table["reading_m"] = np.round(2 * table["reading_m"] / speed / 16e-6) * 16e-6 * speed / 2
    return 16e-6


def temperature_steps(table: Table, random: Random) -> float:
    table["temperature_C"] = random.uniform(5, 35, N)
    warm = np.round(table["temperature_C"])
    speed, seen = 331.4 + 0.6 * table["temperature_C"], 331.4 + 0.6 * warm
    table["reading_m"], table["temperature_C"] = table["reading_m"] * seen / speed, warm
    return 1.0


PLANTED: tuple[tuple[str, str, float, Callable[[Table, Random], float]], ...] = (
    ("cycle_slip", "probability", 0.15, slips),
    ("polling_jitter", "mean", 0.25, jitter),
    ("noise_growth", "growth", 0.6, growth),
    ("reading_quantization", "step", 1e-6, reading_steps),
    ("reading_quantization", "step", 1e-6, reading_cut),
    ("timer_quantization", "step", 1e-6, ticks),
    ("temperature_quantization", "step", 1e-6, temperature_steps),
)


@pytest.mark.parametrize(
    ("cause", "parameter", "within", "plant"), PLANTED, ids=[plant.__name__ for *_, plant in PLANTED]
)
def test_a_noise_is_named_with_its_parameter(
    cause: str, parameter: str, within: float, plant: Callable[[Table, Random], float]
) -> None:
    random = np.random.default_rng(11)
    table = clean(random)
    planted = plant(table, random)
    diagnosis = echocal.diagnose(table)
    assert diagnosis.posterior[0][0] == (cause,)
    assert diagnosis.verdict == "named"
    (found,) = diagnosis.causes
    assert (found.id, found.kind) == (cause, "noise")
    assert found.probability > 0.9
    value = next(p.value for p in found.parameters if p.name == parameter)
    assert value == pytest.approx(planted, rel=within)
    assert sum(dict(diagnosis.posterior).values()) == pytest.approx(1.0)


@pytest.mark.statistical
@pytest.mark.slow
@pytest.mark.parametrize("tail", [2.6, 4.0, 1e3])
def test_heavy_tails_are_no_cause(tail: float, random: np.random.Generator) -> None:
    """A cause is told in 5 of 740 tables drawn with tail 2.6, 3 of 740 with 4: three of 12 are no chance."""
    wrong = []
    for _ in range(12):
        table = clean(random)
        table["reading_m"] = table["distance_m"] + 8e-4 * random.standard_t(tail, N)
        diagnosis = echocal.diagnose(table)
        if diagnosis.verdict not in ("nothing", "ambiguous") or any(
            cause.kind != "effect" for cause in diagnosis.causes
        ):
            wrong.append(diagnosis.explain())
    assert len(wrong) < 3, wrong


def remembering(keep: float, random: Random) -> Table:
    table = clean(random)
    slow = np.zeros(N)
    for row in range(1, N):
        slow[row] = keep * slow[row - 1] + random.normal(0, 1e-3)
    table["reading_m"] = table["distance_m"] + slow
    return table


def test_autocorrelated_noise_is_named_but_no_verdict() -> None:
    table = remembering(0.8, np.random.default_rng(2))
    diagnosis = echocal.diagnose(table)
    assert diagnosis.verdict == "nothing"
    (found,) = diagnosis.causes
    assert found.id == "correlated_noise"
    assert found.parameters[0].value == pytest.approx(0.8, abs=0.15)
    assert not found.indistinguishable_from


@pytest.mark.statistical
@pytest.mark.slow
def test_a_long_memory_may_be_something_unknown(random: np.random.Generator) -> None:
    """In 1 of 240 tables drawn the noise is told alone: three of 12 are no chance (1 in 60,000)."""
    alone = 0
    for _ in range(12):
        diagnosis = echocal.diagnose(remembering(0.99, random))
        noises = [cause for cause in diagnosis.causes if cause.id == "correlated_noise"]
        assert diagnosis.unexplained or noises, diagnosis.explain()
        if any(noise.indistinguishable_from != ("unknown",) for noise in noises):
            alone += 1
            continue
        assert all("in another order" in noise.because for noise in noises)
        assert not noises or "an effect outside the catalogue" in diagnosis.explain()
    assert alone < 3


def test_a_tape_that_errs_is_named() -> None:
    random = np.random.default_rng(4)
    stand = np.repeat(np.arange(12), 25)
    distance = np.linspace(0.4, 3.8, 12)[stand]
    table = {
        "reading_m": distance + random.normal(0, 4e-3, 12)[stand] + random.normal(0, 1e-3, len(stand)),
        "distance_m": distance,
        "temperature_C": 20 + random.normal(0, 2, len(stand)),
    }
    diagnosis = echocal.diagnose(table)
    assert diagnosis.verdict == "named"
    assert [cause.id for cause in diagnosis.causes] == ["reference_error"]
    assert diagnosis.causes[0].parameters[0].value == pytest.approx(4e-3, rel=0.6)


def test_a_harmless_step_is_a_note() -> None:
    table = clean(np.random.default_rng(8))
    table["reading_m"] = np.round(table["reading_m"], 4)
    diagnosis = echocal.diagnose(table)
    assert diagnosis.causes == ()
    assert any("multiples of 0.1 mm" in note and "harmless" in note for note in diagnosis.notes)


@pytest.mark.parametrize(
    ("values", "step"),
    [
        (np.arange(7.0) * 0.49, 0.49),
        (np.array([0.0, 1.96, 3.92, 6.37, 7.84]), 0.49),
        (np.array([21.5, 22.0, 22.0, 21.0, 20.0, 19.5]), 0.5),
        (np.random.default_rng(0).normal(20, 1, 300), None),
        (np.full(30, 21.0), None),
        (np.array([np.nan, 1.0]), None),
    ],
)
def test_the_step_of_a_column(values: np.ndarray, step: float | None) -> None:
    found = find_grid(values)
    assert (found.step if found else None) == (pytest.approx(step) if step else None)
