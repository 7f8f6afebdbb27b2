"""Compiling generated firmware with the host's compilers, and running it."""

import subprocess
from pathlib import Path

from echocal import silicon
from echocal.firmware import Firmware

HERE = Path(__file__).parent
SILICON = Path(silicon.__file__).parent
STRICT = ("-Wall", "-Wextra", "-Wconversion", "-Wsign-conversion", "-Wshadow", "-pedantic", "-Werror")
C_COMPILERS = ("gcc", "clang")
CXX_COMPILERS = ("g++", "clang++")


def run(*command: str | Path, text: str = "") -> str:
    """Standard output of a command that must succeed in silence."""
    done = subprocess.run(command, input=text, capture_output=True, text=True, check=False)
    assert done.returncode == 0, f"{' '.join(map(str, command))}\n{done.stdout}{done.stderr}"
    assert not done.stderr, done.stderr
    return done.stdout


def build(made: Firmware, folder: Path, compiler: str = "gcc", *flags: str) -> Path:
    """The harness around generated firmware, compiled without a warning."""
    made.save(folder)
    program = folder / f"harness-{compiler}"
    sources = (folder / "echocal_correction.c", HERE / "harness.c")
    run(
        compiler,
        "-std=c99",
        *STRICT,
        *(flags or ("-O2",)),
        f"-I{folder}",
        f"-I{SILICON}",
        *sources,
        "-o",
        program,
    )
    return program


def hash_of_all(program: Path) -> str:
    return run(program, "all").strip()


def answers(program: Path, inputs: list[tuple[int, int]]) -> list[int]:
    lines = "\n".join(f"{echo} {code}" for echo, code in inputs)
    return [int(line) for line in run(program, "each", text=lines).split()]
