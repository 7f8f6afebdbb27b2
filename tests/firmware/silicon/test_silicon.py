"""Generated firmware on simulated silicon gives the twin's bits, in a time and a space that are pinned."""

import functools
from pathlib import Path

import numpy as np
import pytest
from costs import Cost, check

from echocal import Model, firmware, silicon
from echocal.firmware import Firmware
from echocal.silicon.avr import Avr, joined

DRY = {"relative_humidity": 0.0, "co2_mole_fraction": 0.0}
DS18B20 = (0.0625, -20.0, 60.0)

# Dry Cramer; most allowed per compiler version: bytes with what comes from its library, bytes of the function
# alone, memory, stack, and cycles (AVR) or instructions of a call. Of these the least echo takes 2 bytes and
# a cycle on AVR (4 and 2 with segments, which lack registers), up to 4 bytes and 3 instructions elsewhere.
CEILINGS = {
    ("avr", "avr", "size", "-Os"): {"5": Cost(114, 84, 0, 4, 116)},
    ("avr", "avr", "size", "-O2"): {"5": Cost(114, 84, 0, 4, 116)},
    ("avr", "avr", "accurate", "-Os"): {"5": Cost(120, 90, 0, 4, 129)},
    ("avr", "avr", "accurate and fast", "-Os"): {"5": Cost(122, 92, 0, 4, 98)},
    ("avr", "avr", "speed", "-Os"): {"5": Cost(110, 80, 0, 4, 92)},
    ("avr", "c99", "size", "-Os"): {"5": Cost(122, 92, 0, 4, 98)},
    ("cortex-m0", "cortex-m0", "size", "-Os"): {"12": Cost(64, 64, 0, 0, 25)},
    ("cortex-m3", "cortex-m3", "size", "-Os"): {"12": Cost(60, 60, 0, 0, 17)},
    ("cortex-m4f", "cortex-m4f", "size", "-Os"): {"12": Cost(60, 60, 0, 0, 17)},
    ("rv32", "rv32", "size", "-Os"): {"12": Cost(88, 88, 0, 0, 26)},
}
# The same with a delay of 31 us: no echo is shorter, so that the time less it is never negative.
DELAYED = {
    ("avr", "size"): {"5": Cost(118, 88, 0, 4, 118)},
    ("avr", "speed"): {"5": Cost(126, 96, 0, 4, 100)},
    ("cortex-m0", "size"): {"12": Cost(68, 68, 0, 0, 26)},
    ("rv32", "size"): {"12": Cost(90, 90, 0, 0, 27)},
}
# What is saved, and the bound.
WISHES = {
    "size": ("size", 0.1e-3),
    "accurate": ("size", 0.06e-3),
    "accurate and fast": ("speed", 0.06e-3),
    "speed": ("speed", 0.5e-3),
}


@functools.cache
def dry_air(target: str, wish: str = "size") -> Firmware:
    prefer, bound = WISHES[wish]
    return firmware.generate(
        Model("cramer"), target, temperature=DS18B20, max_error=bound, prefer=prefer, assume=DRY
    )


@pytest.mark.slow
@pytest.mark.parametrize("name", silicon.CORES)
def test_all_32_million_inputs(name: str) -> None:
    made = dry_air(name)
    assert made.report["inputs_checked"] == 1281 * (25_069 - 109 + 1)
    assert silicon.output_hash(made, name) == made.report["output_hash"]


@pytest.mark.slow
@pytest.mark.parametrize("case_", CEILINGS, ids="-".join)
def test_costs_stay_below_their_ceilings(case_: tuple[str, str, str, str]) -> None:
    core, target, wish, level = case_
    check(dry_air(target, wish), core, level, CEILINGS[case_])


@pytest.mark.slow
@pytest.mark.parametrize(("core", "prefer"), DELAYED, ids="-".join)
def test_a_delay_costs_a_subtraction(core: str, prefer: str) -> None:
    """As in a model that a diagnosis made: the product stays one of natural numbers of 16 bits."""
    model = Model("cramer", {"fixed_delay": {"delay": 31e-6}})
    made = firmware.generate(model, core, temperature=DS18B20, max_error=0.1e-3, prefer=prefer, assume=DRY)
    check(made, core, "-Os", DELAYED[core, prefer])


@pytest.mark.slow
@pytest.mark.parametrize("name", [name for name in silicon.CORES if name != "avr"])
def test_every_form_on_every_core(name: str, case: Firmware) -> None:
    assert silicon.output_hash(case, name) == case.report["output_hash"]


@pytest.mark.slow
def test_every_form_on_avr(case: Firmware, tmp_path: Path) -> None:
    """Three rows of each: the first, one in the middle, the last."""
    board = silicon.CORES["avr"]
    assert isinstance(board, Avr)
    device = case.report["device"]
    codes, echo = device["conditions"][0]["codes"], device["echo"]["codes"]
    step = (codes["maximum"] - codes["minimum"]) // 2
    rows, _ = board.drive(board.compile(case, tmp_path, "-Os"), case, [step])
    for row, code in zip(rows, range(codes["minimum"], codes["maximum"] + 1, step), strict=True):
        outputs = case.distance_um(np.arange(echo["minimum"], echo["maximum"] + 1), code).astype(np.int64)
        assert row == joined((outputs + 2**31).tolist(), 1)
