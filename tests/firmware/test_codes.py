"""Codes of every kind: ticks of a timer, thermometers that fall or count past 32,767; other units."""

import runpy
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from boards.arduino import link, serial
from boards.python import EnoughError, fakes
from hypothesis import given, settings
from hypothesis import strategies as st
from toolchain import build, hash_of_all, run

from echocal import BoundError, Model, UsageError, firmware, silicon
from echocal.firmware import EchoCodes, Firmware, HumidityCodes, TemperatureCodes
from echocal.silicon.board import definitions

MODEL = Model("cramer", {"fixed_delay": {"delay": 31e-6}})
METERS = {"um": 1e-6, "mm": 1e-3, "cm": 1e-2}
FALLING = TemperatureCodes(-0.5, -20.0, 60.0, 100.0)
SHT31 = TemperatureCodes(175 / 65_535, 20.0, 60.0, -45.0)  # past 32,767
ODD: dict[str, dict[str, Any]] = {
    "falling_mm": {"temperature": FALLING, "output_unit": "mm", "max_error": 0.8e-3},
    "ticks_cm": {"echo": EchoCodes(4.0, 40_000), "output_unit": "cm", "max_error": 7e-3, "prefer": "speed"},
    "unsigned": {"temperature": SHT31, "echo": 2_000, "max_error": 0.5e-3},
    "humid_mm": {
        "echo": (0.5, 8_000),
        "humidity": HumidityCodes(0.05, 0.0, 1.0, -0.06),
        "output_unit": "mm",
        "max_error": 1e-3,
    },
}


def made(name: str, target: str = "c99", package: str = "c") -> Firmware:
    request = {"temperature": (0.5, -20.0, 60.0), "n_threads": 2, **ODD[name]}
    return firmware.generate(MODEL, target, package=package, **request)


def truth(model: Model, report: dict[str, Any], *codes: np.ndarray) -> np.ndarray:
    """The model's distance [m] at codes."""
    device = report["device"]
    axes = (device["echo"], *device["conditions"])
    time, *conditions = (axis["zero"] + axis["lsb"] * code for axis, code in zip(axes, codes, strict=True))
    names = [axis["quantity"] for axis in axes[1:]]
    return np.asarray(model.distance(time, pressure=101_325.0, **dict(zip(names, conditions, strict=True))))


@pytest.mark.slow
@settings(max_examples=25, deadline=None)
@given(
    tick=st.sampled_from([0.125, 0.5, 1.0, 4.0, 10.0]),
    step=st.sampled_from([0.0625, -0.1, 0.5, -1.0, 175 / 65_535]),
    zero=st.sampled_from([0.0, -45.0, 100.0]),
    first=st.integers(0, 200),
    low=st.floats(-20.0, 30.0),
    span=st.floats(0.5, 8.0),
    unit=st.sampled_from(sorted(METERS)),
    tenths=st.integers(6, 40),
    target=st.sampled_from(["c99", "avr", "cortex-m0"]),
)
def test_c_twin_and_model_agree_within_the_bound(
    tick: float,
    step: float,
    zero: float,
    first: int,
    low: float,
    span: float,
    unit: str,
    tenths: int,
    target: str,
    tmp_path_factory: pytest.TempPathFactory,
) -> None:
    bound = max(METERS[unit], 1e-4) * tenths / 10
    warm = TemperatureCodes(step, low, low + span, zero)
    try:
        made = firmware.generate(
            MODEL,
            target,
            temperature=warm,
            echo=(tick, (first + 900) * tick, first * tick),
            output_unit=unit,
            max_error=bound,
        )
    except UsageError as error:
        assert "holds no code" in str(error) or "use a coarser LSB" in str(error)  # noqa: PT017
        return
    assert made.report["error_proven_m"] <= bound
    axes = (made.report["device"]["echo"], *made.report["device"]["conditions"])
    codes = [np.arange(axis["codes"]["minimum"], axis["codes"]["maximum"] + 1) for axis in axes]
    every = np.meshgrid(*codes, indexing="ij")
    outputs = made.outputs(*every)
    error = np.abs(outputs * METERS[unit] - truth(MODEL, made.report, *every))
    assert error.max() == pytest.approx(made.report["error_overall_m"], rel=1e-6, abs=1e-12)
    assert (np.diff(outputs, axis=0) >= 0).all()
    flags = ("-O1", "-fsanitize=undefined", "-fno-sanitize-recover=all", *definitions(made))
    program = build(made, tmp_path_factory.mktemp("drawn"), "gcc", *flags)
    assert hash_of_all(program) == made.report["output_hash"]


@pytest.mark.slow
@pytest.mark.parametrize("core", ["avr", "cortex-m0", "rv32"])
@pytest.mark.parametrize("name", ["ticks_cm", "humid_mm"])
def test_cores_give_the_bits_of_the_twin(name: str, core: str) -> None:
    coarse = {"temperature": (10.0, -20.0, 60.0), "echo": (4.0, 8_000), "n_threads": 2}
    found = firmware.generate(MODEL, core, **{**ODD[name], **coarse})
    assert silicon.output_hash(found, core) == found.report["output_hash"]
    assert silicon.measure(found, core) is not None


