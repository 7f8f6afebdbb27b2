"""Autocorrelated noise: in long tables, where most correlations are excluded early, and convection."""

import sys

import numpy as np
import pytest
from hidden_effects.designs import remembering

import echocal
from echocal.diagnose.inference.autocorrelation import at_first

ROWS = 24_000  # more than a short table


def log(noise: np.ndarray, random: np.random.Generator, power: float = 0.5) -> dict[str, np.ndarray]:
    """A field log of a sensor that answers 40 us late; the noise grows with a power of the distance."""
    temperature = 15 + 8 * np.sin(np.arange(ROWS) * 2 * np.pi / 288) + random.normal(0, 1, ROWS)
    distance = random.uniform(0.3, 4.0, ROWS)
    true = distance + noise * (distance / 2) ** power
    echo = 2 * true / echocal.speed_of_sound(temperature, law="linear")
    return {
        "echo_us": 1e6 * echo + 40.0,
        "temperature_C": temperature,
        "distance_m": distance,
        "time_s": 300.0 * np.arange(ROWS),
    }


@pytest.mark.slow
@pytest.mark.parametrize("keep", [0.0, 0.9])
def test_a_long_table_has_the_probabilities_of_all_autocorrelations(
    keep: float, random: np.random.Generator, monkeypatch: pytest.MonkeyPatch
) -> None:
    white, cells = random.normal(0, 1e-3, ROWS), remembering(ROWS, keep, random)
    table = log(white + (1e-3 * cells if keep else 0.0), random)
    quick = echocal.diagnose(table)
    monkeypatch.setattr(sys.modules[at_first.__module__], "LONG", ROWS)
    whole = echocal.diagnose(table)
    assert quick.causes[0].id in {"fixed_delay", "zero_error"}  # few degrees separate them: a draw may err
    assert ("correlated_noise" in {c.id for c in quick.causes}) == (keep > 0)
    assert [c.id for c in quick.causes] == [c.id for c in whole.causes]
    for one, other in zip(quick.causes, whole.causes, strict=True):
        assert one.probability == pytest.approx(other.probability, abs=1e-3)
    assert quick.noise == pytest.approx(whole.noise, rel=1e-6)


@pytest.mark.statistical
def test_convection_is_identified_by_its_growth_with_distance(random: np.random.Generator) -> None:
    cells = 1.5e-3 * remembering(ROWS, 0.9, random)
    table = log(cells, random)
    table["echo_us"] += random.normal(0, 6.0, ROWS)  # 1 mm
    diagnosis = echocal.diagnose(table)
    (found,) = (c for c in diagnosis.causes if c.id == "correlated_noise")
    values = {p.name: p.value for p in found.parameters}
    assert values["autoregression"] == pytest.approx(0.9, abs=0.06)
    assert values["growth"] == pytest.approx(1.1, rel=0.5)  # 1.5^2 / 2 over 1.03^2
    assert "farther" in found.because
    assert "noise_growth" not in {c.id for c in diagnosis.causes}


@pytest.mark.statistical
def test_air_that_is_alike_along_the_path_is_noise_and_no_effect(random: np.random.Generator) -> None:
    """Its error is in proportion to the distance; without such a noise, effects of the air were named."""
    diagnosis = echocal.diagnose(log(1.5e-3 * remembering(ROWS, 0.8, random), random, power=1.0))
    assert {c.id for c in diagnosis.causes if c.kind == "effect"} == {diagnosis.causes[0].id}
    assert diagnosis.causes[0].id in {"fixed_delay", "zero_error"}
    (found,) = (c for c in diagnosis.causes if c.id == "correlated_noise")
    assert "farther" in found.because
    assert diagnosis.noise["autoregression"] == pytest.approx(0.8, abs=0.01)
