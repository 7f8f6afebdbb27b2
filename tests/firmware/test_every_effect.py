"""Every effect of the registry: in the C and proven, or refused by name with what it leaves behind."""

import re
import warnings

import numpy as np
import pytest

import echocal
from echocal import Model, firmware
from echocal.errors import BoundError, UsageError

CODES = {"temperature": (5.0, -10.0, 40.0), "echo": 24_000}
EFFECTS = {effect.id: effect for effect in echocal.effects()}
FOLDED = {"temperature_offset", "fixed_delay", "amplitude_walk", "zero_error"}  # wanted by name


def model_with(name: str) -> Model:
    """An ordinary size of the effect, on a law that it extends."""
    parameters = {}
    for one in EFFECTS[name].parameters:
        low, high = one.bounds
        size = one.prior_scale if one.role == "size" else 0.0
        parameters[one.name] = float(np.clip(one.neutral + size, low, high))
    law = EFFECTS[name].extends[0] if EFFECTS[name].extends else "linear"
    return Model(law, {name: parameters})


def made(model: Model, **request: object) -> firmware.Firmware:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        return firmware.generate(model, max_error=0.5e-3, n_threads=2, **CODES, **request)


@pytest.mark.parametrize("name", EFFECTS)
def test_in_the_c_or_refused_with_what_it_leaves(name: str) -> None:
    model = model_with(name)
    if EFFECTS[name].firmware != "folded":
        with pytest.raises(UsageError, match=rf"effect {name} .*: up to [0-9.]+ mm.*--accept {name}") as told:
            made(model)
        left = re.search(r"up to ([0-9.]+) mm", str(told.value))
        assert left is not None
        assert float(left[1]) > 0, "an effect that does nothing is none"
        accepted = made(model, accept=[name])
        assert any(name in line for line in accepted.report["assumptions"]), "what was left out is told"
        return
    found = made(model)
    assert found.report["error_proven_m"] <= 0.5e-3
    warm = np.arange(-2, 9)[:, None]
    first = found.report["device"]["echo"]["codes"]["minimum"]
    assert 1 <= first <= 200
    echo = np.arange(first, 23_000, 250)
    truth = model.distance(echo * 1e-6, temperature=warm * 5.0, pressure=101_325.0)
    assert np.abs(found.distance_um(echo, warm) * 1e-6 - truth)[truth <= 4.0].max() <= 0.5e-3


def test_what_must_be_folded_is() -> None:
    assert {name for name in FOLDED if EFFECTS[name].firmware != "folded"} == set()


@pytest.mark.parametrize("name", [name for name in EFFECTS if EFFECTS[name].firmware == "needs"])
def test_a_refusal_names_the_input_that_is_lacking(name: str) -> None:
    lacking = EFFECTS[name].firmware_detail
    assert lacking
    with pytest.raises(UsageError, match=f"needs {lacking}, which the device does not measure"):
        made(model_with(name))


@pytest.mark.slow
def test_a_bound_out_of_reach_of_a_walk_says_the_best() -> None:
    """No form follows its bend in the echo time so closely: the best reachable is told, and can be had."""
    model = Model("cramer", {"amplitude_walk": {"delay": 400e-6, "threshold": 0.6}})
    with pytest.raises(BoundError, match="ask for") as told:
        firmware.generate(model, max_error=0.02e-3, **CODES)
    enough = re.search(r"ask for ([0-9.]+) mm", str(told.value))
    assert enough is not None
    bound = float(enough[1]) * 1e-3
    assert firmware.generate(model, max_error=bound, **CODES).report["error_proven_m"] <= bound