@pytest.mark.slow
def test_the_selftest_holds_for_every_kind(tmp_path: Path) -> None:
    for name in ODD:
        folder = tmp_path / name
        made(name).save(folder)
        parts = (folder / "echocal_correction.c", *(folder / "selftest").glob("*.c"))
        flags = ("-std=c99", "-Wall", "-Wextra", "-Wconversion", "-Werror", "-DECHOCAL_EVERY_INPUT", "-O2")
        run("gcc", *flags, f"-I{folder}", *parts, "-o", folder / "test")
        assert run(folder / "test").strip() == "echocal self-test: passed"


def test_the_sketch_counts_ticks_and_prints_millimeters(tmp_path: Path) -> None:
    request = {"echo": EchoCodes(0.5, 30_000), "temperature": FALLING, "output_unit": "mm"}
    packed = firmware.generate(MODEL, "avr", max_error=0.8e-3, package="arduino", **request)
    lines = serial(link(packed, "examples/HcSr04/HcSr04.ino", tmp_path), (713, 0), [580, 11_690])
    for line, sent in zip(lines, (580, 11_690), strict=True):
        echo, warm, distance = map(int, line.split())
        assert abs(echo - 2 * sent) <= 2
        assert warm == 157  # 21.5 degC: 715 mV, the middle of the converter's step that has 713 mV
        assert distance == packed.outputs(echo, warm)


@pytest.mark.slow
def test_the_sketch_counts_ticks_that_are_no_whole_nanoseconds(tmp_path: Path) -> None:
    """A tick of 62.5 ns, a timer of 16 MHz, was taken for 63 ns: 0.8 % short."""
    request = {"echo": EchoCodes(0.0625), "max_distance": 0.6, "temperature": (0.5, -20.0, 60.0)}
    packed = firmware.generate(MODEL, "avr", package="arduino", **request)
    lines = serial(link(packed, "examples/HcSr04/HcSr04.ino", tmp_path), (713, 0), [580, 3_500])
    assert [int(line.split()[0]) for line in lines] == pytest.approx([16 * 580, 16 * 3_500], abs=16)


@pytest.mark.parametrize("clock", [8_000_000, 12_000_000, 20_000_000])
def test_the_sketch_knows_other_clocks(clock: int, tmp_path: Path) -> None:
    """Its formula of ticks to nanoseconds, on a PC: 20 MHz have no whole number of ticks in a microsecond."""
    text = made("falling_mm", "avr", "arduino").files["examples/HcSr04/HcSr04.ino"]
    start = text.index("static uint32_t nanoseconds")
    source = tmp_path / "clock.c"
    source.write_text(
        f"#include <stdint.h>\n#include <stdio.h>\n#define F_CPU {clock}L\n"
        f"{text[start : text.index('}', start) + 1]}\n"
        f'int main(void) {{ printf("%u\\n", nanoseconds({clock // 8 // 50})); return 0; }}\n'
    )
    run("gcc", source, "-o", tmp_path / "clock")
    assert int(run(tmp_path / "clock")) == 20_000_000


def test_micropython_counts_ticks_of_another_unit(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    packed = made("ticks_cm", package="micropython")
    packed.save(tmp_path)
    monkeypatch.chdir(tmp_path)
    monkeypatch.syspath_prepend(tmp_path)
    for name in ("echocal_selftest.py", "main.py"):
        monkeypatch.delitem(sys.modules, "echocal_correction", raising=False)
        if name == "main.py":
            fakes("micropython", monkeypatch, [11_690])
            with pytest.raises(EnoughError):
                runpy.run_path(name)
        else:
            assert not runpy.run_path(name)["WRONG"]
    assert capsys.readouterr().out.split()[-1] == str(packed.outputs(2_922, 40))


def test_half_a_unit_is_the_best_that_a_unit_can_do() -> None:
    with pytest.raises(BoundError, match=r"the best reachable is 0\.50\d\d mm"):
        firmware.generate(MODEL, temperature=(0.5, -20.0, 60.0), output_unit="mm", max_error=0.4e-3)


@pytest.mark.parametrize(
    ("request_", "message"),
    [
        ({"output_unit": "furlong"}, "unknown output unit 'furlong'; this version has um, 0.1mm, mm, cm"),
        ({"echo": (0.0, 38_000)}, "echo LSB 0 us is no tick"),
        ({"echo": (0.5, 38_000)}, "echo max 38000 us is code 76000 of LSB 0.5 us: it is outside 1 .. 65535"),
        ({"temperature": (0.001, -20.0, 60.0)}, "codes -20000 .. 60000, and int16_t holds -32768 .. 32767"),
        (
            {"temperature": (1e-5, 0.0, 60.0)},
            "6000001 of temperature_code in steps of 0.00001 degC are 6000001",
        ),
        ({"humidity": HumidityCodes(0.01, 0.0, 1.0, 0.5, 1)}, "uint8_t holds 0 .. 255, uint16_t holds 0"),
        ({"humidity": HumidityCodes(0.01, 0.0, 1.0, 0.0, 0.5)}, "the shift of humidity is 0.5; give a whole"),
        ({"humidity": HumidityCodes(1e-6, 0.0, 1.0)}, "let the function drop 10 bits of them together"),
        ({"echo": EchoCodes(1.0, None, None, 24)}, "bits=24: a timer has 16 or 32 bits"),
    ],
)
def test_codes_that_make_no_sense(request_: dict[str, Any], message: str) -> None:
    with pytest.raises(UsageError) as told:
        firmware.generate(Model("cramer"), **request_)
    assert message in str(told.value)


def test_a_function_of_millimeters_gives_no_micrometers() -> None:
    with pytest.raises(UsageError, match="returns mm: take outputs"):
        made("falling_mm").distance_um(1, 100)
