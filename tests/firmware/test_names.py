"""Two calibrations in one program: every name of files, functions, macros and guards derives from `name`."""

import re
from pathlib import Path

import pytest
from toolchain import STRICT, run

from echocal import Model, UsageError, firmware, silicon
from echocal.firmware import Firmware

HALF_DEGREES = (0.5, -20.0, 60.0)
MAIN = """
#include "left_tank_correction.h"
#include "left_tank_selftest.h"
#include "echocal_correction.h"
#include "echocal_selftest.h"

int main(void)
{
    const int different = left_tank_distance_um(11690U, 40) != echocal_distance_um(11690U, 40, 10U);
    return ((left_tank_selftest() == 0U) && (echocal_selftest() == 0U) && different) ? 0 : 1;
}
"""


def pair(target: str) -> tuple[Firmware, Firmware]:
    """Two sensors: another delay, another form, another number of arguments."""
    late = Model("cramer", {"fixed_delay": {"delay": 31e-6}})
    table = {"form": "interpolated_table", "max_error": 0.2e-3}
    codes = {"temperature": HALF_DEGREES, "humidity": (0.05, 0.0, 1.0), "max_error": 2e-3}
    left = firmware.generate(late, target, temperature=HALF_DEGREES, name="left_tank", **table)
    return left, firmware.generate(Model("cramer"), target, **codes)


def sources(folder: Path, *made: Firmware) -> list[Path]:
    for one in made:
        one.save(folder)
    (folder / "main.c").write_text(MAIN)
    kept = [folder / name for one in made for name in one.files if name.endswith(("tion.c", "test.c"))]
    assert len(kept) == 4
    return [*kept, folder / "main.c"]


def test_two_link_into_one_program_and_both_selftests_pass(tmp_path: Path) -> None:
    files = sources(tmp_path, *pair("c99"))
    places = (f"-I{tmp_path}", f"-I{tmp_path / 'selftest'}")
    for compiler, language in (("gcc", "-std=c99"), ("clang", "-std=c99"), ("g++", "-std=c++11")):
        as_cpp = ("-x", "c++") if compiler == "g++" else ()
        run(compiler, language, "-O2", *STRICT, *places, *as_cpp, *files, "-o", tmp_path / compiler)
        run(tmp_path / compiler)


def test_the_arrays_of_the_selftest_clash_with_no_name(tmp_path: Path) -> None:
    made = firmware.generate(Model("cramer"), temperature=HALF_DEGREES, name="vector")
    made.save(tmp_path)
    files = [tmp_path / path for path in made.files if path.endswith(("tion.c", "test.c"))]
    for file in files:
        run("gcc", "-std=c99", *STRICT, f"-I{tmp_path}", "-c", file, "-o", tmp_path / "object.o")


def test_two_link_on_an_avr(tmp_path: Path) -> None:
    files = sources(tmp_path, *pair("avr"))
    places = (f"-I{tmp_path}", f"-I{tmp_path / 'selftest'}")
    run(
        "avr-gcc", "-mmcu=atmega328p", "-Os", "-std=c99", *STRICT, *places, *files, "-o", tmp_path / "avr.elf"
    )


@pytest.mark.parametrize(
    "package", ["c", "arduino", "platformio", "esphome", "micropython", "esp-idf", "zephyr", "rust"]
)
def test_a_name_leaves_nothing_of_the_usual_one(package: str) -> None:
    request = {"temperature": HALF_DEGREES, "package": package, "form": "interpolated_table"}
    usual = firmware.generate(Model("cramer"), max_error=0.2e-3, **request)
    made = firmware.generate(Model("cramer"), max_error=0.2e-3, name="b2", **request)
    for path, text in made.files.items():
        left = re.findall(r"\w*echocal_\w*|\w*ECHOCAL_\w*|\bechocal\.\w+|EchocalCorrection", path + text)
        assert not left or path == "report.json", f"{path} still has {set(left)}"
    assert made.report["name"] == "b2"
    assert made.report["output_hash"] == usual.report["output_hash"]
    assert len(made.files) == len(usual.files)


def test_a_named_function_is_measured_alike() -> None:
    usual, named = (
        firmware.generate(Model("cramer"), "avr", temperature=HALF_DEGREES, name=name, measure=True)
        for name in ("echocal", "left_tank")
    )
    assert usual.report["measured"] == named.report["measured"] != []
    assert silicon.measure(named, "cortex-m0") == silicon.measure(usual, "cortex-m0")


@pytest.mark.parametrize("name", ["class", "int", "match", "self", "test", "std", "math", "string"])
def test_a_reserved_word_is_refused_with_the_way_out(name: str) -> None:
    with pytest.raises(UsageError, match=f"is a word of a language or its library; add to it: {name}_1"):
        firmware.generate(Model("cramer"), name=name)


@pytest.mark.parametrize(
    "name", ["", "2b", "Left", "left-tank", "_left", "left_", "a__b", "x" * 20, "größe", "*/"]
)
def test_what_is_no_name_is_refused_before_the_proof(name: str) -> None:
    proofs: list[object] = []
    with pytest.raises(UsageError, match="give lower-case letters, digits and single underscores"):
        firmware.generate(Model("cramer"), name=name, progress=lambda *step: proofs.append(step))
    assert not proofs
