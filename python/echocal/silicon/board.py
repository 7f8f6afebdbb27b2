"""A core, its compiler, and the simulator that plays it."""

import re
from abc import ABC, abstractmethod
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any, Protocol

from echocal.silicon.tools import absent, compiler_version, run

HERE = Path(__file__).parent
DEFAULT = "echocal"
STRICT = ("-Wall", "-Wextra", "-Wconversion", "-Wsign-conversion", "-Wshadow", "-pedantic", "-Werror")
MODE = ("-std=c99", "-ffreestanding", "-ffunction-sections", "-fstack-usage")


class Generated(Protocol):
    """What is measured: C text by path, and a report that names the codes."""

    @property
    def files(self) -> Mapping[str, str]:
        """Text by path."""

    @property
    def report(self) -> Mapping[str, Any]:
        """What was proven."""


@dataclass(frozen=True)
class Calls:
    """What calls cost: the fewest and the most cycles or instructions of one, and its stack [byte]."""

    fewest: int
    most: int
    stack: int


@dataclass(frozen=True)
class Board(ABC):
    """A core, its compiler, and the simulator that plays it."""

    name: str
    compiler: str
    flags: tuple[str, ...]
    counts_cycles = False

    @property
    @abstractmethod
    def tools(self) -> tuple[str, ...]:
        """Commands that must be installed."""

    @cached_property
    @abstractmethod
    def simulator(self) -> str:
        """The simulator, with its version."""

    @abstractmethod
    def calls(self, thing: Path, made: Generated, *library: str) -> Calls:
        """Cost of a call of the function in an object file, return included."""

    @abstractmethod
    def output_hash(self, thing: Path, made: Generated) -> str:
        """Hash over every accepted input, computed on the core."""

    def missing(self) -> list[str]:
        """Return what is not installed of what is needed."""
        return absent(*self.tools)

    @cached_property
    def version(self) -> str:
        """Version of the compiler."""
        return compiler_version(self.compiler)

    def compile(self, made: Generated, folder: Path, options: str, *, strict: bool = True) -> Path:
        """Return the object file, compiled without a warning if `strict`."""
        name = called(made)
        source = folder / f"{name}_correction.c"
        for path, text in made.files.items():
            if path.endswith((source.name, f"{name}_correction.h")):
                (folder / Path(path).name).write_text(text, encoding="utf-8")
        if name != DEFAULT:
            header = (folder / f"{name}_correction.h").read_text(encoding="utf-8")
            (folder / f"{DEFAULT}_correction.h").write_text(_alias(name, header), encoding="utf-8")
        out = folder / f"{self.name}{options.replace(' ', '')}.o"
        warnings = STRICT if strict else ("-w",)
        run(self.compiler, *self.flags, *MODE, *warnings, *options.split(), "-c", source, "-o", out)
        return out

    def sizes(self, linked: Path) -> dict[str, int]:
        """Return bytes of text with constants, initialized data and zeroed data."""
        words = run(self.compiler.replace("gcc", "size"), linked).splitlines()[1].split()
        return dict(zip(("text", "data", "bss"), map(int, words), strict=False))

    def own(self, linked: Path, name: str = DEFAULT) -> int:
        """Return bytes of the function and its tables, all of which are named alike."""
        return sum(size for size, _, symbol in self._symbols(linked) if symbol.startswith(f"{name}_"))

    def variables(self, linked: Path) -> int:
        """Return bytes of variables; a linker's section may be longer, by what aligns its end."""
        return sum(size for size, kind, _ in self._symbols(linked) if kind in "bBdD")

    def _symbols(self, linked: Path) -> list[tuple[int, str, str]]:
        """Size, kind and name of each symbol that has a size."""
        lines = run(self.compiler.replace("gcc", "nm"), "--print-size", linked).splitlines()
        words = (line.split() for line in lines)
        return [(int(word[1], 16), word[2], word[3]) for word in words if len(word) == 4]

    def link(self, thing: Path, name: str, *more: str | Path) -> Path:
        """Return the function of this name with what it takes from the compiler's library, alone."""
        out = thing.with_suffix(".elf")
        entry = ("-nostdlib", f"-Wl,--gc-sections,-e,{name},-u,{name}")
        run(self.compiler, *self.flags, thing, *entry, *more, "-lgcc", "-o", out)
        return out


def axes(made: Generated) -> list[tuple[int, int]]:
    """Return the first and last code of the echo and of each condition."""
    device = made.report["device"]
    codes = [axis["codes"] for axis in (device["echo"], *device["conditions"])]
    return [(axis["minimum"], axis["maximum"]) for axis in codes]


def strides(made: Generated) -> list[int]:
    """Return the codes in a step that the function tells apart, of each condition."""
    return [1 << axis.get("shift", 0) for axis in made.report["device"]["conditions"]]


def called(made: Generated) -> str:
    """Return what the names of the files and functions begin with."""
    return str(made.report.get("name", DEFAULT))


def _alias(name: str, header: str) -> str:
    """Return a header that gives the macros of another their usual names, by which board.c knows them."""
    macros = re.findall(rf"^#define {name.upper()}_(\w+)", header, re.MULTILINE)
    lines = [f"#define {DEFAULT.upper()}_{macro} {name.upper()}_{macro}" for macro in macros]
    return "\n".join([f'#include "{name}_correction.h"', *lines, ""])


def function(made: Generated) -> str:
    """Return the name of the function."""
    output = made.report["device"].get("output", {"unit": "um"})
    return f"{called(made)}_distance_{output.get('suffix', output['unit'])}"


def definitions(made: Generated) -> tuple[str, ...]:
    """Return the macros by which a program for the board knows the function and the types of its codes."""
    device = made.report["device"]
    given = zip(_places(made), (device["echo"], *device["conditions"]), strict=True)
    types = [f"-D{name}={_type(axis['type'])}" for name, axis in given if "type" in axis]
    if "FURTHER" in _places(made):
        (first, last), step = axes(made)[-1], strides(made)[-1]
        types += [f"-DFURTHER_FIRST={first}", f"-DFURTHER_LAST={last}", f"-DFURTHER_STEP={step}"]
    result = f"-DRESULT={_type(device.get('output', {}).get('type', 'i32'))}"
    return f"-DDISTANCE={function(made)}", result, *types


def _places(made: Generated) -> tuple[str, ...]:
    """Return the macro for the type of each argument."""
    names = {"temperature": "CODE", "relative_humidity": "DAMP"}
    conditions = made.report["device"]["conditions"]
    return ("ECHO", *(names.get(axis["quantity"], "FURTHER") for axis in conditions))


def _type(short: str) -> str:
    """Name in C of a type such as u16."""
    return f"{'u' if short[0] == 'u' else ''}int{short[1:]}_t"
