"""Sketches on cores of 32 bits that QEMU plays: a stand-in for the Arduino core, and a virtual HC-SR04."""

from pathlib import Path

import numpy as np
from toolchain import run

from echocal import silicon
from echocal.firmware import Firmware
from echocal.silicon.board import HERE as PARTS
from echocal.silicon.cores import SEMIHOSTING, SPEAKING, Qemu

HERE = Path(__file__).parent / "standin"
CLOCKS = {"cortex-m0": 16_000_000, "cortex-m3": 25_000_000, "cortex-m4f": 25_000_000, "rv32": 10_000_000}
BARE = ("-ffreestanding", "-nostdlib", "-Os", "-Wall", "-Wextra", "-Werror")
PLUS = ("-std=gnu++11", "-fno-exceptions", "-fno-rtti", "-fno-threadsafe-statics", "-x", "c++")
PACE = ("-icount", "shift=5")  # an instruction takes 32 ns, as at 31 MHz


def play(
    packed: Firmware,
    sketch: str,
    core: str,
    folder: Path,
    millivolts: int | list[int],
    echoes: list[int],
    supply: int = 3_300,
) -> list[str]:
    """The lines that a sketch sends, one echo [us] after each of its trigger pulses; 0 is no pulse at all.

    The voltages [mV] at the analog pins belong to the echoes; `supply` [mV] is the converter's reference.
    """
    board = silicon.CORES[core]
    assert isinstance(board, Qemu)
    packed.save(folder)
    given = (
        f"-DECHOES={','.join(map(str, echoes))}",
        f"-DMILLIVOLTS={','.join(map(str, np.atleast_1d(millivolts)))}",
        f"-DSUPPLY={supply}",
        f"-DCLOCK={CLOCKS[core]}",
    )
    kind = {"cortex-m0": ("-DMICROBIT",), "rv32": ("-DARDUINO_ARCH_ESP32",)}.get(
        core, ("-DARDUINO_ARCH_STM32",)
    )
    headers = {f"-I{(folder / path).parent}" for path in packed.files if path.endswith(".h")}
    flags = (*board.flags, *BARE, *given, *kind, f"-I{HERE}", *headers)
    (source,) = (folder / path for path in packed.files if path.endswith("correction.c"))
    run(board.compiler, *flags, "-c", source, "-o", folder / "correction.o")
    plus = board.compiler.replace("gcc", "g++")
    for part in (folder / sketch, HERE / "board.cpp"):
        run(plus, *flags, *PLUS, "-c", part, "-o", folder / f"{part.stem}.o")
    objects = [folder / f"{name}.o" for name in ("correction", Path(sketch).stem, "board")]
    entry = (PARTS / board.start,) if core == "rv32" else ()  # a Cortex-M has vectors of its own
    place = ("-T", PARTS / "board.ld", f"-Wl,--defsym,FLASH={board.flash},--defsym,RAM={board.ram}")
    bare = (*board.flags, "-nostdlib")
    run(board.compiler, *bare, *entry, *objects, *place, "-lgcc", "-o", folder / "board.elf")
    said = run(*board.machine, *SPEAKING, *SEMIHOSTING, *PACE, "-kernel", folder / "board.elf")
    return said.splitlines()
