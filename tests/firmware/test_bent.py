"""Distances that bend over the echo time: the factor falls or rises with the high bits of the echo code."""

import re
import warnings
from pathlib import Path

import numpy as np
import pytest
from toolchain import build, hash_of_all

from echocal import BoundError, Model, UsageError, firmware, silicon
from echocal.firmware import Firmware

HUMID = {"relative_humidity": 0.5}
WALK = {"amplitude_walk": {"delay": 40e-6}}
HALF_DEGREES = (0.5, -20.0, 60.0)
# Most flash [byte] and cycles of a call of the walk within 0.5 mm on an ATmega328P, by compiler version.
CEILINGS = {"5": (358, 339)}


def made(model: Model, target: str = "avr", **request: object) -> Firmware:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        return firmware.generate(model, target, **{"temperature": HALF_DEGREES, "assume": HUMID, **request})


def assert_follows(packed: Firmware, model: Model, random: np.random.Generator) -> None:
    """Fresh codes: the output is within what was proven of the model, but for what is rounded."""
    axis = packed.report["device"]["echo"]["codes"]
    echo = random.integers(axis["minimum"], axis["maximum"] + 1, 3000)
    warm = random.integers(-40, 121, 3000)
    air = {"temperature": warm * 0.5, "relative_humidity": 0.5}
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        truth = model.distance(echo * 1e-6, **air)
    error = np.abs(packed.distance_um(echo, warm) * 1e-6 - truth)[truth <= 4.0]
    assert error.max() <= packed.report["error_proven_m"] + 1e-9


def test_a_walk_of_40_us_is_followed_within_half_a_millimeter(
    random: np.random.Generator, tmp_path: Path
) -> None:
    model = Model("cramer", WALK)
    packed = made(model, max_error=0.5e-3)
    assert packed.report["form"]["name"] == "bent"
    assert packed.report["error_proven_m"] <= 0.5e-3
    assert_follows(packed, model, random)
    assert hash_of_all(build(packed, tmp_path)) == packed.report["output_hash"]


@pytest.mark.parametrize("gradient", [-2.0, 2.0])
@pytest.mark.parametrize("target", ["avr", "c99", "cortex-m0"])
def test_air_that_is_warmer_or_colder_further_away(
    gradient: float, target: str, random: np.random.Generator
) -> None:
    model = Model("cramer", {"temperature_gradient": {"gradient": gradient}})
    packed = made(model, target, max_error=0.5e-3)
    assert packed.report["form"]["parameters"]["rises"] == (gradient > 0)
    assert_follows(packed, model, random)


def test_a_bend_that_does_not_matter_costs_nothing() -> None:
    """A straight line serves where the bound allows it."""
    packed = made(Model("cramer", WALK), max_error=3e-3)
    assert packed.report["form"]["name"] != "bent"


def test_the_form_alone_is_refused_where_nothing_bends() -> None:
    with pytest.raises(UsageError, match="form 'bent' is for distances that bend over the echo time"):
        made(Model("cramer"), form="bent")


def test_a_bound_out_of_reach_says_the_best() -> None:
    with pytest.raises(BoundError, match="the best reachable is") as told:
        made(Model("cramer", WALK), max_error=0.02e-3)
    best = re.search(r"the best reachable is ([0-9.]+) mm", str(told.value))
    assert best is not None
    assert float(best[1]) < 0.5


@pytest.mark.slow
def test_the_cost_of_a_walk() -> None:
    packed = made(Model("cramer", WALK), temperature=(0.0625, -20.0, 60.0), max_error=0.5e-3)
    found = silicon.measure(packed, "avr")
    assert found is not None, silicon.missing("avr")
    flash, cycles = CEILINGS[found.compiler.split()[-1].split(".")[0]]
    assert found.cycles == found.fewest_cycles, "of constant time"
    assert (found.flash_bytes <= flash, found.steps <= cycles) == (True, True), (
        found.flash_bytes,
        found.steps,
    )
