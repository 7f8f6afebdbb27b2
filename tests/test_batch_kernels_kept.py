"""Kernels of many laws: a program that goes through them does not grow, and what it holds still travels."""

import inspect
import pickle
import subprocess
import sys

import pytest

import echocal
from echocal import _core

GROWTH = """
from echocal import _core

def pages() -> int:
    with open("/proc/self/statm") as status:
        return int(status.read().split()[1])

def ask(first: int) -> None:
    for law in range(first, first + 3000):
        _core.__getattr__(f"distance:331,{law:05d}+0,6*T")

ask(0)
before = pages()
ask(3000)
print(pages() - before)
"""


@pytest.mark.skipif(sys.platform != "linux", reason="Linux says what memory a process has in /proc")
def test_memory_does_not_grow_with_the_laws() -> None:
    """Kept for ever, 3000 kernels took 1450 pages of 4 kB."""
    done = subprocess.run([sys.executable, "-c", GROWTH], capture_output=True, text=True, check=True)
    assert int(done.stdout) < 300


def test_a_function_that_is_held_stays_the_one_of_its_name() -> None:
    held = _core.__getattr__("distance:331,25+0,6*T")
    for law in range(200):
        _core.__getattr__(f"distance:332,{law:03d}+0,6*T")
    assert pickle.loads(pickle.dumps(held)) is held
    assert held(0.01, 20.0, 0.0, 1e5, 4e-4) == echocal.distance(0.01, 20.0, 0.0, 1e5, law="331.25+0.6*T")


@pytest.mark.parametrize("name", ["speed_of_sound", "time_of_flight", "distance", "error"])
def test_the_air_by_default_is_that_of_the_quantities(name: str) -> None:
    """Signatures tell the defaults, which the core has once."""
    parameters = inspect.signature(getattr(_core, name)).parameters
    told = {key: parameters[key].default for key in ("relative_humidity", "pressure", "co2_mole_fraction")}
    assert told == {q["name"]: q["default"] for q in _core.quantities() if q["name"] in told}
