"""Packagings: which files, the same function in each, and what can be run of them on a PC."""

import configparser
import json
import re
import subprocess
from pathlib import Path

import pytest
from boards import rules
from boards.esphome import ENVIRONMENT
from conftest import DELAY_AND_ZERO, made, with_humidity
from toolchain import run

from echocal import Model, UsageError, firmware

C = ("echocal_correction.c", "echocal_correction.h", "echocal_selftest.c", "echocal_selftest.h")
LIBRARY = f"Echocal_{Model('cramer', DELAY_AND_ZERO).hash[:8]}"
FILES = {
    "c": {*C[:2], *(f"selftest/{name}" for name in C[2:]), "selftest/echocal_selftest_main.c"},
    "arduino": {
        "LICENSE",
        "README.md",
        "examples/HcSr04/HcSr04.ino",
        "examples/SelfTest/SelfTest.ino",
        "keywords.txt",
        "library.properties",
        *(f"src/{name}" for name in (*C, f"{LIBRARY}.h")),
    },
    "platformio": {
        "LICENSE",
        "README.md",
        f"lib/{LIBRARY}/LICENSE",
        f"lib/{LIBRARY}/library.json",
        *(f"lib/{LIBRARY}/src/{name}" for name in (*C, f"{LIBRARY}.h")),
        "platformio.ini",
        "src/main.cpp",
        "test/test_selftest/test_selftest.cpp",
    },
    "esphome": {
        "LICENSE",
        "README.md",
        "components/echocal/__init__.py",
        "components/echocal/sensor.py",
        *(f"components/echocal/{name}" for name in (*C[:2], "echocal_sensor.cpp", "echocal_sensor.h")),
        "echocal.yaml",
    },
    "micropython": {
        "LICENSE",
        "README.md",
        "echocal_correction.py",
        "echocal_selftest.py",
        "main.py",
        "package.json",
    },
    "esp-idf": {
        "CMakeLists.txt",
        "LICENSE",
        "README.md",
        "idf_component.yml",
        *(f"src/{name}" for name in C),
    },
    "zephyr": {
        "LICENSE",
        "README.md",
        *(f"src/{name}" for name in C),
        *(f"zephyr/{name}" for name in ("CMakeLists.txt", "Kconfig", "module.yml")),
    },
    "rust": {"Cargo.toml", "LICENSE", "README.md", "src/lib.rs", "tests/golden.rs"},
}


@pytest.mark.parametrize("package", FILES)
def test_the_files_of_a_package(package: str, tmp_path: Path) -> None:
    packed = made("avr_table", package)
    packed.save(tmp_path)
    found = {str(path.relative_to(tmp_path)) for path in tmp_path.rglob("*") if path.is_file()}
    assert found == {*FILES[package], "echocal_golden.csv", "report.json", "SHA256SUMS"}
    assert packed.report["provenance"]["package"] == package


@pytest.mark.parametrize("package", [name for name in FILES if name not in {"micropython", "rust"}])
def test_every_package_holds_the_same_c(package: str) -> None:
    plain, packed = made("avr_table"), made("avr_table", package)
    (source,) = (text for path, text in packed.files.items() if path.endswith("correction.c"))
    assert source == plain.files["echocal_correction.c"]
    (header,) = (text for path, text in packed.files.items() if path.endswith("correction.h"))
    without = header.replace(f" --package {package}", "")
    assert without == plain.files["echocal_correction.h"], "only the command differs"


@pytest.mark.parametrize("name", ["avr_table", "degree_2"])
def test_the_library_manager_accepts_the_library(name: str, tmp_path: Path) -> None:
    made(name, "arduino").save(tmp_path)
    assert rules.broken(tmp_path) == []


