"""The state of a thermometer that lags, on simulated silicon: the twin's bits, in a pinned time and space."""

from pathlib import Path

import pytest
from test_filter_silicon import HEADER, Shim

from echocal import Model
from echocal.lagging import LagFirmware, generate_lagging
from echocal.silicon import CORES
from echocal.silicon.avr import BASE, PRIME, Avr

pytestmark = pytest.mark.slow

# The echo code is the row of the golden sequence, as for the filter. The first row finds a new state.
SHIM = """
static const int16_t codes[] = {{ {codes} }};
static echocal_air_state kept;
int32_t echocal_distance_um(uint16_t echo_us, int16_t temperature_code)
{{
    (void)temperature_code;
    return {function}(&kept, codes[echo_us]);
}}
"""
NOTHING = """
static int32_t __attribute__((noinline)) nothing(echocal_air_state *state, int16_t code)
{
    state->begun = 1U;
    return code;
}
"""
# By core and compiler version: most bytes, and most cycles (AVR) or instructions of a call.
CEILINGS = {
    ("avr", "5"): (436, 482),
    ("cortex-m0", "12"): (112, 41),
    ("cortex-m3", "12"): (112, 30),
    ("cortex-m4f", "12"): (112, 31),
    ("rv32", "12"): (114, 29),
    ("rv32e", "12"): (176, 125),
}


def shim(packed: LagFirmware, function: str) -> tuple[Shim, list[int]]:
    rows = [line.split(",") for line in packed.files["echocal_air_golden.csv"].splitlines()[1:]]
    code = packed.files["echocal_air.h"] + packed.files["echocal_air.c"]
    calls = SHIM.format(codes=", ".join(code for code, _ in rows), function=function)
    before = NOTHING if function == "nothing" else ""
    text = code.replace('#include "echocal_air.h"', "") + before + calls
    last = len(rows) - 1
    ends = [{"codes": {"minimum": 0, "maximum": end}, "quantity": "temperature"} for end in (last, 0)]
    device = {"echo": ends[0], "conditions": [ends[1]]}
    files = {"echocal_correction.c": text, "echocal_correction.h": HEADER.format(last=last)}
    return Shim(files, {"device": device}), [int(air) for _, air in rows]


def played(core: str, made: Shim, folder: Path) -> tuple[str, int]:
    """Hash of the outputs, and the most cycles or instructions of a call."""
    board = CORES[core]
    thing = board.compile(made, folder, "-Os")
    if isinstance(board, Avr):
        (row,), (calls,) = board.drive(thing, made, [1])
        return f"{row:016x}", calls.most
    return board.output_hash(thing, made), board.calls(thing, made).most


@pytest.mark.parametrize("core", CORES)
def test_the_golden_sequence_and_its_cost(core: str, tmp_path: Path) -> None:
    model = Model("cramer", {"temperature_lag": {"time_constant": 240.0}})
    packed = generate_lagging(model, 10.0, temperature=(0.0625, -20.0, 60.0))
    board = CORES[core]
    (tmp_path / "with").mkdir()
    (tmp_path / "without").mkdir()
    made, expected = shim(packed, "echocal_air_code")
    hash_ = 0
    for air in expected:
        hash_ = (hash_ * BASE + air + 2**31) % PRIME
    found, most = played(core, made, tmp_path / "with")
    assert found == f"{hash_:016x}"
    _, idle = played(core, shim(packed, "nothing")[0], tmp_path / "without")
    linked = board.link(next((tmp_path / "with").glob("*.o")), "echocal_air_code")
    bytes_, steps = CEILINGS[core, board.version.split(".")[0]]
    assert board.variables(linked) == 0
    assert board.sizes(linked)["text"] <= bytes_
    assert most - idle <= steps
