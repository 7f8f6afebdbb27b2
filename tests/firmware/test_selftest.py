"""The self-test that is shipped: it passes on what was generated, and fails on anything else."""

import re
import subprocess
from pathlib import Path

import pytest
from conftest import with_humidity
from toolchain import C_COMPILERS, STRICT, run

from echocal.firmware import Firmware

PASSED, FAILED = "echocal self-test: passed\n", "echocal self-test: FAILED\n"


def build(made: Firmware, folder: Path, compiler: str = "gcc", *flags: str) -> Path:
    made.save(folder)
    sources = [folder / name for name in made.files if name.endswith(".c")]
    assert len(sources) == 3
    places = (f"-I{folder}", f"-I{folder / 'selftest'}")
    run(compiler, "-std=c99", "-O2", *STRICT, *places, *flags, *sources, "-o", folder / "selftest.out")
    return folder / "selftest.out"


@pytest.mark.parametrize("compiler", C_COMPILERS)
def test_it_passes(case: Firmware, compiler: str, tmp_path: Path) -> None:
    assert run(build(case, tmp_path, compiler)) == PASSED


def test_it_passes_over_every_input(case: Firmware, tmp_path: Path) -> None:
    assert run(build(case, tmp_path, "gcc", "-DECHOCAL_EVERY_INPUT")) == PASSED


def test_it_passes_with_humidity(tmp_path: Path) -> None:
    assert run(build(with_humidity(), tmp_path, "gcc", "-DECHOCAL_EVERY_INPUT")) == PASSED


def constants(source: str) -> list[re.Match[str]]:
    """The longer numbers of the code, limits of codes left out."""
    code = re.sub(r"/\*.*?\*/", lambda comment: " " * len(comment[0]), source, flags=re.DOTALL)
    return list(re.finditer(r"\b(?!38000|65535)\d{4,}(?=U?L?\b)", code))


def test_it_tells_a_wrong_constant(case: Firmware, tmp_path: Path) -> None:
    """The first by the vectors; one in the middle, of a table perhaps, by the hash over all inputs."""
    case.save(tmp_path)
    source, program = tmp_path / "echocal_correction.c", tmp_path / "spoiled"
    text = source.read_text()
    numbers = constants(text)
    for number, flag in ((numbers[0], "-O2"), (numbers[len(numbers) // 2], "-DECHOCAL_EVERY_INPUT")):
        spoiled = str(int(number[0]) * 17 // 16)
        source.write_text(text[: number.start()] + spoiled + text[number.end() :])
        places = (f"-I{tmp_path}", f"-I{tmp_path / 'selftest'}")
        parts = (source, *(tmp_path / "selftest").glob("*.c"))
        run("gcc", "-std=c99", "-O2", "-w", flag, *places, *parts, "-o", program)
        done = subprocess.run([program], capture_output=True, text=True, check=False)
        assert (done.returncode, done.stdout) == (1, FAILED), f"{number[0]} spoiled and not seen"


def test_without_a_standard_library_it_speaks_by_its_exit_code(tmp_path: Path) -> None:
    made = with_humidity()
    build(made, tmp_path, "gcc", "-ffreestanding")
    assert run(tmp_path / "selftest.out") == ""
