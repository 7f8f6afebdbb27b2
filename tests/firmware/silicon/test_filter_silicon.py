"""The median filter on simulated silicon gives the twin's bits, in a time and a space that are pinned."""

import functools
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from echocal import Model, firmware
from echocal.firmware import Firmware
from echocal.silicon import CORES
from echocal.silicon.avr import BASE, PRIME, Avr

# Two arguments, as the boards give them: the echo code is the row of the golden sequence. The first row
# finds a new filter: memory is zero when a board starts.
SHIM = """
static const int32_t distances[] = {{ {distances} }};
static const uint8_t statuses[] = {{ {statuses} }};
static echocal_filter_state kept;
int32_t echocal_distance_um(uint16_t echo_us, int16_t temperature_code)
{{
    (void)temperature_code;
    return {function}(&kept, distances[echo_us], statuses[echo_us]) ^ (int32_t)kept.status;
}}
"""
# What the shim costs without a filter.
NOTHING = """
static int32_t __attribute__((noinline))
nothing(echocal_filter_state *state, int32_t distance, uint8_t status)
{
    state->status = status;
    return distance;
}
"""
HEADER = """
#include <stdint.h>
#define ECHOCAL_OUT_OF_RANGE INT32_MIN
#define ECHOCAL_OK (0U)
#define ECHOCAL_ECHO_US_FIRST (0)
#define ECHOCAL_ECHO_US_LAST ({last})
#define ECHOCAL_TEMPERATURE_CODE_FIRST (0)
#define ECHOCAL_TEMPERATURE_CODE_LAST (0)
int32_t echocal_distance_um(uint16_t echo_us, int16_t temperature_code);
"""
FILTERS = [(3, None), (5, None), (7, None), (3, 0.3), (5, 0.3), (7, 0.3)]
# By core and compiler version: most bytes without a gate and with one; most cycles (AVR, over the golden
# sequence) or instructions (elsewhere, at four of its rows) of a call by window, without and with a gate.
CEILINGS = {
    ("avr", "5"): ((404, 456), {3: (429, 560), 5: (788, 1034), 7: (1286, 1673)}),
    ("cortex-m0", "12"): ((208, 256), {3: (94, 150), 5: (332, 466), 7: (562, 776)}),
    ("cortex-m3", "12"): ((196, 256), {3: (71, 114), 5: (284, 352), 7: (484, 578)}),
    ("cortex-m4f", "12"): ((196, 256), {3: (71, 114), 5: (284, 352), 7: (484, 578)}),
    ("rv32", "12"): ((218, 276), {3: (59, 95), 5: (246, 302), 7: (416, 492)}),
    ("rv32e", "12"): ((234, 304), {3: (63, 102), 5: (246, 307), 7: (416, 497)}),
}


@dataclass(frozen=True)
class Shim:
    """What a board runs in place of a generated function."""

    files: dict[str, str]
    report: dict[str, Any]


@functools.cache
def filtering(median: int, gate: float | None) -> Firmware:
    return firmware.generate(Model("cramer"), temperature=(0.5, -20.0, 60.0), median=median, gate=gate)


def golden(packed: Firmware) -> np.ndarray:
    lines = packed.files["echocal_filter_golden.csv"].splitlines()[1:]
    return np.array([line.split(",") for line in lines], dtype=np.int64)


def shim(packed: Firmware, function: str) -> Shim:
    rows = golden(packed)
    code = packed.files["echocal_filter.h"] + packed.files["echocal_filter.c"]
    columns = [", ".join(map(str, rows[:, column])).replace(str(-(2**31)), "INT32_MIN") for column in (0, 1)]
    calls = SHIM.format(distances=columns[0], statuses=columns[1], function=function)
    text = (
        code.replace('#include "echocal_filter.h"', "") + (NOTHING if function == "nothing" else "") + calls
    )
    last = len(rows) - 1
    axes = [{"minimum": 0, "maximum": last}, {"minimum": 0, "maximum": 0}]
    device = {"echo": {"codes": axes[0]}, "conditions": [{"codes": axes[1], "quantity": "temperature"}]}
    header = HEADER.format(last=last)
    return Shim({"echocal_correction.c": text, "echocal_correction.h": header}, {"device": device})


def expected_hash(packed: Firmware) -> str:
    value = 0
    for output, status in golden(packed)[:, 2:].tolist():
        value = (value * BASE + ((output ^ status) + 2**31)) % PRIME
    return f"{value:016x}"


def played(core: str, made: Shim, folder: Path) -> tuple[str, int]:
    """Hash of the outputs, and the most cycles or instructions of a call."""
    board = CORES[core]
    thing = board.compile(made, folder, "-Os")
    if isinstance(board, Avr):
        (row,), (calls,) = board.drive(thing, made, [1])
        return f"{row:016x}", calls.most
    return board.output_hash(thing, made), board.calls(thing, made).most


@pytest.mark.slow
@pytest.mark.parametrize(("median", "gate"), FILTERS)
@pytest.mark.parametrize("core", CORES)
def test_the_golden_sequence_and_its_cost(core: str, median: int, gate: float | None, tmp_path: Path) -> None:
    packed, board = filtering(median, gate), CORES[core]
    (tmp_path / "with").mkdir()
    (tmp_path / "without").mkdir()
    found, most = played(core, shim(packed, "echocal_filter"), tmp_path / "with")
    _, idle = played(core, shim(packed, "nothing"), tmp_path / "without")
    assert found == expected_hash(packed)
    thing = next((tmp_path / "with").glob("*.o"))
    linked = board.link(thing, "echocal_filter")
    bytes_, steps = CEILINGS[core, board.version.split(".")[0]]
    gated = gate is not None
    assert board.variables(linked) == 0
    assert board.sizes(linked)["text"] <= bytes_[gated]
    assert most - idle <= steps[median][gated]
