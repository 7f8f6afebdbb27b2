"""Print the table of `docs/firmware.md`: generated functions beside what hobby libraries compute, in one run.

Run ``python tests/firmware/silicon/table.py`` with the toolchains of `.ci/packages.txt`.
"""

import sys
import tempfile
from dataclasses import replace
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1]))

from boards import BOARDS, Avr, Cost
from test_silicon import CEILINGS, dry_air

from echocal.firmware import Firmware

HOBBY = {
    "`us / 58`, no temperature": "(void)code; return (int32_t)(echo_us * 10000UL / 58UL);",
    "`331.4 + 0.6 * T` in float": "return (int32_t)(echo_us * (331.4f + 0.6f * (code * 0.0625f)) / 2.0f);",
    "`331.3 * sqrt(1 + T / 273.15)` in float": (
        "return (int32_t)(echo_us * (331.3f * __builtin_sqrtf(1.0f + code * 0.0625f / 273.15f)) / 2.0f);"
    ),
}
SOURCE = """#include "echocal_correction.h"
int32_t echocal_distance_um(uint16_t echo_us, int16_t code)
{
    %s
}
"""


def hobby(made: Firmware, body: str, folder: Path) -> str:
    """One row: a library's formula on the AVR, without its warnings."""
    board = BOARDS["avr"]
    assert isinstance(board, Avr)
    theirs = replace(made, files={**made.files, "echocal_correction.c": SOURCE % body})
    thing = board.compile(theirs, folder, "-Os", strict=False)
    sizes = board.sizes(board.link(thing, "-lm"))
    codes = made.report["device"]["conditions"][0]["codes"]
    _, ((fewest, most, stack),) = board.drive(thing, made, codes["maximum"] - codes["minimum"])
    cycles = f"{fewest}" if fewest == most else f"{fewest} to {most}"
    return f"{sizes['text']} | {cycles} | {stack} | - |"


def ours(found: Cost, made: Firmware) -> str:
    error = made.report["error_proven_m"] * 1e3
    own = f" ({found.own} + {found.flash - found.own})" if found.own != found.flash else ""
    return f"{found.flash}{own} | {found.steps} | {found.stack} | {error:.3f} mm |"


def main() -> None:
    print("| core | function | flash [B] | cycles or instructions | stack [B] | proven |")
    print("|---|---|---|---|---|---|")
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        for label, body in HOBBY.items():
            print(f"| AVR | {label} |", hobby(dry_air("avr"), body, folder))
        for core, target, prefer, level in CEILINGS:
            made = dry_air(target, prefer)
            form = made.report["form"]["description"]
            found = BOARDS[core].measure(made, folder, level)
            print(f"| {core} | `{target}`, {prefer}, {level}: {form} |", ours(found, made))


if __name__ == "__main__":
    main()
