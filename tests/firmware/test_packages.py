"""Packagings: which files, the same function in each, and what can be run of them on a PC."""

import configparser
import json
from pathlib import Path

import pytest
from conftest import made

from echocal import Model, UsageError, firmware

C = ("echocal_correction.c", "echocal_correction.h", "echocal_selftest.c", "echocal_selftest.h")
FILES = {
    "c": {*C[:2], *(f"selftest/{name}" for name in C[2:]), "selftest/echocal_selftest_main.c"},
    "arduino": {
        "examples/HcSr04/HcSr04.ino",
        "examples/SelfTest/SelfTest.ino",
        "keywords.txt",
        "library.properties",
        *(f"src/{name}" for name in C),
    },
    "platformio": {
        "lib/EchocalCorrection/library.json",
        *(f"lib/EchocalCorrection/src/{name}" for name in C),
        "platformio.ini",
        "src/main.cpp",
        "test/test_selftest/test_selftest.cpp",
    },
    "esphome": {"echocal.yaml", *C[:2]},
    "micropython": {"echocal_correction.py", "echocal_selftest.py", "main.py"},
}


@pytest.mark.parametrize("package", FILES)
def test_the_files_of_a_package(package: str, tmp_path: Path) -> None:
    packed = made("avr_table", package)
    packed.save(tmp_path)
    found = {str(path.relative_to(tmp_path)) for path in tmp_path.rglob("*") if path.is_file()}
    assert found == {*FILES[package], "echocal_golden.csv", "report.json", "SHA256SUMS"}
    assert packed.report["provenance"]["package"] == package


@pytest.mark.parametrize("package", [name for name in FILES if name != "micropython"])
def test_every_package_holds_the_same_c(package: str) -> None:
    plain, packed = made("avr_table"), made("avr_table", package)
    (source,) = (text for path, text in packed.files.items() if path.endswith("correction.c"))
    assert source == plain.files["echocal_correction.c"]
    (header,) = (text for path, text in packed.files.items() if path.endswith("correction.h"))
    without = header.replace(f" --package {package}", "")
    assert without == plain.files["echocal_correction.h"], "only the command differs"


def test_an_unknown_package_is_refused_before_the_proof() -> None:
    proofs: list[object] = []
    with pytest.raises(UsageError, match="unknown package 'deb'; this version has c, arduino, platformio"):
        firmware.generate(Model("cramer"), package="deb", progress=lambda *step: proofs.append(step))
    assert not proofs


def test_platformio_reads_its_manifests() -> None:
    packed = made("avr_table", "platformio")
    library = json.loads(packed.files["lib/EchocalCorrection/library.json"])
    assert library["license"] == "MIT OR Apache-2.0"
    project = configparser.ConfigParser()
    project.read_string(packed.files["platformio.ini"])
    assert project["env:uno"]["platform"] == "atmelavr"
    word = configparser.ConfigParser()
    word.read_string(made("word_of_32_bits", "platformio").files["platformio.ini"])
    assert word.sections() == ["env:nucleo_f072rb"], "a board of the target"
