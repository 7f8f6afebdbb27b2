"""Every core that can be played, and which stand for a target; Cortex-M and RISC-V cores are played in QEMU.

QEMU counts the instructions.
"""

from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

from echocal.silicon.avr import Avr
from echocal.silicon.board import HERE, Board, Calls, Generated, definitions
from echocal.silicon.tools import run

CALLS = 2000  # of each input, as in board.c
BARE = ("-std=gnu99", "-O2", "-ffreestanding", "-nostdlib")
SPEAKING = ("-display", "none", "-monitor", "none", "-serial", "none", "-chardev", "stdio,id=host")
SEMIHOSTING = ("-semihosting-config", "enable=on,target=native,chardev=host")


@dataclass(frozen=True)
class Qemu(Board):
    """A 32-bit core on a board that QEMU knows."""

    machine: tuple[str, ...]
    flash: str = "0"
    ram: str = "0x20000000"
    tick: float = 1.0  # instructions
    start: str = "start_arm.c"

    @property
    def tools(self) -> tuple[str, ...]:
        """Commands that must be installed."""
        return (self.compiler, self.machine[0])

    @cached_property
    def simulator(self) -> str:
        """The simulator, with its version."""
        return f"QEMU {run(self.machine[0], '--version').split()[3]}"

    def play(self, thing: Path, *flags: str, library: tuple[str, ...] = ()) -> str:
        """Return what the board prints; counting takes a clock that counts instructions."""
        out = thing.with_name(f"{self.name}-board.elf")
        place = ("-T", HERE / "board.ld", f"-Wl,--defsym,FLASH={self.flash},--defsym,RAM={self.ram}")
        parts = (HERE / "board.c", HERE / self.start, thing)
        files: tuple[str | Path, ...] = (*parts, *place, *library, "-lgcc", "-o", out)
        run(self.compiler, *self.flags, *BARE, f"-I{thing.parent}", *flags, *files)
        counting = ("-icount", "shift=0") if "-DCOUNT" in flags else ()
        return run(*self.machine, *SPEAKING, *SEMIHOSTING, *counting, "-kernel", out)

    def calls(self, thing: Path, made: Generated, *library: str) -> Calls:
        """Instructions of a call with its return, over a grid of inputs, and the stack it touches."""
        said = self.play(thing, "-DCOUNT", *definitions(made), library=library)
        stack, idle, *busy = (int(line, 16) for line in said.split())
        steps = [round((count - idle) * self.tick / CALLS) + 1 for count in busy]
        return Calls(min(steps), max(steps), stack)

    def output_hash(self, thing: Path, made: Generated) -> str:
        """Hash over every accepted input, computed on the board."""
        return "".join(self.play(thing, *definitions(made)).split())


def cortex(name: str, machine: str, tick: float, *flags: str) -> Board:
    """Return a Cortex-M; `tick` is the instructions between two ticks of its clock."""
    core = name.rstrip("f") if flags else name
    return Qemu(
        name,
        "arm-none-eabi-gcc",
        (f"-mcpu={core}", "-mthumb", *flags),
        ("qemu-system-arm", "-M", machine),
        tick=tick,
    )


def riscv(name: str, architecture: str, binary_interface: str) -> Board:
    """Return a RISC-V core of 32 bits."""
    return Qemu(
        name,
        "riscv64-unknown-elf-gcc",
        (f"-march={architecture}", f"-mabi={binary_interface}"),
        ("qemu-system-riscv32", "-M", "virt", "-bios", "none"),
        flash="0x80000000",
        ram="0x80100000",
        start="start_riscv.S",
    )


_STANDARD = "c99"
CORES = {
    board.name: board
    for board in (
        Avr("avr", "avr-gcc", ("-mmcu=atmega328p",)),
        cortex("cortex-m0", "microbit", 62.5),  # 16 MHz
        cortex("cortex-m3", "mps2-an385", 40.0),  # 25 MHz
        cortex("cortex-m4f", "mps2-an386", 40.0, "-mfpu=fpv4-sp-d16", "-mfloat-abi=hard"),
        riscv("rv32", "rv32imac", "ilp32"),
        riscv("rv32e", "rv32ec", "ilp32e"),  # no multiplier
    )
}
"""Cores by name."""


def cores_of(target: str) -> list[str]:
    """Return the cores that a target is for: its own, all where the target is only a standard, or none.

    Examples
    --------
    >>> cores_of("avr")
    ['avr']
    """
    return list(CORES) if target == _STANDARD else [target] if target in CORES else []
