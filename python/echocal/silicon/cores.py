"""Every core that can be played, and which stand for a target: an ATmega328P in libsimavr, others in QEMU.

An ATmega328P is played cycle by cycle, and every call is made by a driver that counts. QEMU counts the
instructions of Cortex-M and RISC-V cores. The simulators are GPL: they are used where they are installed, and
are no part of this package.
"""

from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

from echocal.errors import EchocalError
from echocal.silicon.board import HERE, Board, Calls, Generated, axes, definitions, function
from echocal.silicon.tools import run

__all__ = ["CORES", "cores_of"]

CALLS = 2000  # of each input, as in board.c
BARE = ("-std=gnu99", "-O2", "-ffreestanding", "-nostdlib")
SPEAKING = ("-display", "none", "-monitor", "none", "-serial", "none", "-chardev", "stdio,id=host")
SEMIHOSTING = ("-semihosting-config", "enable=on,target=native,chardev=host")
HEADERS = Path("/usr/include/simavr/sim_avr.h")
LIBRARY = ("-lsimavr",)
ROWS_EACH = 50  # of one simulator process
PARALLEL = 4
PRIME, BASE = 2**61 - 1, 40_503  # of the hash


@dataclass(frozen=True)
class Avr(Board):
    """An ATmega328P."""

    counts_cycles = True

    @property
    def tools(self) -> tuple[str, ...]:
        """Commands that must be installed."""
        return (self.compiler, "gcc")

    def missing(self) -> list[str]:
        """Return what is not installed of what is needed."""
        return [*super().missing(), *(() if HEADERS.exists() else ("libsimavr-dev",))]

    @cached_property
    def simulator(self) -> str:
        """The simulator, with its version."""
        text = HEADERS.with_name("sim_core_config.h").read_text(encoding="utf-8")
        return f"simavr {text.split('CONFIG_SIMAVR_VERSION')[1].split()[0].strip(chr(34))}"

    def driver(self, thing: Path, name: str, *library: str) -> tuple[Path, Path]:
        """Return the program that makes the calls, and the chip's."""
        chip, driver = thing.with_name("avr-call.elf"), thing.with_name("avr-driver")
        bare = ("-nostartfiles", "-Wl,--gc-sections,-e,once")
        stub = (f"-DDISTANCE={name}", HERE / "avr_stub.S")
        run(self.compiler, *self.flags, *stub, thing, *bare, *library, "-o", chip)
        run("gcc", "-O2", "-Wall", "-Wextra", "-Werror", HERE / "avr_driver.c", "-o", driver, *LIBRARY)
        return driver, chip

    def drive(
        self, thing: Path, made: Generated, step: int, damp_step: int = 1, *library: str
    ) -> tuple[list[int], list[Calls]]:
        """Return the hashes of the rows, and for each process the cost of its calls."""
        driver, chip = self.driver(thing, function(made), *library)
        echo, (first, last), *damp = axes(made)
        length = ROWS_EACH * step
        spans = [(low, min(last, low + length - step)) for low in range(first, last + 1, length)]
        ends = [str(word) for axis in damp for word in (*axis, damp_step)]

        def part(span: tuple[int, int]) -> list[str]:
            lines = run(driver, chip, *map(str, (*echo, *span, step)), *ends).splitlines()
            return [line for line in lines if not line.startswith("Loaded")]

        with ThreadPoolExecutor(PARALLEL) as pool:
            parts = list(pool.map(part, spans))
        rows = [int(line, 16) for lines in parts for line in lines[:-1]]
        return rows, [Calls(*map(int, lines[-1].split())) for lines in parts]

    def calls(self, thing: Path, made: Generated, *library: str) -> Calls:
        """Cycles of a call with its return, over every echo code at the ends of each condition."""
        warm, damp = [*(max(1, last - first) for first, last in axes(made)[1:]), 1][:2]
        return self.sampled(thing, made, warm, damp, *library)

    def sampled(self, thing: Path, made: Generated, step: int, damp_step: int = 1, *library: str) -> Calls:
        """Cycles of a call over every echo code, and every `step`-th code of each condition."""
        _, found = self.drive(thing, made, step, damp_step, *library)
        fewest, most = min(part.fewest for part in found), max(part.most for part in found)
        return Calls(fewest, most, max(part.stack for part in found))

    def output_hash(self, thing: Path, made: Generated) -> str:
        """Hash over every accepted input, one call each, all of them in the same number of cycles."""
        rows, found = self.drive(thing, made, 1)
        fewest, most = min(part.fewest for part in found), max(part.most for part in found)
        if fewest != most:
            message = f"not of constant time: calls take {fewest} to {most} cycles"
            raise EchocalError(message)
        first, last = axes(made)[0]
        return f"{joined(rows, last - first + 1):016x}"


def joined(hashes: list[int], length: int) -> int:
    """Return the hash of all outputs (firmware_gen/src/hash.rs) from those of parts of one length."""
    value, scale = 0, pow(BASE, length, PRIME)
    for part in hashes:
        value = (value * scale + part) % PRIME
    return value


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
    """Return the cores that a target is for: its own, or all where the target is only a standard.

    Parameters
    ----------
    target : str
        Name of a target.

    Returns
    -------
    list of str
        Names in `CORES`.

    Examples
    --------
    >>> cores_of("avr")
    ['avr']
    """
    return [target] if target in CORES else list(CORES)
