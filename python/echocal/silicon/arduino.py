"""Sketches for an Arduino UNO, compiled with the Arduino core and avr-gcc of Debian.

Core and compilers are used where they are installed, and are no part of this package.
"""

import hashlib
import re
import tempfile
from collections.abc import Iterable, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from functools import cache
from pathlib import Path

from echocal.errors import DataError, UsageError
from echocal.silicon.avr import HEADERS
from echocal.silicon.board import HERE
from echocal.silicon.tools import absent, attempt, compiler_version, kept, run

_DEFINED = re.compile(r"(?P<head>[A-Za-z_][\w:<>,*&\s]*?[\s*&]+(?P<name>\w+)\s*\([^(){};]*\))\s*\{")
_NO_CODE = re.compile(
    r"//(?:\\\n|[^\n])*|/\*.*?(?:\*/|\Z)|\"(?:\\.|[^\"\\\n])*\"|'(?:\\.|[^'\\\n])*'|^[ \t]*\#(?:\\\n|[^\n])*",
    re.DOTALL | re.MULTILINE,
)
_NO_TYPE = re.compile(r"\b(?:template|return|else|operator|class|namespace|typedef)\b")

HARDWARE = Path("/usr/share/arduino/hardware/arduino/avr")
SHIPPED = HERE / "sketches"
SKETCHES = tuple(sorted(path.stem for path in SHIPPED.glob("*.ino")))
"""Sketches that come with this package, by name."""

FLASH_BYTES, RAM_BYTES = 32_256, 2_048  # boards.txt of the core: what the boot loader leaves, and SRAM

_PLACES = (f"-I{HARDWARE / 'cores' / 'arduino'}", f"-I{HARDWARE / 'variants' / 'standard'}")
_UNO = ("-mmcu=atmega328p", "-DF_CPU=16000000L", "-DARDUINO=10807", "-DARDUINO_AVR_UNO", "-DARDUINO_ARCH_AVR")
# The C++ of avr-gcc 5.4 lacks the macro that the core takes from float.h. The linker knows lines by DWARF 2.
_FLAGS = (
    *_UNO,
    "-Os",
    "-gdwarf-2",
    "-ffunction-sections",
    "-fdata-sections",
    "-DDECIMAL_DIG=__DECIMAL_DIG__",
)
_CXX = ("avr-g++", "-std=gnu++11", "-fpermissive", "-fno-exceptions", "-fno-threadsafe-statics")
_LANGUAGES = {
    ".c": ("avr-gcc", "-std=gnu11"),
    ".S": ("avr-gcc", "-x", "assembler-with-cpp"),
    ".cpp": _CXX,
    ".ino": (*_CXX, "-x", "c++"),
}
_ERROR = re.compile(r"^(?P<where>[^\n:]+:\d+):(?:\d+:)? (?:fatal )?error: (?P<what>.+)$", re.MULTILINE)
_LINKED = re.compile(r"^(?P<where>[^\n:]+:\d+|[^\n:]+:\([^)]+\)): (?P<what>.+)$", re.MULTILINE)
_INCLUDED = re.compile(r"^[ \t]*#[ \t]*include[ \t]*[<\"](?P<name>[^>\"]+)[>\"]", re.MULTILINE)
_PACKAGES = {
    "avr-gcc": ("gcc-avr", "avr-libc"),
    "gcc": ("gcc", "libc6-dev"),
    "libsimavr-dev": ("libsimavr-dev",),
    "arduino-core-avr": ("arduino-core-avr",),
}


SIMULATOR_WAY_OUT = f"to install what it needs: apt install {' '.join(_PACKAGES['libsimavr-dev'])}"
"""What to do where the simulator cannot be built or started."""


@dataclass(frozen=True)
class Sketch:
    """A compiled sketch.

    Attributes
    ----------
    name : str
        Name or path that it was compiled from.
    elf : bytes
        Program of the chip.
    serial : int
        Address of ``Serial`` in memory; 0 if the sketch has none.
    """

    name: str
    elf: bytes
    serial: int


def missing_for_sketches() -> list[str]:
    """Return what is not installed of what sketches need.

    Commands and packages of Debian.
    """
    core = () if (HARDWARE / "cores" / "arduino" / "Arduino.h").exists() else ("arduino-core-avr",)
    return [*absent("avr-gcc", "gcc"), *(() if HEADERS.exists() else ("libsimavr-dev",)), *core]


def refuse_missing() -> None:
    """Raise `UsageError` with the command that installs what is missing."""
    lacking = missing_for_sketches()
    if lacking:
        packages = [package for name in lacking for package in _PACKAGES[name]]
        raise UsageError(
            f"to run a sketch on an emulated UNO, {', '.join(lacking)} must be installed: "
            f"apt install {' '.join(packages)}"
        )


