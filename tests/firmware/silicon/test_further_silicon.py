"""Functions with a further input on simulated silicon: the proven hash, and pinned costs on AVR."""

import pytest
from costs import Cost, check

from echocal import Model, firmware, silicon
from echocal.registry import find_effect

pytestmark = pytest.mark.slow


def own(effect: str) -> dict[str, float]:
    """The typical size of an effect."""
    known = find_effect(effect).parameters
    return {one.name: one.neutral + (one.prior_scale if one.role == "size" else 0.0) for one in known}


DELAY = {"fixed_delay": {"delay": 31e-6}}
SUPPLY = Model("cramer", {"supply_voltage": {"slope": 60e-6}, **DELAY})
SLANT = Model("cramer", {"slant_range": own("slant_range"), **DELAY})
WIND = Model("cramer", {"wind_along": own("wind_along"), **DELAY})
FAINT = Model("cramer", {"recorded_amplitude": own("recorded_amplitude"), **DELAY})
COARSE = {"temperature": (10.0, -20.0, 60.0), "max_error": 0.6e-3}
CASES = {
    "delay": (SUPPLY, {"further": "supply_voltage=4.5:5.5:0.1"}),
    "delay beside humidity": (
        SUPPLY,
        {"further": "supply_voltage=4.5:5.5:0.25", "humidity": (0.25, 0.0, 1.0)},
    ),
    "speed": (SLANT, {"further": "angle=0:0.25:0.025"}),
    "speed beside humidity": (SLANT, {"further": "angle=0:0.25:0.05", "humidity": (0.25, 0.0, 1.0)}),
}


@pytest.mark.parametrize("case", CASES)
@pytest.mark.parametrize("core", silicon.CORES)
def test_every_input(core: str, case: str) -> None:
    model, request = CASES[case]
    made = firmware.generate(model, core, **COARSE, **request)
    assert silicon.output_hash(made, core) == made.report["output_hash"]


# Within 0.5 mm, 1/16 degC, of dry air: the most allowed per compiler version.
FINE = {"temperature": (0.0625, -20.0, 60.0), "max_error": 0.5e-3}
CEILINGS: dict[str, tuple[Model, str, dict[str, Cost]]] = {
    "supply voltage": (SUPPLY, "supply_voltage=4.5:5.5:0.01", {"5": Cost(154, 124, 0, 6, 144)}),
    "amplitude": (FAINT, "amplitude=0.05:1:0.01", {"5": Cost(224, 193, 0, 4, 142)}),
    "wind": (WIND, "wind_speed=-10:10:0.1", {"5": Cost(292, 232, 0, 14, 279)}),
    "angle": (SLANT, "angle=0:0.26:0.005", {"5": Cost(296, 230, 0, 12, 284)}),
}


@pytest.mark.parametrize("name", CEILINGS)
def test_costs_stay_below_their_ceilings(name: str) -> None:
    model, codes, most = CEILINGS[name]
    made = firmware.generate(model, "avr", further=codes, n_threads=2, **FINE)
    check(made, "avr", "-Os", most)
