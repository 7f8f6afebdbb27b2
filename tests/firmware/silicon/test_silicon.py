"""Generated firmware on simulated silicon gives the twin's bits, in a time and a space that are pinned."""

from pathlib import Path

import numpy as np
import pytest
from boards import BOARDS, Avr, Cost, folded

from echocal import Model, firmware
from echocal.firmware import Firmware

DRY = {"relative_humidity": 0.0, "co2_mole_fraction": 0.0}
DS18B20 = (0.0625, -20.0, 60.0)

# Dry Cramer, -Os, most allowed per compiler version: bytes with what comes from its library, bytes of the
# function alone, memory, stack, and cycles (AVR) or instructions of a call.
CEILINGS = {
    ("avr", "5"): Cost(160, 116, 0, 6, 325),
    ("cortex-m0", "12"): Cost(72, 72, 0, 0, 24),
    ("cortex-m3", "12"): Cost(60, 60, 0, 0, 20),
    ("cortex-m4f", "12"): Cost(60, 60, 0, 0, 20),
    ("rv32", "12"): Cost(84, 84, 0, 0, 27),
}


@pytest.fixture(scope="module")
def dry_air() -> Firmware:
    made = firmware.generate(Model("cramer"), temperature=DS18B20, max_error=0.1e-3, assume=DRY)
    assert made.report["inputs_checked"] == 48_679_281
    return made


@pytest.mark.parametrize("name", [name for name in BOARDS if name != "avr"])
def test_all_48_million_inputs_under_qemu(name: str, dry_air: Firmware, tmp_path: Path) -> None:
    assert BOARDS[name].hash_of_all(dry_air, tmp_path) == dry_air.report["output_hash"]


@pytest.mark.parametrize("name", BOARDS)
def test_costs_stay_below_their_ceilings(name: str, dry_air: Firmware, tmp_path: Path) -> None:
    board = BOARDS[name]
    found, most = board.measure(dry_air, tmp_path), CEILINGS[name, board.version]
    over = {field: value for field, value in vars(found).items() if value > getattr(most, field)}
    assert not over, f"{found} above {most}"


@pytest.mark.parametrize("name", [name for name in BOARDS if name != "avr"])
def test_every_form_on_every_core(name: str, case: Firmware, tmp_path: Path) -> None:
    assert BOARDS[name].hash_of_all(case, tmp_path) == case.report["output_hash"]


def test_every_form_on_avr(case: Firmware, tmp_path: Path) -> None:
    """Three rows of each: the first, one in the middle, the last."""
    board = BOARDS["avr"]
    assert isinstance(board, Avr)
    device = case.report["device"]
    codes, echo = device["conditions"][0]["codes"], device["echo"]["codes"]["maximum"]
    step = (codes["maximum"] - codes["minimum"]) // 2
    rows, _ = board.drive(board.compile(case, tmp_path, "-Os"), case, step)
    for row, code in zip(rows, range(codes["minimum"], codes["maximum"] + 1, step), strict=True):
        outputs = case.distance_um(np.arange(echo + 1), code).astype(np.uint32)
        assert row == folded(outputs.tolist())
