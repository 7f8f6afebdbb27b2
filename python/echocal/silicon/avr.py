"""An ATmega328P in libsimavr, cycle by cycle: every call is made by a driver that counts.

The simulator is GPL-3: it is used where it is installed, and is no part of this package.
"""

from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

from echocal.errors import EchocalError
from echocal.silicon.board import HERE, Board, Calls, Generated, axes, function, strides
from echocal.silicon.tools import run

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

    def driver(self, thing: Path, made: Generated, *library: str) -> tuple[Path, Path]:
        """Return the program that makes the calls, and the chip's."""
        name, places = function(made), _registers(made)
        chip, driver = thing.with_name("avr-call.elf"), thing.with_name("avr-driver")
        bare = ("-nostartfiles", "-Wl,--gc-sections,-e,once")
        stub = (f"-DDISTANCE={name}", HERE / "avr_stub.S")
        run(self.compiler, *self.flags, *stub, thing, *bare, *library, "-o", chip)
        strict = ("-O2", "-Wall", "-Wextra", "-Werror")
        run("gcc", *strict, *places, HERE / "avr_driver.c", "-o", driver, *LIBRARY)
        return driver, chip

    def drive(
        self, thing: Path, made: Generated, steps: Sequence[int], *library: str
    ) -> tuple[list[int], list[Calls]]:
        """Return the hashes of the rows, and for each process the cost of its calls."""
        driver, chip = self.driver(thing, made, *library)
        echo, (first, last), *others = axes(made)
        step, *apart = steps
        length = ROWS_EACH * step
        spans = [(low, min(last, low + length - step)) for low in range(first, last + 1, length)]
        ends = [str(word) for axis, one in zip(others, apart, strict=True) for word in (*axis, one)]

        def part(span: tuple[int, int]) -> list[str]:
            lines = run(driver, chip, *map(str, (*echo, *span, step)), *ends).splitlines()
            return [line for line in lines if not line.startswith("Loaded")]

        with ThreadPoolExecutor(PARALLEL) as pool:
            parts = list(pool.map(part, spans))
        rows = [int(line, 16) for lines in parts for line in lines[:-1]]
        return rows, [Calls(*map(int, lines[-1].split())) for lines in parts]

    def calls(self, thing: Path, made: Generated, *library: str) -> Calls:
        """Cycles of a call with its return, over every echo code at the ends of each condition."""
        return self.sampled(thing, made, [max(1, last - first) for first, last in axes(made)[1:]], *library)

    def sampled(self, thing: Path, made: Generated, steps: Sequence[int], *library: str) -> Calls:
        """Cycles of a call over every echo code, and every so many codes of each condition."""
        _, found = self.drive(thing, made, steps, *library)
        fewest, most = min(part.fewest for part in found), max(part.most for part in found)
        return Calls(fewest, most, max(part.stack for part in found))

    def output_hash(self, thing: Path, made: Generated) -> str:
        """Hash over every accepted input, one call each, all of them in the same number of cycles."""
        rows, found = self.drive(thing, made, strides(made))
        fewest, most = min(part.fewest for part in found), max(part.most for part in found)
        if fewest != most:
            raise EchocalError(f"not of constant time: calls take {fewest} to {most} cycles")
        first, last = axes(made)[0]
        return f"{joined(rows, last - first + 1):016x}"


def _registers(made: Generated) -> tuple[str, ...]:
    """Return macros for the first register of each argument, and whether the result has 16 bits."""
    device = made.report["device"]
    given = {"ECHO": "u16", "TEMPERATURE": "i16", "HUMIDITY": "u8", "FURTHER": "u16"}
    given |= {
        name: axis.get("type", given[name])
        for name, axis in zip(given, (device["echo"], *device["conditions"]), strict=False)
    }
    place, macros = 26, []
    for name, kind in given.items():
        place -= 4 if kind.endswith("32") else 2
        macros.append(f"-D{name}={place}")
    short = device.get("output", {}).get("type", "i32") == "i16"
    return (*macros, f"-DSHORT={int(short)}")


def joined(hashes: list[int], length: int) -> int:
    """Return the hash of all outputs (firmware_gen/src/hash.rs) from those of parts of one length."""
    value, scale = 0, pow(BASE, length, PRIME)
    for part in hashes:
        value = (value * scale + part) % PRIME
    return value
