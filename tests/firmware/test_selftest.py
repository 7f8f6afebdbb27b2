"""The self-test that is shipped: it passes on what was generated, and fails on anything else."""

import re
import subprocess
from pathlib import Path

import pytest
from conftest import made, with_humidity
from toolchain import C_COMPILERS, STRICT, run

from echocal import silicon
from echocal.firmware import Firmware
from echocal.silicon.board import MODE
from echocal.silicon.cores import Qemu

PASSED, FAILED = "echocal self-test: passed\n", "echocal self-test: FAILED\n"


def build(made: Firmware, folder: Path, compiler: str = "gcc", *flags: str) -> Path:
    made.save(folder)
    sources = [folder / name for name in made.files if name.endswith(".c")]
    assert len(sources) == 3
    places = (f"-I{folder}", f"-I{folder / 'selftest'}")
    run(compiler, "-std=c99", "-O2", *STRICT, *places, *flags, *sources, "-o", folder / "selftest.out")
    return folder / "selftest.out"


@pytest.mark.slow
@pytest.mark.parametrize("compiler", C_COMPILERS)
def test_it_passes(case: Firmware, compiler: str, tmp_path: Path) -> None:
    assert run(build(case, tmp_path, compiler)) == PASSED


@pytest.mark.slow
def test_it_passes_over_every_input(case: Firmware, tmp_path: Path) -> None:
    assert run(build(case, tmp_path, "gcc", "-DECHOCAL_EVERY_INPUT")) == PASSED


def test_it_passes_with_humidity(tmp_path: Path) -> None:
    assert run(build(with_humidity(), tmp_path, "gcc", "-DECHOCAL_EVERY_INPUT")) == PASSED


def constants(source: str, made: Firmware) -> list[re.Match[str]]:
    """The longer numbers of the code, the width of the accepted echo codes left out."""
    echo = made.report["device"]["echo"]["codes"]
    width = echo["maximum"] - echo["minimum"]
    code = re.sub(r"/\*.*?\*/", lambda comment: " " * len(comment[0]), source, flags=re.DOTALL)
    return list(re.finditer(rf"\b(?!{width}\b)\d{{4,}}(?=U?L?\b)", code))


@pytest.mark.slow
def test_it_tells_a_wrong_constant(case: Firmware, tmp_path: Path) -> None:
    """The first by the vectors; one in the middle, of a table perhaps, by the hash over all inputs."""
    case.save(tmp_path)
    source, program = tmp_path / "echocal_correction.c", tmp_path / "spoiled"
    text = source.read_text()
    numbers = constants(text, case)
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


@pytest.mark.slow
@pytest.mark.parametrize("core", [name for name, board in silicon.CORES.items() if isinstance(board, Qemu)])
@pytest.mark.parametrize("name", ["product_of_64_bits", "full_table", "humid"])
def test_it_passes_on_every_core(core: str, name: str, tmp_path: Path) -> None:
    """And tells the first vector if the function is another; test_arduino has the ATmega328P."""
    packed = with_humidity("c", "c99") if name == "humid" else made(name)
    packed.save(tmp_path)
    board = silicon.CORES[core]
    assert isinstance(board, Qemu)
    (tmp_path / "echocal_selftest.h").write_text(packed.files["selftest/echocal_selftest.h"])
    test = tmp_path / "selftest.o"
    source = tmp_path / "selftest" / "echocal_selftest.c"
    run(board.compiler, *board.flags, *MODE, "-Os", f"-I{tmp_path}", "-c", source, "-o", test)
    thing = board.compile(packed, tmp_path, "-Os")
    assert int(board.play(thing, "-DSELFTEST", library=(str(test),)), 16) == 0
    spoiled = packed.files["echocal_correction.c"].replace("return ECHOCAL_OUT", "return 1 + ECHOCAL_OUT")
    other = Firmware({**packed.files, "echocal_correction.c": spoiled}, packed.report, packed._twin)
    thing = board.compile(other, tmp_path, "-Os")
    assert int(board.play(thing, "-DSELFTEST", library=(str(test),)), 16) > 0