def compile_sketch(
    sketch: str | Path, *, libraries: Iterable[str | Path] = (), options: Sequence[str] = ()
) -> Sketch:
    """Compile a sketch for an Arduino UNO.

    Parameters
    ----------
    sketch : str or Path
        Name in `SKETCHES`, or a file ``.ino`` or ``.cpp``. In a folder of its name, as the Arduino IDE keeps
        it, the other sources beside it belong to it.
    libraries : iterable of path
        Folders of Arduino libraries that it includes. The core's own (``Wire``, ``SPI``, ...) are found.
    options : sequence of str
        Further options of the compiler, such as ``-DPOTENTIOMETER`` or ``-Wall``.

    Returns
    -------
    Sketch

    Raises
    ------
    UsageError
        If a tool is not installed, or there is no such sketch.
    DataError
        If it does not compile, or does not fit: the compiler's first error with file and line.

    Examples
    --------
    >>> from echocal import silicon
    >>> silicon.compile_sketch("study").name
    'study'
    """
    refuse_missing()
    main = _file_of(sketch)
    folders = [Path(path) for path in libraries]
    for folder in folders:
        if not folder.is_dir():
            message = f"library {folder} is no folder: name the one with the library's headers or its src"
            raise UsageError(message)
    with tempfile.TemporaryDirectory(prefix="echocal-") as name:
        folder = Path(name)
        parts, places = _parts(main, folders)
        flags = (*options, *(f"-I{place}" for place in places))
        with ThreadPoolExecutor(2) as pool:
            jobs = [
                pool.submit(_compiled, path, folder / f"{number}.o", flags)
                for number, path in enumerate(parts)
            ]
            objects = [job.result() for job in jobs]
        out = folder / "sketch.elf"
        _link(out, objects)
        symbols = [line.split() for line in run("avr-nm", out).splitlines()]
        where = [words[0] for words in symbols if words[-1] == "Serial" and len(words) == 3]
        address = int(where[0], 16) & 0xFFFF if where else 0  # the tools add 0x800000 to those of memory
        return Sketch(str(sketch), out.read_bytes(), address)


def simulated_uno() -> Path:
    """Return the program that simulates the board, compiled once."""
    source = HERE / "uno.c"
    config = HEADERS.with_name("sim_core_config.h").read_bytes()
    name = f"uno-{hashlib.sha256(source.read_bytes() + config).hexdigest()[:16]}"

    def fill(folder: Path) -> None:
        words = ("-O2", "-Wall", "-Wextra", "-Werror", source, "-o", folder / "uno", "-lsimavr", "-lm")
        code, _, said = attempt("gcc", *words)
        if code != 0:
            raise UsageError(f"gcc cannot build the simulated UNO: {_first_line(said)}; {SIMULATOR_WAY_OUT}")

    return kept(name, fill) / "uno"


def _first_line(said: str) -> str:
    return next(iter(said.strip().splitlines()), "no reason is told")


@cache
def _core() -> Path:
    """Return the core as an archive, compiled once for each version of core and compiler."""
    sources = sorted((HARDWARE / "cores" / "arduino").iterdir())
    pins = HARDWARE / "variants" / "standard" / "pins_arduino.h"
    told = repr((compiler_version("avr-gcc"), _FLAGS, _LANGUAGES)).encode()
    digest = hashlib.sha256(told + b"".join(path.read_bytes() for path in (*sources, pins)))

    def fill(folder: Path) -> None:
        own = [path for path in sources if path.suffix in _LANGUAGES]
        with ThreadPoolExecutor(2) as pool:
            objects = list(pool.map(lambda path: _compiled(path, folder / f"{path.name}.o", ("-w",)), own))
        run("avr-ar", "rcs", folder / "core.a", *objects)
        for one in objects:
            one.unlink()

    return kept(f"arduino-core-{digest.hexdigest()[:16]}", fill) / "core.a"


def _file_of(sketch: str | Path) -> Path:
    if sketch in SKETCHES:
        return SHIPPED / f"{sketch}.ino"
    path = Path(sketch)
    if path.is_dir():
        path = path / f"{path.resolve().name}.ino"
    if not path.is_file():
        raise UsageError(f"no sketch '{sketch}': it is neither a file nor one of {', '.join(SKETCHES)}")
    if path.suffix not in (".ino", ".cpp"):
        raise UsageError(f"{path} is no sketch: its name does not end with .ino or .cpp")
    return path


def _parts(main: Path, libraries: Sequence[Path]) -> tuple[list[Path], list[Path]]:
    """Return the sources to compile, and the folders of headers."""
    beside = main.resolve().parent.name == main.stem
    own = _sources(main.parent, deep=False) if beside else []
    own += _sources(main.parent / "src") if beside else []
    parts = [main, *(path for path in own if path != main)]
    folders = [*libraries, *_of_the_core(parts)]
    places = [folder / "src" if (folder / "src").is_dir() else folder for folder in folders]
    return [*parts, *(path for place in places for path in _sources(place))], [main.parent, *places]


