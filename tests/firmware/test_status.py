"""Why codes are refused: the C, its self-test, the golden vectors, MicroPython and the twin say the same."""

import csv
import io
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from conftest import made, with_humidity
from test_micropython import loaded
from toolchain import STRICT, run

from echocal import Model, firmware
from echocal.firmware import EchoCodes, Firmware

OUT_OF_RANGE = -(2**31)
OK, NO_ECHO, TOO_NEAR, TOO_FAR, TEMPERATURE, HUMIDITY = range(6)
HALF_DEGREES = (0.5, -20.0, 60.0)
CASES: dict[str, dict[str, Any]] = {
    "usual": {},
    "zero_is_accepted": {"echo": (1.0, 20_000, 0)},
    "one_is_accepted": {"echo": (1.0, 20_000, 1)},
    "time_outs_are_accepted": {"echo": (1.0, 38_000, 100)},
    "ends_at_the_time_out": {"echo": (1.0, 35_000, 100)},
    "fine_ticks": {"echo": EchoCodes(0.125)},
    "whole_type": {"echo": (1.0, 65_535, 0)},
}
PROGRAM = """
#include <stdio.h>
#include "echocal_correction.h"
int main(void)
{
    unsigned int echo;
    int code;
    while (scanf("%u %d", &echo, &code) == 2) {
        const uint8_t status = echocal_status((uint16_t)echo, (int16_t)code);
        const int distance = echocal_distance_um((uint16_t)echo, (int16_t)code) != ECHOCAL_OUT_OF_RANGE;
        printf("%d %d\\n", status, distance);
    }
    return 0;
}
"""


def generated(name: str, package: str = "c") -> Firmware:
    return firmware.generate(Model("cramer"), temperature=HALF_DEGREES, package=package, **CASES[name])


def expected(packed: Firmware, echo: np.ndarray, code: np.ndarray) -> np.ndarray:
    """The rule, written once more: the echo is looked at first; more than 35 ms are a time-out."""
    axes = packed.report["device"]
    (near, far), (cold, warm) = (
        (axis["codes"]["minimum"], axis["codes"]["maximum"]) for axis in (axes["echo"], axes["conditions"][0])
    )
    late = echo * axes["echo"]["lsb"] * 1e6 > 35_000
    heard = [(near <= echo) & (echo <= far), (echo == 0) | late, echo < near, echo > far]
    inside = np.where((cold <= code) & (code <= warm), OK, TEMPERATURE)
    return np.select(heard, [inside, NO_ECHO, TOO_NEAR, TOO_FAR])


@pytest.mark.filterwarnings("ignore::echocal.DomainWarning")  # of time-outs that are accepted
@pytest.mark.parametrize("name", CASES)
def test_each_echo_code_has_its_status(name: str, tmp_path: Path) -> None:
    packed = generated(name)
    packed.save(tmp_path)
    (tmp_path / "main.c").write_text(PROGRAM)
    parts = (tmp_path / "main.c", tmp_path / "echocal_correction.c")
    for compiler in ("gcc", "clang"):
        run(compiler, "-std=c99", "-O2", *STRICT, f"-I{tmp_path}", *parts, "-o", tmp_path / compiler)
    echo, code = (codes.ravel() for codes in np.meshgrid(np.arange(65_536), [-32_768, -41, 40, 121]))
    text = "\n".join(f"{time} {warm}" for time, warm in zip(echo, code, strict=True))
    said = np.array(run(tmp_path / "gcc", text=text).split(), dtype=int).reshape(-1, 2)
    statuses = packed.status(echo, code)
    assert (statuses == expected(packed, echo, code)).all()
    assert (said[:, 0] == statuses).all()
    assert (said[:, 1] == (statuses == OK)).all(), "a distance where, and only where, the status is OK"
    assert ((packed.outputs(echo, code) != OUT_OF_RANGE) == (statuses == OK)).all()
    module = loaded(generated(name, "micropython"))
    some = slice(None, None, 37)
    assert [*map(module["status"], echo[some].tolist(), code[some].tolist())] == statuses[some].tolist()


def test_the_statuses_have_names() -> None:
    packed = with_humidity()
    assert packed.report["statuses"] == [
        "ok",
        "no echo",
        "too near",
        "too far",
        "temperature out of range",
        "humidity out of range",
    ]
    inputs = ([0, 50, 30_000, 36_000, 11_690, 11_690], [0, 0, 99, 99, 99, 0], [0, 0, 0, 99, 99, 99])
    assert packed.status(*inputs).tolist() == [NO_ECHO, TOO_NEAR, TOO_FAR, NO_ECHO, TEMPERATURE, HUMIDITY]


@pytest.mark.parametrize("humid", [False, True])
def test_the_vectors_have_every_status(humid: bool) -> None:
    packed = with_humidity() if humid else made("degree_2")
    rows = list(csv.DictReader(io.StringIO(packed.files["echocal_golden.csv"])))
    codes = [[int(row[name]) for row in rows] for name in list(rows[0])[: 3 if humid else 2]]
    statuses = [int(row["status"]) for row in rows]
    assert packed.status(*codes).tolist() == statuses
    every = {*range(6)} if humid else {*range(5)}
    assert set(statuses) == every
    text = packed.files["selftest/echocal_selftest.c"]
    listed = text.partition("status_vectors[VECTORS]")[2].partition("};")[0]
    assert {int(word.strip("U,")) for word in listed.split() if word.strip("U,").isdigit()} == every


def test_the_selftest_tells_a_wrong_status(tmp_path: Path) -> None:
    packed = made("degree_2")
    packed.save(tmp_path)
    header = tmp_path / "echocal_correction.h"
    text = header.read_text()
    assert text.count("status = ECHOCAL_TOO_FAR;") == 1
    header.write_text(text.replace("status = ECHOCAL_TOO_FAR;", "status = ECHOCAL_TOO_NEAR;"))
    places = (f"-I{tmp_path}", f"-I{tmp_path / 'selftest'}")
    parts = [tmp_path / name for name in packed.files if name.endswith(".c")]
    run("gcc", "-std=c99", *places, *parts, "-o", tmp_path / "spoiled")
    with pytest.raises(AssertionError, match="FAILED"):
        run(tmp_path / "spoiled")


def test_it_costs_nothing_where_it_is_not_called(tmp_path: Path) -> None:
    """The function itself is pinned in silicon/test_silicon.py. Nothing else is in the object."""
    made("avr_polynomial").save(tmp_path)
    thing = tmp_path / "x.o"
    flags = ("-mmcu=atmega328p", "-Os", "-std=c99", "-c")
    run("avr-gcc", *flags, tmp_path / "echocal_correction.c", "-o", thing)
    names = [line.split()[-1] for line in run("avr-nm", "--defined-only", thing).splitlines()]
    assert [name for name in names if not name.startswith("__")] == ["echocal_distance_um"]
