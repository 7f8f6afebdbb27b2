"""The module for MicroPython and CircuitPython, run by CPython and by MicroPython itself."""

import itertools
import runpy
import sys
import types
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from boards.micro import execute
from conftest import CASES, made, with_humidity

from echocal.firmware import Firmware


def loaded(packed: Firmware) -> dict[str, Any]:
    names: dict[str, Any] = {}
    exec(compile(packed.files["echocal_correction.py"], "echocal_correction.py", "exec"), names)
    return names


def beyond(codes: dict[str, int], count: int) -> list[int]:
    """Codes spread over a range, its ends, and those next to it."""
    low, high = codes["minimum"], codes["maximum"]
    spread = np.linspace(low, high, min(count, high - low + 1)).astype(int)
    return sorted({*spread.tolist(), low - 1, high + 1, -32_768, 65_535})


def sweep(packed: Firmware, *counts: int) -> list[np.ndarray]:
    axes = [packed.report["device"]["echo"], *packed.report["device"]["conditions"]]
    codes = [beyond(axis["codes"], count) for axis, count in zip(axes, counts, strict=True)]
    return [grid.reshape(-1) for grid in np.meshgrid(*codes)]


PRINT_ALL = """
for echo in %s:
    for codes in %s:
        print(distance_um(echo, *codes))
"""


@pytest.mark.parametrize("name", [*(name for name in CASES if name != "full_table"), "humid"])
def test_micropython_gives_the_bits_of_the_twin(name: str) -> None:
    """On the core of a micro:bit; a table of every code is too much for its 16 KB."""
    packed = with_humidity("micropython", "c99") if name == "humid" else made(name, "micropython")
    device = packed.report["device"]
    echo, *axes = (beyond(axis["codes"], 5) for axis in (device["echo"], *device["conditions"]))
    rows = list(itertools.product(*axes))[:: len(axes)]
    *_, said = execute(packed.files["echocal_correction.py"], PRINT_ALL % (echo, rows))
    inputs = [(time, *row) for time in echo for row in rows]
    assert list(map(int, said.split())) == packed.distance_um(*np.transpose(inputs)).tolist()


@pytest.mark.parametrize("name", CASES)
def test_it_gives_the_bits_of_the_twin(name: str) -> None:
    packed = made(name, "micropython")
    inputs = sweep(packed, 400, 200)
    module = loaded(packed)
    found = list(map(module["distance_um"], *(codes.tolist() for codes in inputs)))
    assert found == packed.distance_um(*inputs).tolist()
    assert module["OUT_OF_RANGE"] in found


def test_it_gives_the_bits_of_the_twin_with_humidity() -> None:
    packed = with_humidity("micropython", "c99")
    inputs = sweep(packed, 100, 50, 12)
    found = list(map(loaded(packed)["distance_um"], *(codes.tolist() for codes in inputs)))
    assert found == packed.distance_um(*inputs).tolist()


def test_the_selftest_passes_and_can_fail(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    made("avr_table", "micropython").save(tmp_path)
    monkeypatch.chdir(tmp_path)
    monkeypatch.syspath_prepend(tmp_path)
    monkeypatch.delitem(sys.modules, "echocal_correction", raising=False)
    assert not runpy.run_path("echocal_selftest.py")["WRONG"]
    assert "passed, 362 lines" in capsys.readouterr().out
    monkeypatch.delitem(sys.modules, "echocal_correction")
    golden = Path("echocal_golden.csv")
    golden.write_text(golden.read_text() + "11690,40,1\n")
    assert runpy.run_path("echocal_selftest.py")["WRONG"] == ["11690,40,1"]
    assert "FAILED at 11690,40,1" in capsys.readouterr().out


class EnoughError(Exception):
    """Leaves the endless loop of an example."""


def fakes(board: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """What a board brings: pins, and an echo of 11,690 us."""

    def module(name: str, **names: object) -> None:
        monkeypatch.setitem(sys.modules, name, types.SimpleNamespace(**names))  # type: ignore[arg-type]

    sleeps: list[float] = []

    def sleep(seconds: float) -> None:
        sleeps.append(seconds)
        if len(sleeps) > 4:
            raise EnoughError

    module("time", sleep=sleep, sleep_us=lambda _: None)
    if board == "micropython":
        pin = types.SimpleNamespace(value=lambda _: None)
        kind = type("Pin", (), {"OUT": 1, "IN": 0, "__new__": lambda *_: pin})
        module("machine", Pin=kind, time_pulse_us=lambda *_: 11_690)
        return
    pulse = type("PulseIn", (list,), {"__init__": lambda self, *_, **__: None})
    pulse.clear = lambda self: self.__setitem__(slice(None), [11_690])  # type: ignore[attr-defined]
    output = types.SimpleNamespace(switch_to_output=lambda _: None)
    module("board", D7=7, D8=8)
    module("digitalio", DigitalInOut=lambda _: output)
    module("pulseio", PulseIn=pulse)


@pytest.mark.parametrize("board", ["micropython", "circuitpython"])
@pytest.mark.parametrize("humid", [False, True])
def test_the_example_prints_the_distance(
    board: str,
    humid: bool,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    packed = with_humidity("micropython", "c99") if humid else made("avr_table", "micropython")
    packed.save(tmp_path)
    monkeypatch.syspath_prepend(tmp_path)
    monkeypatch.delitem(sys.modules, "echocal_correction", raising=False)
    fakes(board, monkeypatch)
    with pytest.raises(EnoughError):
        runpy.run_path(str(tmp_path / "main.py"))
    codes = (11_690, 10, 5) if humid else (11_690, 40)
    assert set(capsys.readouterr().out.split()) == {str(packed.distance_um(*codes))}
