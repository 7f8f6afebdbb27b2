"""Causes that the data cannot separate are listed, from the columns of the data."""

import numpy as np
import pytest
from hidden_effects.planting import EFFECTS, bench, noise, table

import echocal
from echocal.diagnose.candidates.variant import Variant
from echocal.diagnose.inference.alias import Geometry
from echocal.diagnose.settings.claims import ClaimSettings

ALIASES = {
    "speed_intercept": "temperature_offset",
    "speed_slope": "temperature_gain",
    "temperature_offset": "speed_intercept",
    "temperature_gain": "speed_slope",
}


@pytest.mark.statistical
@pytest.mark.parametrize("effect", ALIASES)
def test_exact_aliases_under_the_linear_law(effect: str, random: np.random.Generator) -> None:
    rows = bench(random)
    data = table(rows, EFFECTS[effect](rows, 4.0) + noise(rows, random, sd=0.5e-3))  # no scale looks like it
    diagnosis = echocal.diagnose(data)
    (cause,) = [c for c in diagnosis.causes if effect in (c.id, *c.indistinguishable_from)]
    assert ALIASES[effect] in (cause.id, *cause.indistinguishable_from)
    pair = {effect, ALIASES[effect]}
    proposals = [p for p in diagnosis.next_measurements if pair == set(p.separates)]
    assert all("side_measurement" in p.conditions for p in proposals)  # no row can ever separate them


@pytest.mark.statistical
def test_one_distance_and_temperature_leave_one_big_class(random: np.random.Generator) -> None:
    data = {
        "distance_m": np.full(60, 2.0),
        "temperature_C": 20.0 + random.normal(0, 0.2, 60),
        "reading_m": 2.006 + random.normal(0, 1e-3, 60),
    }
    diagnosis = echocal.diagnose(data)
    (cause,) = [c for c in diagnosis.causes if c.in_model]
    together = {cause.id, *cause.indistinguishable_from}
    assert {"fixed_delay", "zero_error", "clock_error", "speed_intercept", "temperature_offset"} <= together
    separable = [p for p in diagnosis.next_measurements if p.expected_probability is not None]
    (plan,) = separable  # another distance tells most of them
    assert max(abs(distance - 2.0) for distance in plan.conditions["distance"]) > 0.5


def test_a_cause_that_cannot_be_negative_imitates_nothing_negative() -> None:
    """Two columns that are the same; one coefficient is at least zero."""
    geometry = Geometry(np.array([[400.0, 400.0], [400.0, 400.0]]), 1.0)
    one = Variant("self_heating", free=(1,), bounds=((0.0, 20.0),))
    either = Variant("offset", free=(1,), bounds=((-20.0, 20.0),))
    for size, expected in ((2.0, ["self_heating", "offset"]), (-2.0, ["offset"])):
        signal, others = np.array([size, 0.0]), {"self_heating": [one], "offset": [either]}
        assert geometry.rivals(signal, others, np.zeros(2), ClaimSettings()) == expected


@pytest.mark.statistical
def test_an_unknown_level_takes_up_a_zero_error(random: np.random.Generator) -> None:
    said = []
    for _ in range(3):
        data = {
            "temperature_C": 20.0 + 10 * np.sin(np.linspace(0, 20, 300)),
            "reading_m": 2.02 + random.normal(0, 1e-3, 300),
        }
        diagnosis = echocal.diagnose(data, constant_distance=True)
        assert "zero_error" not in {cause.id for cause in diagnosis.causes}
        said.append(diagnosis.verdict)
    assert said.count("nothing") >= 2  # of a hundred tables one or two give a false alarm