@pytest.mark.parametrize(
    ("file", "old", "new", "rule"),
    [
        ("library.properties", r"url=.*", "url=", "missing field url"),
        ("library.properties", r"name=.*", "name=EchocalCorrection", "at most 16 letters"),
        ("library.properties", r"version=0", "version=v0", "no semantic version"),
        ("library.properties", r"includes=.*", "includes=other.h", "other.h is absent"),
        ("keywords.txt", "\t", " ", "keywords.txt"),
    ],
)
def test_a_broken_library_is_told(file: str, old: str, new: str, rule: str, tmp_path: Path) -> None:
    """What the library lacked once, and what it must not lose."""
    made("degree_2", "arduino").save(tmp_path)
    text, count = re.subn(old, new, (tmp_path / file).read_text())
    assert count
    (tmp_path / file).write_text(text)
    assert any(rule in broken for broken in rules.broken(tmp_path))


def test_each_calibration_has_a_name_and_a_version_of_its_own() -> None:
    texts = [
        made(name, "arduino").files["library.properties"] for name in ("degree_2", "avr_table", "full_table")
    ]
    fields = [rules.properties(text) for text in texts]
    assert fields[0]["name"] != fields[1]["name"] == fields[2]["name"], "two of one model"
    assert len({field["version"] for field in fields}) == 3, "and three functions"


@pytest.mark.parametrize("package", [name for name in FILES if name != "c"])
def test_the_readme_states_what_was_proven_and_measured(package: str) -> None:
    packed = made("degree_2", package)
    text, license_text = packed.files["README.md"], packed.files["LICENSE"]
    stated = re.search(r"up to 4\.0 m: at most ([\d.]+) mm", text)
    assert stated is not None
    assert 0 <= float(stated[1]) - packed.report["error_proven_m"] * 1e3 < 1e-4, "rounded up"
    assert f"model `{packed.report['provenance']['model_hash']}`" in text
    assert ("Flash and time of this function were not measured" in text) == (
        package not in {"micropython", "rust"}
    )
    assert "not tested on a real board" in " ".join(text.split())
    assert "Permission is hereby granted" in license_text
    assert "{" not in license_text


def test_an_unknown_package_is_refused_before_the_proof() -> None:
    proofs: list[object] = []
    with pytest.raises(UsageError, match="unknown package 'deb'; this version has c, arduino, platformio"):
        firmware.generate(Model("cramer"), package="deb", progress=lambda *step: proofs.append(step))
    assert not proofs


def python() -> Path:
    """The interpreter of the environment that has PlatformIO and kconfiglib."""
    if not (ENVIRONMENT / "bin/python").exists():
        pytest.skip("no PlatformIO: see test_esphome.py")
    return ENVIRONMENT / "bin/python"


# PlatformIO asks the network for the list of licenses; two of them are ours.
READ_MANIFEST = """
import sys
from platformio.package.manifest.parser import ManifestParserFactory
from platformio.package.manifest.schema import ManifestSchema
licenses = {"licenses": [{"licenseId": "MIT"}, {"licenseId": "Apache-2.0"}]}
ManifestSchema.load_spdx_licenses = staticmethod(lambda: licenses)
manifest = ManifestParserFactory.new_from_file(sys.argv[1]).as_dict()
print(*ManifestSchema().load_manifest(manifest)["headers"])
"""


@pytest.mark.parametrize(
    ("package", "file"), [("platformio", f"lib/{LIBRARY}/library.json"), ("arduino", "library.properties")]
)
def test_platformio_accepts_the_manifest(package: str, file: str, tmp_path: Path) -> None:
    made("avr_table", package).save(tmp_path)
    assert run(python(), "-c", READ_MANIFEST, tmp_path / file).split() == [f"{LIBRARY}.h"]


@pytest.mark.parametrize(("name", "board"), [("avr_table", "uno"), ("word_of_32_bits", "nucleo_f072rb")])
def test_the_project_has_a_board_of_the_target_and_a_pc(name: str, board: str) -> None:
    project = configparser.ConfigParser()
    project.read_string(made(name, "platformio").files["platformio.ini"])
    assert project.sections() == ["platformio", f"env:{board}", "env:native"]
    assert project["platformio"]["default_envs"] == board


