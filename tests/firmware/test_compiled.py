"""The generated C, compiled without a warning and run: the same bits as the twin on every input."""

import csv
import io
from pathlib import Path

import numpy as np
import pytest
from toolchain import C_COMPILERS, CXX_COMPILERS, STRICT, answers, build, hash_of_all, run

from echocal import Model, firmware
from echocal.firmware import Firmware

OUT_OF_RANGE = -(2**31)


@pytest.mark.parametrize("compiler", C_COMPILERS)
def test_every_input_is_as_proven(case: Firmware, compiler: str, tmp_path: Path) -> None:
    assert hash_of_all(build(case, tmp_path, compiler)) == case.report["output_hash"]


@pytest.mark.parametrize("compiler", C_COMPILERS)
def test_all_32_million_inputs_of_a_ds18b20(compiler: str, tmp_path: Path) -> None:
    made = firmware.generate(Model("cramer"), temperature=(0.0625, -20.0, 60.0))
    assert made.report["inputs_checked"] == 1281 * (25_072 - 109 + 1)
    assert hash_of_all(build(made, tmp_path, compiler)) == made.report["output_hash"]


@pytest.mark.slow
@pytest.mark.parametrize("compiler", C_COMPILERS)
def test_no_undefined_behavior_on_any_input(case: Firmware, compiler: str, tmp_path: Path) -> None:
    flags = ("-O1", "-g", "-fsanitize=undefined,address", "-fno-sanitize-recover=all")
    assert hash_of_all(build(case, tmp_path, compiler, *flags)) == case.report["output_hash"]


def test_golden_vectors_are_what_the_c_returns(case: Firmware, tmp_path: Path) -> None:
    rows = list(csv.DictReader(io.StringIO(case.files["echocal_golden.csv"])))
    assert len(rows) > 200
    inputs = [(int(row["echo_us"]), int(row["temperature_code"])) for row in rows]
    expected = [int(row["distance_um"]) for row in rows]
    assert answers(build(case, tmp_path), inputs) == expected
    assert case.distance_um(*np.transpose(inputs)).tolist() == expected
    assert OUT_OF_RANGE in expected


@pytest.mark.slow
def test_codes_out_of_range_never_give_a_distance(case: Firmware, tmp_path: Path) -> None:
    echo = case.report["device"]["echo"]["codes"]
    (temperature,) = (axis["codes"] for axis in case.report["device"]["conditions"])
    some_codes = [-32_768, temperature["minimum"], 0, temperature["maximum"], 32_767]
    inputs = [(time, code) for time in range(65_536) for code in some_codes]
    times = (0, echo["minimum"], echo["maximum"], 65_535)
    inputs += [(time, code) for time in times for code in range(-32_768, 32_768)]
    found = answers(build(case, tmp_path), inputs)
    for (time, code), distance in zip(inputs, found, strict=True):
        heard = echo["minimum"] <= time <= echo["maximum"]
        accepted = heard and temperature["minimum"] <= code <= temperature["maximum"]
        assert accepted == (distance != OUT_OF_RANGE), (time, code, distance)


@pytest.mark.slow
@pytest.mark.parametrize("compiler", CXX_COMPILERS)
def test_the_header_serves_cpp(case: Firmware, compiler: str, tmp_path: Path) -> None:
    case.save(tmp_path)
    (tmp_path / "user.cpp").write_text(
        '#include "echocal_correction.h"\n'
        "int main() { return echocal_distance_um(0, 32767) == ECHOCAL_OUT_OF_RANGE ? 0 : 1; }\n"
    )
    run("gcc", "-std=c99", "-c", tmp_path / "echocal_correction.c", "-o", tmp_path / "correction.o")
    flags = ("-std=c++98", *(flag for flag in STRICT if flag != "-pedantic"))
    run(compiler, *flags, tmp_path / "user.cpp", tmp_path / "correction.o", "-o", tmp_path / "user")
    run(tmp_path / "user")
    # The source too, for those who compile everything as C++.
    run(
        compiler,
        "-std=c++11",
        *STRICT,
        "-x",
        "c++",
        "-c",
        tmp_path / "echocal_correction.c",
        "-o",
        tmp_path / "x.o",
    )
