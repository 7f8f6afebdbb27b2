"""A condition that is only stated for all rows may be wrong: then this is a cause like others."""

import numpy as np
import pytest

import echocal

ROWS = 600


def tank(humidity: float, random: np.random.Generator) -> dict[str, np.ndarray]:
    """Echo times of a target at 1.5 m in a tank that warms and cools, at one humidity."""
    temperature = 27.0 + 9.0 * np.sin(np.linspace(0.0, 20.0, ROWS)) + random.normal(0.0, 0.5, ROWS)
    speed = echocal.Model("cramer").speed_of_sound(1.5, temperature=temperature, relative_humidity=humidity)
    return {"echo_us": 2e6 * (1.5 + random.normal(0.0, 1e-3, ROWS)) / speed, "temperature_C": temperature}


def diagnosed(table: dict[str, np.ndarray], **at: str) -> echocal.Diagnosis:
    return echocal.diagnose(table, base="cramer", reference_distance=1.5, at=at)


@pytest.mark.statistical
def test_a_humidity_that_is_stated_wrong_is_named(random: np.random.Generator) -> None:
    true = random.uniform(0.85, 0.93)
    diagnosis = diagnosed(tank(true, random), humidity="50+-20")
    assert diagnosis.verdict == "named"
    (cause,) = [c for c in diagnosis.causes if c.kind == "effect"]
    assert cause.id == "unrecorded_humidity"
    (size,) = cause.parameters
    assert size.value == pytest.approx(true, abs=0.03)
    # the model has this humidity in place of the stated one
    assert diagnosis.model.effects["unrecorded_humidity"]["relative_humidity"] == pytest.approx(
        true, abs=0.03
    )
    assert "relative_humidity" not in diagnosis.model.air


@pytest.mark.statistical
def test_a_humidity_without_an_uncertainty_may_be_wrong_too(random: np.random.Generator) -> None:
    diagnosis = diagnosed(tank(random.uniform(0.1, 0.2), random), humidity="80")
    assert "unrecorded_humidity" in {c.id for c in diagnosis.causes}


@pytest.mark.statistical
def test_a_humidity_that_is_stated_right_is_the_air_of_the_model(random: np.random.Generator) -> None:
    true = random.uniform(0.3, 0.9)
    diagnosis = diagnosed(tank(true, random), humidity=f"{100 * true:.1f}+-5")
    assert not [c for c in diagnosis.causes if c.kind == "effect"]
    assert diagnosis.model.air["relative_humidity"] == pytest.approx(true, abs=1e-3)
    assert not diagnosis.model.effects


@pytest.mark.statistical
def test_carbon_dioxide_that_is_stated_wrong_is_found(random: np.random.Generator) -> None:
    """A store that may have some thousand ppm more than the air outside: all of its air is slower."""
    table = tank(0.5, random)
    air = {"temperature": table["temperature_C"], "relative_humidity": 0.5}
    law = echocal.Model("cramer")
    usual, rich = (law.speed_of_sound(1.5, **air, co2_mole_fraction=x) for x in (4e-4, 8e-3))
    table["echo_us"] *= usual / rich
    table["humidity_percent"] = np.full(ROWS, 50.0)
    diagnosis = diagnosed(table, co2_ppm="400+-4000")
    found = {id_ for c in diagnosis.causes for id_ in (c.id, *c.indistinguishable_from)}
    assert "gas_composition" in found
