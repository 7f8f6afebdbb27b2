"""Find what was hidden, and nothing where nothing is: fresh cases every run."""

from collections.abc import Callable

import numpy as np
import pytest
from hidden_effects.planting import EFFECTS, bench, noise, table, tape

import echocal

pytestmark = pytest.mark.slow

CASES = 3  # per effect


def mentioned(diagnosis: echocal.Diagnosis) -> set[str]:
    return {id_ for cause in diagnosis.causes for id_ in (cause.id, *cause.indistinguishable_from)}


def planted(effect: str, random: np.random.Generator) -> tuple[echocal.Diagnosis, np.ndarray]:
    rows = bench(random)
    size = random.choice([-1, 1]) * random.uniform(1.0, 2.5)
    reading = EFFECTS[effect](rows, size)
    noisy = reading + noise(rows, random, random.choice(["normal", "heavy"]))
    reference = rows.distance + tape(rows, random, 0.5e-3)
    data = table(rows, noisy, humidity=effect != "unrecorded_humidity", reference=reference)
    return echocal.diagnose(data), reading - rows.distance


@pytest.fixture(scope="module")
def hunts(
    request: pytest.FixtureRequest, seeded: Callable[..., np.random.Generator]
) -> dict[str, list[tuple[echocal.Diagnosis, np.ndarray]]]:
    found = {}
    for effect in EFFECTS:
        random = seeded(request, effect)
        found[effect] = [planted(effect, random) for _ in range(CASES)]
    return found


Hunts = dict[str, list[tuple[echocal.Diagnosis, np.ndarray]]]


def test_hidden_effects_are_found(hunts: Hunts) -> None:
    # measured: 198 of 200 fresh cases; even at the lower 95 % bound of that rate, fewer than 24 of 30
    # have a probability below 1e-4
    hits = [effect in mentioned(diagnosis) for effect, cases in hunts.items() for diagnosis, _ in cases]
    assert sum(hits) >= 24, f"found {sum(hits)} of {len(hits)}"


def test_confident_names_are_right(hunts: Hunts) -> None:
    # measured: 169 of 170 names right; at the lower 95 % bound fewer than 7 of 10 are below 1e-3
    named = [(e, d) for e, cases in hunts.items() for d, _ in cases if d.verdict == "named"]
    right = [effect in mentioned(diagnosis) for effect, diagnosis in named]
    assert len(right) >= 10
    assert sum(right) >= 0.7 * len(right)


def test_the_gain_is_what_was_hidden(hunts: Hunts) -> None:
    parts = [d.gain.fraction_of_reachable for cases in hunts.values() for d, _ in cases if d.gain is not None]
    known = [part for part in parts if part is not None]
    assert np.median(known) > 0.97


@pytest.mark.statistical
@pytest.mark.parametrize("kind", ["normal", "heavy", "memory"])
def test_noise_is_not_named(kind: str, random: np.random.Generator) -> None:
    # measured while it was built: no name in 114 fresh tables; even at the upper 95 % bound of 0.03,
    # four or more of ten have a probability below 2e-4
    alarms = []
    for _ in range(10):
        rows = bench(random)
        reading = rows.distance + noise(rows, random, kind)
        diagnosis = echocal.diagnose(table(rows, reading, reference=rows.distance + tape(rows, random)))
        names = {cause.id for cause in diagnosis.causes if cause.probability >= 0.9}
        alarms.append(bool(names - {"reference_error", "correlated_noise"}))  # these two are there
    assert sum(alarms) <= 3, f"{sum(alarms)} of {len(alarms)}"


@pytest.mark.statistical
def test_an_effect_outside_the_catalogue_is_unknown(random: np.random.Generator) -> None:
    rows = bench(random)
    bump = 8e-3 * np.exp(-(((rows.temperature - 25.0) / 6.0) ** 2))
    diagnosis = echocal.diagnose(table(rows, rows.distance + bump + noise(rows, random)))
    assert diagnosis.unexplained is not None
    assert diagnosis.unexplained.against == "temperature"
    assert diagnosis.unexplained.rms_m > 1e-3
