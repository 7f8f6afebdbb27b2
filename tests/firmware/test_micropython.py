"""The module for MicroPython and CircuitPython, run by CPython and by MicroPython itself."""

import ast
import itertools
import runpy
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from boards.micro import execute
from boards.python import BOARDS, EnoughError, fakes
from conftest import CASES, made, with_humidity

from echocal import Model, firmware
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


def compact(packed: Firmware) -> str:
    """The module without its comments: pasted with them, some are too much for the 16 KB of a micro:bit."""
    tree = ast.parse(packed.files["echocal_correction.py"])
    for part in ast.walk(tree):
        if isinstance(part, ast.Module | ast.FunctionDef) and ast.get_docstring(part) is not None:
            del part.body[0]
    return ast.unparse(tree)


NO_DISTANCE = -(2**31)
PRINT_ALL = """
for echo in %s:
    for codes in %s:
        print(distance_um(echo, *codes))
"""
# On the heap of a micro:bit; a call that needs it fails with MemoryError.
WITHOUT_HEAP = """
import micropython
def call(inputs):
    micropython.heap_lock()
    try:
        for codes in inputs:
            %s
    except MemoryError:
        return "heap"
    finally:
        micropython.heap_unlock()
    return "no heap"
print(call(%s))
"""


@pytest.mark.slow
@pytest.mark.parametrize("name", [*(name for name in CASES if name != "full_table"), "humid"])
def test_micropython_gives_the_bits_of_the_twin(name: str) -> None:
    """On the core of a micro:bit; a table of every code is too much for its 16 KB."""
    packed = with_humidity("micropython", "c99") if name == "humid" else made(name, "micropython")
    device = packed.report["device"]
    echo, *axes = (beyond(axis["codes"], 5) for axis in (device["echo"], *device["conditions"]))
    rows = list(itertools.product(*axes))[:: len(axes)]
    *_, said = execute(compact(packed), PRINT_ALL % (echo, rows))
    inputs = [(time, *row) for time in echo for row in rows]
    assert list(map(int, said.split())) == packed.distance_um(*np.transpose(inputs)).tolist()


@pytest.mark.slow
@pytest.mark.parametrize("name", [*(name for name in CASES if name != "full_table"), "humid"])
def test_a_call_needs_no_heap(name: str) -> None:
    """It took 96 bytes where the target was far and warm: products of 31 bits and more."""
    packed = with_humidity("micropython", "c99") if name == "humid" else made(name, "micropython")
    device = packed.report["device"]
    axes = [axis["codes"] for axis in (device["echo"], *device["conditions"])]
    inputs = list(itertools.product(*((codes["minimum"], codes["maximum"]) for codes in axes)))
    arguments = ", ".join(f"codes[{index}]" for index in range(len(axes)))
    calls = [f"distance_um({arguments})", "codes[0] * 65536"]
    programs = [WITHOUT_HEAP % (text, inputs) for text in calls]
    *_, said, control = execute(compact(packed), *programs)
    assert said == "no heap"
    assert control == "heap", "a product that is not small is noticed"


@pytest.mark.slow
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
    assert "passed, 441 lines" in capsys.readouterr().out
    monkeypatch.delitem(sys.modules, "echocal_correction")
    golden = Path("echocal_golden.csv")
    golden.write_text(golden.read_text() + "11690,40,1,0\n")
    assert runpy.run_path("echocal_selftest.py")["WRONG"] == ["11690,40,1,0"]
    assert "FAILED at 11690,40,1,0" in capsys.readouterr().out


@pytest.mark.parametrize("board", BOARDS)
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
    fakes(board, monkeypatch, [11_690, 580])
    with pytest.raises(EnoughError):
        runpy.run_path(str(tmp_path / "main.py"))
    codes = [(echo, 10, 5) if humid else (echo, 40) for echo in (11_690, 580)]
    told = [int(line) for line in capsys.readouterr().out.split()]
    assert told == [int(packed.distance_um(*one)) for one in codes]


@pytest.mark.parametrize("board", BOARDS)
@pytest.mark.parametrize("ticks", [False, True])
def test_without_an_echo_there_is_no_distance(
    board: str,
    ticks: bool,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    """Not even where echo 0 is accepted, and -1 is nearer to tick 0 than to any other."""
    request = {"echo": (4.0, 30_000, 0)} if ticks else {}
    packed = firmware.generate(
        Model("cramer"), package="micropython", temperature=(0.5, -20.0, 60.0), **request
    )
    packed.save(tmp_path)
    monkeypatch.syspath_prepend(tmp_path)
    monkeypatch.delitem(sys.modules, "echocal_correction", raising=False)
    fakes(board, monkeypatch, [0, 38_000, 130_000, 11_690])
    with pytest.raises(EnoughError):
        runpy.run_path(str(tmp_path / "main.py"))
    *told, last = capsys.readouterr().out.splitlines()
    assert len(told) > 2, "the long pulse is told of, too"
    assert set(told) == {"no echo"}
    assert int(last) == packed.distance_um(2_922 if ticks else 11_690, 40), "and the next echo is heard"


@pytest.mark.parametrize("board", BOARDS)
@pytest.mark.filterwarnings("ignore::echocal.DomainWarning")  # of time-outs that are accepted
def test_no_accepted_echo_is_too_long_to_wait_for(
    board: str,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
    random: np.random.Generator,
) -> None:
    """MicroPython gave up after 60 ms. PulseIn gave 65,535 us, and a distance, for all that was longer."""
    last = int(random.integers(70_000, 250_000)) // 4 * 4
    packed = firmware.generate(
        Model("cramer"), package="micropython", temperature=(0.5, -20.0, 60.0), echo=(4.0, last)
    )
    packed.save(tmp_path)
    monkeypatch.syspath_prepend(tmp_path)
    monkeypatch.delitem(sys.modules, "echocal_correction", raising=False)
    near, far = [11_688, 60_500], [int(random.integers(66_000, last)), last]
    fakes(board, monkeypatch, [*near, *far])
    with pytest.raises(EnoughError):
        runpy.run_path(str(tmp_path / "main.py"))
    told = capsys.readouterr().out.splitlines()
    expected = [str(packed.outputs(round(length / 4), 40)) for length in (*near, *far)]
    assert str(NO_DISTANCE) not in expected
    if board == "micropython":
        assert told == expected
    else:
        assert told[:2] == expected[:2]
        assert set(told[2:]) == {"no echo"}


def test_what_micropython_gives_without_a_pulse_is_out_of_range() -> None:
    """Its own time_pulse_us, on the core of a micro:bit: it says so with a negative length."""
    ask = (
        "from machine import time_pulse_us",
        "from microbit import pin0",
        "length = time_pulse_us(pin0, 1, 2000)",
        "print(length, distance_um(length, 40) == OUT_OF_RANGE)",
    )
    *_, said = execute(compact(made("degree_2", "micropython")), "\n".join(ask))
    length, refused = said.split()
    assert int(length) < 0
    assert refused == "True"
