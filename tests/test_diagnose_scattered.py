"""A few rows that scatter far more than the others: they neither make causes nor hide them."""

import numpy as np
import pytest

import echocal
from echocal.diagnose.noises.common.scattered_rows import Scattered

ROWS, SHOT = 400, 1.5e-3
SAID = "scatter far more than the others"

Table = dict[str, np.ndarray]


def noise(random: np.random.Generator, part: float = 0.05) -> np.ndarray:
    """Normal, with a part of the rows scattered tenfold [m]."""
    wide = random.random(ROWS) < part
    return SHOT * np.where(wide, 10.0, 1.0) * random.normal(size=ROWS)


def table(random: np.random.Generator, errors: np.ndarray, delay: float = 0.0) -> Table:
    """Five distances, temperature up and down."""
    temperature = 20 + 8 * np.sin(np.linspace(0, 6, ROWS)) + random.normal(0, 0.2, ROWS)
    distance = random.choice(np.linspace(0.5, 2.5, 5), ROWS)
    echo = 2 * (distance + errors) / echocal.speed_of_sound(temperature, law="linear") + delay
    return {"echo_us": 1e6 * echo, "temperature_C": temperature, "distance_m": distance}


def test_both_kinds_of_rows_are_found(random: np.random.Generator) -> None:
    left = np.concatenate([random.normal(0, 1e-3, 9500), random.normal(0, 1e-2, 500)])
    found = Scattered.of(left)
    assert found is not None
    assert (found.part, found.usual, found.wide) == pytest.approx((0.05, 1e-3, 1e-2), rel=0.2)
    beyond = found.beyond(left)
    near, far = np.abs(left) < 2e-3, np.abs(left) > 8e-3
    assert np.abs(beyond[near]).max() < 0.1 * np.abs(left[near]).max()
    np.testing.assert_allclose(beyond[far], left[far] * (1 - (found.usual / found.wide) ** 2), rtol=1e-3)


def test_rows_without_any_scatter_are_of_one_kind(random: np.random.Generator) -> None:
    """Readings that are exact but for the last bit: a division by zero before."""
    left = np.where(random.random(60) < 0.5, 0.0, random.choice([1.1e-16, 4.4e-16, 6.7e-16], 60))
    assert Scattered.of(left) is None
    assert Scattered.of(np.zeros(60)) is None
    for _ in range(20):
        assert echocal.diagnose(table(random, np.zeros(ROWS))).verdict


@pytest.mark.statistical
@pytest.mark.parametrize("freedom", [8.0, 30.0])
def test_slightly_heavy_tails_and_normal_noise_are_left_alone(
    freedom: float, random: np.random.Generator
) -> None:
    diagnosis = echocal.diagnose(table(random, 1e-3 * random.standard_t(freedom, ROWS)))
    assert not any(SAID in note for note in diagnosis.notes)


@pytest.mark.statistical
def test_scattered_rows_alone_are_no_cause(random: np.random.Generator) -> None:
    """Of 300 tables 0.017 had a verdict, as many as without scattered rows; before, 0.14."""
    tables = [table(random, noise(random)) for _ in range(12)]
    found = [echocal.diagnose(one) for one in tables]
    assert sum(one.verdict != "nothing" for one in found) <= 1
    assert sum(any(SAID in note for note in one.notes) for one in found) >= 11
    told = [d.noise["standard_deviation_m"] / of_a_visit(t) for d, t in zip(found, tables, strict=True)]
    assert np.median(told) == pytest.approx(1.0, rel=0.1)


def of_a_visit(table: Table) -> float:
    """Standard deviation of the mean of a run of rows at one distance, which counts as one row [m]."""
    begins = np.flatnonzero(np.diff(table["distance_m"], prepend=-1.0))
    return SHOT * float(np.sqrt(np.mean(1.0 / np.diff(np.append(begins, ROWS)))))


@pytest.mark.statistical
def test_scattered_rows_hide_no_cause(random: np.random.Generator) -> None:
    """A delay of 17 standard uncertainties; the standard deviation of all rows would make it eight."""
    diagnosis = echocal.diagnose(table(random, noise(random), delay=8e-6))
    assert dict(diagnosis.posterior).get((), 0.0) < 0.05
    assert any(SAID in note for note in diagnosis.notes)


@pytest.mark.statistical
def test_a_step_at_the_end_is_a_step(random: np.random.Generator) -> None:
    """Few rows, far off, and yet no scatter: the hypothesis that has the step leaves nothing."""
    errors = noise(random, 0.0) + np.where(np.arange(ROWS) >= 370, 12e-3, 0.0)
    diagnosis = echocal.diagnose({**table(random, errors), "time_s": 10.0 * np.arange(ROWS)})
    assert "step_change" in {
        id_ for cause in diagnosis.causes for id_ in (cause.id, *cause.indistinguishable_from)
    }
    assert not any(SAID in note for note in diagnosis.notes)


@pytest.mark.statistical
def test_a_cause_with_rare_large_values_is_no_scatter(random: np.random.Generator) -> None:
    """Of ten logs three had a size that was too small by a fifth to a half, as such rows were taken off."""
    off = []
    for _ in range(10):
        quality = np.round(170.0 + 15.0 * np.abs(random.standard_t(4, ROWS)))
        found = echocal.diagnose(
            {**table(random, noise(random, 0.0) - 8e-5 * quality), "echo_quality": quality}
        )
        (cause,) = (one for one in found.causes if one.id == "echo_quality")
        gain = cause.parameters[0]
        off.append(abs(gain.value + 8e-5) / gain.standard_uncertainty)
        assert not any(SAID in note for note in found.notes)
    assert max(off) < 4.5