def _sources(folder: Path, *, deep: bool = True) -> list[Path]:
    found = folder.rglob("*") if deep else folder.glob("*")
    return sorted(path for path in found if path.suffix in _LANGUAGES and path.suffix != ".ino")


def _of_the_core(parts: Iterable[Path]) -> list[Path]:
    """Return the libraries that come with the core, as far as these files include them."""
    texts = (path.read_text(encoding="utf-8", errors="replace") for path in parts)
    names = dict.fromkeys(
        match["name"].removesuffix(".h") for text in texts for match in _INCLUDED.finditer(text)
    )
    folders = [HARDWARE / "libraries" / name for name in names if "/" not in name]
    return [folder for folder in folders if folder.is_dir()]


def _compiled(source: Path, out: Path, flags: Sequence[str]) -> Path:
    if source.suffix == ".ino":
        written = source.read_text(encoding="utf-8-sig", errors="replace")
        text = with_prototypes(written, str(source))
        read = out.with_suffix(".ino")
        read.write_text(text, encoding="utf-8")
    else:
        read = source
    code, _, said = attempt(*_LANGUAGES[source.suffix], *_FLAGS, *_PLACES, *flags, "-c", read, "-o", out)
    if code != 0:
        _refuse(said, _ERROR, source)
    return out


def _link(out: Path, objects: Sequence[Path]) -> None:
    options = ("-mmcu=atmega328p", "-Wl,--gc-sections")
    code, _, said = attempt("avr-gcc", *options, *objects, _core(), "-lm", "-o", out)
    if "is not within region `data'" in said or "overflowed" in said:
        raise DataError(
            f"the sketch needs more than the {RAM_BYTES} bytes of memory or {FLASH_BYTES} of flash of an UNO"
        )
    if code != 0:
        _refuse(said, _LINKED, None)
    text, data, bss = map(int, run("avr-size", out).splitlines()[1].split()[:3])
    for what, needed, there in (("flash", text + data, FLASH_BYTES), ("memory", data + bss, RAM_BYTES)):
        if needed > there:
            raise DataError(f"the sketch needs {needed} bytes of {what}; an UNO has {there}")


def _refuse(said: str, pattern: re.Pattern[str], source: Path | None) -> None:
    """Raise the first error; one within a header with the place in the sketch that it comes from."""
    match = pattern.search(said)
    told = _first_line(said)
    if match:
        told = f"{match['where']}: {match['what']}"
        own = re.search(rf"{re.escape(str(source))}:\d+", said[match.end() :])
        told += f" (from {own[0]})" if own and not told.startswith(str(source)) else ""
    raise DataError(f"the sketch does not compile: {told}")


def with_prototypes(text: str, path: str) -> str:
    r"""Return the sketch as C++: functions may be called above their definition.

    Only these are declared. Functions with default arguments, templates and members of classes are not.
    Messages of the compiler name the sketch's own file and lines.

    Examples
    --------
    >>> print(with_prototypes("void loop() { wink(); }\nvoid wink() { }\n", "a.ino"))
    #include <Arduino.h>
    #line 1 "a.ino"
    void wink();
    #line 1 "a.ino"
    void loop() { wink(); }
    void wink() { }
    <BLANKLINE>
    """
    code = _NO_CODE.sub(lambda match: re.sub(r"[^\n]", " ", match[0]), text)
    defined = [match for match in _DEFINED.finditer(_outermost(code)) if _declarable(match["head"])]
    found = [match for match in defined if re.search(rf"\b{match['name']}\s*\(", code[: match.start()])]
    quoted = path.replace("\\", "\\\\").replace('"', '\\"')
    start = f'#include <Arduino.h>\n#line 1 "{quoted}"\n'
    if not found:
        return start + text
    place = text.rfind("\n", 0, defined[0].start("head")) + 1
    declared = "".join(f"{' '.join(match['head'].split())};\n" for match in found)
    number = text.count("\n", 0, place) + 1
    return f'{start}{text[:place]}{declared}#line {number} "{quoted}"\n{text[place:]}'


def _declarable(head: str) -> bool:
    return "=" not in head and "::" not in head.split("(")[0] and not _NO_TYPE.search(head)


def _outermost(code: str) -> str:
    """Return the code with blanks for all that is within braces; the braces stay."""
    depth, kept = 0, []
    for sign in code:
        depth -= sign == "}"
        kept.append(sign if depth <= 0 or sign == "\n" else " ")
        depth += sign == "{"
    return "".join(kept)
