"""Packagings: which files, the same function in each, and what can be run of them on a PC."""

import configparser
import json
from pathlib import Path

import pytest
import yaml
from conftest import made, with_humidity
from toolchain import run

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


# What ESPHome puts around a lambda of a filter, and what its ultrasonic sensor gives it.
ESPHOME = """
#include <cmath>
#include <cstdio>
#include <optional>
#include "echocal_correction.h"
struct Sensor { float state; };
static Sensor air_temperature, air_humidity;
static Sensor &id(Sensor &sensor) { return sensor; }
static std::optional<float> filter(float x) {
%s
}
static float us_to_m(unsigned us) { return us / 1e6f * 343.0f / 2.0f; }
int main() {
    const unsigned NO_ECHO = 4294967295u; // ESPHome publishes NAN when it gives up
    unsigned us;
    while (scanf("%%u %%f %%f", &us, &air_temperature.state, &air_humidity.state) == 3)
        printf("%%.7g\\n", *filter(us == NO_ECHO ? NAN : us_to_m(us)));
}
"""


@pytest.mark.slow
@pytest.mark.parametrize("humid", [False, True])
def test_the_lambda_of_esphome_gives_the_twins_distance(humid: bool, tmp_path: Path) -> None:
    packed = with_humidity("esphome", "c99") if humid else made("degree_3", "esphome")
    (sensor,) = yaml.safe_load(packed.files["echocal.yaml"])["sensor"]
    assert sensor["platform"] == "ultrasonic"
    packed.save(tmp_path)
    (tmp_path / "node.cpp").write_text(ESPHOME % sensor["filters"][0]["lambda"])
    run("gcc", "-c", tmp_path / "echocal_correction.c", "-o", tmp_path / "correction.o")
    parts = (tmp_path / "node.cpp", tmp_path / "correction.o")
    run("g++", "-std=c++17", "-Wall", "-Wextra", "-Werror", f"-I{tmp_path}", *parts, "-o", tmp_path / "node")
    step = 2.0 if humid else 0.5
    heard = packed.report["device"]["echo"]["codes"]
    first, last = heard["minimum"], heard["maximum"]
    times = [*range(first, last, 37), last]
    given = [(us, warm, damp) for us in times for warm in (-20.0, 4.0, 60.0) for damp in (0.0, 60.0, 100.0)]
    text = "".join(f"{us} {warm} {damp}\n" for us, warm, damp in given)
    found = [float(line) for line in run(tmp_path / "node", text=text).split()]
    for (us, warm, damp), distance in zip(given, found, strict=True):
        codes = (us, round(warm / step), round(damp / 10))[: 3 if humid else 2]
        assert distance == pytest.approx(int(packed.distance_um(*codes)) * 1e-6, rel=2e-7, abs=1e-12)
    no_echo = (0, first - 1, last + 1, 38_000, 4_294_967_295)  # no pulse, too near or far, time-outs
    for odd in ("20000 nan 50", "20000 61.1 50", "20000 -21.1 50", *(f"{us} 20 50" for us in no_echo)):
        assert run(tmp_path / "node", text=odd).strip() in {"nan", "-nan"}