@pytest.mark.parametrize(("factor", "failures"), [(1, 0), (2, 1)])
def test_the_selftest_of_the_native_environment(factor: int, failures: int, tmp_path: Path) -> None:
    """By the compiler that `pio test -e native` calls, with a stand-in for the framework Unity."""
    packed = made("avr_table", "platformio")
    packed.save(tmp_path)
    source = tmp_path / f"lib/{LIBRARY}/src"
    text = (source / C[0]).read_text()
    returned = "    return (int32_t)"
    assert text.count(returned) == 1
    (source / C[0]).write_text(text.replace(returned, f"    return {factor} * (int32_t)"))
    (tmp_path / "unity.h").write_text(UNITY)
    for name in ("echocal_correction", "echocal_selftest"):
        run("gcc", "-c", source / f"{name}.c", "-o", tmp_path / f"{name}.o")
    test = tmp_path / "test/test_selftest/test_selftest.cpp"
    objects = sorted(tmp_path.glob("*.o"))
    run(
        "g++",
        "-Wall",
        "-Wextra",
        "-Werror",
        f"-I{source}",
        f"-I{tmp_path}",
        test,
        *objects,
        "-o",
        tmp_path / "test.exe",
    )
    assert subprocess.run((tmp_path / "test.exe",), check=False).returncode == failures


UNITY = """
static int failures;
#define UNITY_BEGIN() (failures = 0)
#define UNITY_END() failures
#define RUN_TEST(test) test()
#define TEST_ASSERT_EQUAL_UINT16(expected, found) (failures += (expected) != (found))
"""


READ_KCONFIG = """
import sys, kconfiglib
kconfig = kconfiglib.Kconfig(sys.argv[1])
print(*sorted(name for name in kconfig.syms if name.startswith("ECHOCAL")), *kconfig.warnings)
"""


@pytest.mark.parametrize(
    ("package", "listing"), [("esp-idf", "CMakeLists.txt"), ("zephyr", "zephyr/CMakeLists.txt")]
)
def test_the_listed_files_are_a_library(package: str, listing: str, tmp_path: Path) -> None:
    """What the build of the framework is told to compile and to search; the framework itself is not there."""
    packed = made("avr_table", package)
    packed.save(tmp_path)
    folder = (tmp_path / listing).parent
    sources = [folder / name for name in re.findall(r'[^\s"(]+\.c\b', packed.files[listing])]
    assert [path.name for path in sources] == [C[0], C[2]]
    (include,) = {path.parent for path in sources}
    main = tmp_path / "main.c"
    main.write_text("#include <echocal_selftest.h>\nint main(void) { return echocal_selftest(); }\n")
    run("gcc", "-Wall", "-Wextra", "-Werror", f"-I{include}", main, *sources, "-o", tmp_path / "main")
    assert not run(tmp_path / "main")
    if package == "esp-idf":
        fields = {"version", "description", "license", "url", "tags", "dependencies"}
        assert read_yaml(tmp_path / "idf_component.yml").keys() == fields
    else:
        build = {"cmake": "zephyr", "kconfig": "zephyr/Kconfig"}
        assert read_yaml(folder / "module.yml") == {"name": LIBRARY.lower(), "build": build}
        symbols = run(python(), "-c", READ_KCONFIG, folder / "Kconfig").split()
        assert symbols == ["ECHOCAL", "ECHOCAL_SELFTEST"]


def read_yaml(path: Path) -> dict[str, object]:
    """What ESPHome's own parser reads."""
    text = run(
        python(),
        "-c",
        "import json, sys, yaml; print(json.dumps(yaml.safe_load(sys.stdin)))",
        text=path.read_text(),
    )
    return dict(json.loads(text))


@pytest.mark.slow
@pytest.mark.parametrize(
    "name", ["degree_2", "degree_5", "avr_table", "product_of_64_bits", "falling_speed", "humid"]
)
def test_the_crate_passes_its_test(name: str, tmp_path: Path) -> None:
    """With overflow checks; in Rust a value that does not fit its type panics."""
    packed = with_humidity("rust") if name == "humid" else made(name, "rust")
    packed.save(tmp_path)
    done = subprocess.run(("cargo", "test", "-q", "--offline"), cwd=tmp_path, capture_output=True, text=True)
    assert done.returncode == 0, done.stdout + done.stderr
    assert "warning" not in done.stderr
    assert done.stdout.count("1 passed") == 1
