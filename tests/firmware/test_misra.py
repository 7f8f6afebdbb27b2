"""MISRA C:2012 as cppcheck's addon reads it, over the C of every form: clean but for what is told."""

import re
import subprocess
from pathlib import Path

import pytest
from conftest import CASES, made, with_humidity

from echocal.firmware import Firmware

PAGE = Path(__file__).parents[2] / "docs" / "firmware.md"
# By file: rules that may be broken, each of which the page explains.
DEVIATIONS = {
    "echocal_correction.h": {"2.5"},
    "echocal_correction.c": {"2.5", "8.9", "15.5", "19.2"},
    "echocal_selftest.h": {"2.5"},
    "echocal_selftest.c": {"2.5", "8.9"},
    "echocal_selftest_main.c": {"21.6"},
}


def findings(packed: Firmware, folder: Path, *endings: str) -> set[tuple[str, str]]:
    """File and rule, or another check of cppcheck, of everything that it has to say."""
    packed.save(folder)
    sources = [folder / name for name in packed.files if name.endswith(endings)]
    places = (f"-I{folder}", f"-I{folder / 'selftest'}")
    checks = ("--addon=misra", "--enable=style,warning,portability,performance", "--std=c99", "-q")
    command = ("cppcheck", *checks, "--template={file}:{id}", *places, *map(str, sources))
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    lines = [line.rpartition(":") for line in done.stderr.splitlines() if line.strip()]
    return {(Path(file).name, check.removeprefix("misra-c2012-")) for file, _, check in lines}


def firmware_of(name: str) -> Firmware:
    return with_humidity("c", name.partition(" ")[2]) if name.startswith("humid") else made(name)


@pytest.mark.slow
@pytest.mark.parametrize("name", [*CASES, "humid avr", "humid c99", "humid cortex-m0"])
def test_every_form_is_clean_but_for_the_deviations_told(name: str, tmp_path: Path) -> None:
    packed = firmware_of(name)
    # The self-test differs only in its numbers, and with the target and the humidity.
    endings = ("t.c", "n.c") if name.startswith(("humid", "avr")) else ("echocal_correction.c",)
    found = findings(packed, tmp_path, *endings)
    assert {(file, rule) for file, rule in found if rule not in DEVIATIONS[file]} == set()
    header = packed.files["echocal_correction.h"]
    for file, rule in found:
        if file.startswith("echocal_correction"):
            assert re.search(rf"^ \* - {re.escape(rule)}: ", header, re.M), (
                f"the header must tell of rule {rule}"
            )


def test_the_check_sees_what_breaks_a_rule(tmp_path: Path) -> None:
    packed = made("degree_3")
    source = packed.files["echocal_correction.c"]
    spoiled = source.replace("(uint32_t)flight", "(uint32_t)(flight + 1U)")
    spoiled = spoiled.replace("    return (", "    if (echo_us) {\n        return 1;\n    }\n    return (")
    files = {**packed.files, "echocal_correction.c": spoiled}
    found = findings(Firmware(files, packed.report, packed._twin), tmp_path, "correction.c")
    assert {("echocal_correction.c", "10.8"), ("echocal_correction.c", "14.4")} <= found


@pytest.mark.slow
def test_every_deviation_is_made_and_told_on_the_page(tmp_path: Path) -> None:
    found = findings(made("avr_table"), tmp_path, ".c") | findings(with_humidity(), tmp_path, ".c")
    rules = {rule for rules in DEVIATIONS.values() for rule in rules}
    assert {rule for _, rule in found} == rules, "no deviation is listed that nothing needs"
    told = re.findall(r"^\| ([0-9]+\.[0-9]+), (?:advisory|required):", PAGE.read_text(), re.MULTILINE)
    assert set(told) == rules
