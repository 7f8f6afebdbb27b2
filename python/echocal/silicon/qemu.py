"""Cortex-M and RISC-V cores in QEMU, which counts instructions."""

from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

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
