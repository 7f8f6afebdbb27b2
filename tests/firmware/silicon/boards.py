"""Generated firmware on simulated silicon: the hash over its inputs, and what it costs there.

An ATmega328P in libsimavr, cycle by cycle; Cortex-M and RISC-V cores in QEMU, which counts instructions.
"""

import re
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

from toolchain import STRICT, run

from echocal.firmware import Firmware

HERE = Path(__file__).parent
SEED = 2_166_136_261
ROWS_EACH = 50  # of one simulator process


@dataclass(frozen=True)
class Cost:
    """What a call costs; ``steps`` are cycles on AVR and instructions elsewhere, its return included."""

    flash: int  # bytes, with what it takes from the compiler's library
    own: int  # bytes of the function and its tables alone
    ram: int  # bytes of variables of static storage duration
    stack: int  # bytes, return address included where there is one
    steps: int


@dataclass(frozen=True)
class Board:
    """A core, its compiler, and the machine that plays it."""

    name: str
    compiler: str
    flags: tuple[str, ...]
    machine: tuple[str, ...] = ()
    flash: str = "0"
    ram: str = "0x20000000"
    tick: float = 1.0  # instructions
    start: str = "start_arm.c"

    @cached_property
    def version(self) -> str:
        """Major version of the compiler, for ceilings."""
        return run(self.compiler, "-dumpversion").strip().split(".")[0]

    def compile(self, made: Firmware, folder: Path, level: str, *, strict: bool = True) -> Path:
        """The object file, compiled without a warning if `strict`."""
        made.save(folder)
        out = folder / f"{self.name}{level}.o"
        mode = ("-std=c99", "-ffreestanding", "-ffunction-sections", "-fstack-usage")
        mode += STRICT if strict else ()
        run(self.compiler, *self.flags, *mode, level, "-c", folder / "echocal_correction.c", "-o", out)
        return out

    def sizes(self, thing: Path) -> dict[str, int]:
        """Bytes of text with constants, initialized data and zeroed data."""
        tool = self.compiler.replace("gcc", "size")
        words = run(tool, thing).splitlines()[1].split()
        return dict(zip(("text", "data", "bss"), map(int, words), strict=False))

    def link(self, thing: Path, *more: str | Path) -> Path:
        """The function, and what it takes from the compiler's library, alone."""
        out = thing.with_suffix(".elf")
        entry = ("-nostdlib", "-Wl,--gc-sections,-e,echocal_distance_um,-u,echocal_distance_um")
        run(self.compiler, *self.flags, thing, *entry, *more, "-lgcc", "-o", out)
        return out

    def measure(self, made: Firmware, folder: Path, level: str = "-Os") -> Cost:
        """Flash, memory and steps of one call."""
        thing = self.compile(made, folder, level)
        own, whole = self.sizes(thing), self.sizes(self.link(thing))
        usage = re.findall(r"\t(\d+)\tstatic", thing.with_suffix(".su").read_text())
        assert len(usage) == 1
        steps, stack = self.steps(thing, made, int(usage[0]))
        flash = whole["text"] + whole["data"]
        return Cost(flash, own["text"] + own["data"], whole["data"] + whole["bss"], stack, steps)

    def steps(self, thing: Path, made: Firmware, stack: int) -> tuple[int, int]:
        """Instructions of one call with its return, and bytes of stack."""
        idle, busy = (int(line, 16) for line in self.play(thing, "-DCOUNT").split())
        calls = (busy - idle) * self.tick / 100_000
        assert abs(calls - round(calls)) < 0.01, "not the same for all calls"
        return round(calls) + 1, stack

    def hash_of_all(self, made: Firmware, folder: Path, level: str = "-Os") -> str:
        """The hash over every accepted input, computed on the board."""
        return self.play(self.compile(made, folder, level)).strip()

    def play(self, thing: Path, *flags: str) -> str:
        """What the board prints."""
        out = thing.with_name(f"{self.name}-board.elf")
        place = ("-T", HERE / "board.ld", f"-Wl,--defsym,FLASH={self.flash},--defsym,RAM={self.ram}")
        sources = (HERE / "board.c", HERE / self.start, thing)
        bare = ("-std=gnu99", "-O2", "-ffreestanding", "-nostdlib", f"-I{thing.parent}")
        run(self.compiler, *self.flags, *bare, *flags, *sources, *place, "-lgcc", "-o", out)
        speaking = ("-display", "none", "-monitor", "none", "-serial", "none", "-chardev", "stdio,id=host")
        speaking += ("-semihosting-config", "enable=on,target=native,chardev=host")
        counting = ("-icount", "shift=0") if flags else ()
        return run(*self.machine, *speaking, *counting, "-kernel", out)


