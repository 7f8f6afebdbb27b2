"""Sketches compiled with the Arduino core of Debian, run on a simulated UNO with a virtual HC-SR04."""

from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

from toolchain import run

from echocal.firmware import Firmware

HERE = Path(__file__).parent
HARDWARE = Path("/usr/share/arduino/hardware/arduino/avr")
PLACES = (f"-I{HARDWARE / 'cores' / 'arduino'}", f"-I{HARDWARE / 'variants' / 'standard'}")
UNO = ("-mmcu=atmega328p", "-DF_CPU=16000000L", "-DARDUINO=10807", "-DARDUINO_AVR_UNO", "-DARDUINO_ARCH_AVR")
# The C++ of avr-gcc 5.4 lacks the macro that the core takes from float.h.
FLAGS = (*UNO, "-Os", "-ffunction-sections", "-fdata-sections", "-DDECIMAL_DIG=__DECIMAL_DIG__", *PLACES)
LANGUAGES = {
    ".c": ("avr-gcc", "-std=gnu11"),
    ".S": ("avr-gcc", "-x", "assembler-with-cpp"),
    ".cpp": ("avr-g++", "-std=gnu++11", "-fno-exceptions", "-fno-threadsafe-statics"),
    ".ino": ("avr-g++", "-std=gnu++11", "-fno-exceptions", "-fno-threadsafe-statics", "-x", "c++"),
}
WARNINGS = ("-Wall", "-Wextra", "-Werror")


def compile_one(source: Path, out: Path, *flags: str) -> Path:
    run(*LANGUAGES[source.suffix], *FLAGS, *flags, "-c", source, "-o", out)
    return out


def build_core(folder: Path) -> None:
    """Fill a folder with the core as an archive, and the simulated board."""
    sources = [path for path in (HARDWARE / "cores" / "arduino").iterdir() if path.suffix in LANGUAGES]
    with ThreadPoolExecutor(2) as pool:
        objects = list(pool.map(lambda path: compile_one(path, folder / f"{path.name}.o", "-w"), sources))
    run("avr-ar", "rcs", folder / "core.a", *objects)
    run("gcc", "-O2", *WARNINGS, HERE / "uno.c", "-o", folder / "uno", "-lsimavr")


def link(packed: Firmware, sketch: str, core: Path, folder: Path, *flags: str) -> Path:
    """A sketch of a package with the library beside it, without a warning."""
    packed.save(folder)
    headers = {f"-I{(folder / path).parent}" for path in packed.files if path.endswith(".h")}
    parts = [folder / path for path in packed.files if path.endswith(".c")]
    objects = [
        compile_one(path, folder / f"{path.stem}.o", *WARNINGS, *headers, *flags)
        for path in (*parts, folder / sketch)
    ]
    out = folder / "sketch.elf"
    run("avr-gcc", "-mmcu=atmega328p", "-Wl,--gc-sections", *objects, core / "core.a", "-lm", "-o", out)
    return out


def serial(core: Path, sketch: Path, millivolts: tuple[int, int], echoes: list[int]) -> list[str]:
    """The lines that the sketch sends, one echo [us] after each of its trigger pulses."""
    lines = run(core / "uno", sketch, *map(str, (*millivolts, *echoes))).splitlines()
    return [line for line in lines if not line.startswith("Loaded")]