class Avr(Board):
    """An ATmega328P; every call is made by the driver, which counts its cycles."""

    def drive(self, thing: Path, made: Firmware, step: int) -> tuple[list[int], list[tuple[int, ...]]]:
        """Hashes of the rows, and for each process the fewest and most cycles and the stack."""
        device = made.report["device"]
        codes = device["conditions"][0]["codes"]
        chip, driver = thing.with_name("avr-call.elf"), thing.with_name("avr-driver")
        bare = ("-nostartfiles", "-Wl,--gc-sections,-e,once")
        run(self.compiler, *self.flags, HERE / "avr_stub.S", thing, *bare, "-lm", "-o", chip)
        run("gcc", "-O2", "-Wall", "-Wextra", "-Werror", HERE / "avr_driver.c", "-o", driver, "-lsimavr")
        first, last = codes["minimum"], codes["maximum"]
        spans = [
            (low, min(last, low + ROWS_EACH * step - 1)) for low in range(first, last + 1, ROWS_EACH * step)
        ]

        def part(span: tuple[int, int]) -> list[str]:
            damp = [axis["codes"] for axis in device["conditions"][1:]]
            ends = [axis[end] for axis in damp for end in ("minimum", "maximum")]
            words = (device["echo"]["codes"]["maximum"], *span, step, *ends)
            return [
                line
                for line in run(driver, chip, *map(str, words)).splitlines()
                if not line.startswith("Loaded")
            ]

        with ThreadPoolExecutor(4) as pool:
            parts = list(pool.map(part, spans))
        rows = [int(line, 16) for lines in parts for line in lines[:-1]]
        return rows, [tuple(map(int, lines[-1].split())) for lines in parts]

    def steps(self, thing: Path, made: Firmware, stack: int) -> tuple[int, int]:
        """Cycles of one call, `call` and `ret` included, the same for a sample of rows at every echo time."""
        codes = made.report["device"]["conditions"][0]["codes"]
        _, found = self.drive(thing, made, max(1, codes["maximum"] - codes["minimum"]))
        ((fewest, most, stack),) = found
        assert fewest == most, "constant time"
        return most, stack

    def hash_of_all(self, made: Firmware, folder: Path, level: str = "-Os") -> str:
        """The hash over every accepted input, one call each, all of them in the same number of cycles."""
        rows, found = self.drive(self.compile(made, folder, level), made, 1)
        assert len({cycles for line in found for cycles in line[:2]}) == 1, "constant time"
        return f"{folded(rows):08x}"


def folded(words: list[int]) -> int:
    """The hash that ``prove`` defines, over rows."""
    value = SEED
    for word in words:
        value = ((value ^ word) * 16_777_619) & 0xFFFF_FFFF
    return value


def cortex(name: str, machine: str, tick: float, *flags: str) -> Board:
    core = name if flags == () else name.rstrip("f")
    return Board(
        name,
        "arm-none-eabi-gcc",
        (f"-mcpu={core}", "-mthumb", *flags),
        ("qemu-system-arm", "-M", machine),
        tick=tick,
    )


BOARDS = {
    board.name: board
    for board in (
        Avr("avr", "avr-gcc", ("-mmcu=atmega328p",)),
        cortex("cortex-m0", "microbit", 62.5),  # 16 MHz
        cortex("cortex-m3", "mps2-an385", 40.0),  # 25 MHz
        cortex("cortex-m4f", "mps2-an386", 40.0, "-mfpu=fpv4-sp-d16", "-mfloat-abi=hard"),
        Board(
            "rv32",
            "riscv64-unknown-elf-gcc",
            ("-march=rv32imac_zicsr", "-mabi=ilp32"),
            ("qemu-system-riscv32", "-M", "virt", "-bios", "none"),
            flash="0x80000000",
            ram="0x80100000",
            start="start_riscv.S",
        ),
    )
}
