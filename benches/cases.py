"""What is measured: each case is a name and a function without arguments, on one set of inputs."""

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import peers
from numpy.typing import NDArray

import echocal
from echocal import _core


@dataclass(frozen=True)
class Case:
    """A function, and the instruction set that echocal computes with."""

    run: Callable[[], object]
    instruction_set: str | None = None
    threads: int = 1


Cases = dict[str, Case]
LARGE = 4_000_000  # rows: far more than any cache holds
IN_CACHE = (1_000, 10_000, 100_000)
FOUR_EFFECTS = [
    ("fixed_delay", [("delay", 31e-6)]),
    ("clock_error", [("frequency_error", 1e-4)]),
    ("zero_error", [("offset", -4e-3)]),
]
OF_THE_AIR = [("temperature_gain", [("gain", 0.01)])]
OF_THE_PATH = [("reference_scale", [("scale", 1e-3)])]


def instruction_sets() -> list[str]:
    """Return those that a wheel chooses on a processor of today: the widest and AVX2."""
    return [name for name in _core.instruction_sets() if name != "baseline"] or ["baseline"]


def inputs(rows: int, kind: type[np.floating]) -> list[NDArray[np.floating]]:
    """Time of flight, temperature, humidity and pressure, within every peer's range."""
    random = np.random.default_rng(0)
    bounds = ((0.001, 0.03), (0.0, 30.0), (0.0, 1.0), (9e4, 1.02e5))
    return [random.uniform(low, high, rows).astype(kind) for low, high in bounds]


def ours(rows: int, kind: type[np.floating], threads: tuple[int, ...]) -> Cases:
    """echocal and the memory roof, by instruction set and threads."""
    data = inputs(rows, kind)
    time, temperature = data[:2]
    out = np.zeros(rows, kind)
    cases: Cases = {}
    for n in threads:
        of = f"{n} thread{'s' if n > 1 else ''}"
        five, three = peers.memory_of_five(n), peers.memory_of_three(n)
        cases |= {
            f"memory of five, {of}": Case(lambda f=five: f(out, *data), threads=n),
            f"memory of three, {of}": Case(lambda f=three: f(out, time, temperature), threads=n),
        }
        for name in instruction_sets():
            cases |= {
                f"echocal distance, {name}, {of}": Case(
                    lambda n=n: echocal.distance(*data, out=out, n_threads=n), name, n
                ),
                f"echocal linear, {name}, {of}": Case(
                    lambda n=n: echocal.distance(time, temperature, law="linear", out=out, n_threads=n),
                    name,
                    n,
                ),
            }
    cases["numpy linear in three calls, 1 thread"] = Case(
        lambda: peers.numpy_linear_in_place(out, time, temperature)
    )
    return cases


def rivals(rows: int, kind: type[np.floating]) -> Cases:
    """Other libraries, whole columns, into an array that is there already."""
    data = inputs(rows, kind)
    out = np.zeros(rows, kind)
    cases = {
        "numpy naive, 1 thread": Case(lambda: peers.numpy_naive(out, *data)),
        "numpy chunked, 1 thread": Case(lambda: peers.numpy_chunked(out, *data)),
        "pyfar, 1 thread": Case(lambda: peers.pyfar_distance(out, *data)),
    }
    for n in (1, 2):
        of = f"{n} thread{'s' if n > 1 else ''}"
        numba = peers.numba_distance(n)
        cases[f"numba distance, {of}"] = Case(lambda f=numba: f(out, *data), threads=n)
    return cases


def models(rows: int) -> Cases:
    """Models of four effects, by what they compute; one of the effects is of the air, or none."""
    time, *air = inputs(rows, np.float64)
    out, far = np.zeros(rows), 170.0 * time
    conditions = [*air, *[None] * (len(_core.quantities()) - len(air))]
    cases: Cases = {}
    for name in instruction_sets():
        for told, fourth in (("one of the air", OF_THE_AIR), ("none of the air", OF_THE_PATH)):
            model = _core.Model("cramer", [*FOUR_EFFECTS, *fourth])
            for of, column in (("indicate", far), ("distance", time), ("correct", far)):
                call = getattr(model, of)
                cases[f"four effects, {told}, {of}, {name}"] = Case(
                    lambda call=call, column=column: call(column, conditions, out, 1), name
                )
    return cases


def calls() -> tuple[dict[str, str], dict[str, object]]:
    """One row and a hundred rows: statements, timed without a call around them, and their names."""
    data = inputs(100, np.float64)
    one = [column[:1].copy() for column in data]
    names: dict[str, object] = {
        "echocal": echocal,
        "peers": peers,
        "exp": math.exp,
        "np": np,
        "data": data,
        "air": data[1:],
        "one": one,
        "out": np.zeros(1),
    }
    statements = {
        "echocal, one row, positional": "echocal.distance(0.01, 20.0, 0.5, 1e5)",
        "echocal, one row, keywords": (
            "echocal.distance(time_of_flight=0.01, temperature=20.0, relative_humidity=0.5)"
        ),
        "python math, one row": "0.005 * peers.cramer(20.0, 0.5, 1e5, exp)",
        "numpy, one row": "0.005 * peers.cramer(np.float64(20.0), 0.5, 1e5)",
        "pyfar, one row": "0.005 * peers.pyfar_speed(20.0, 0.5, 1e5)",
        "echocal, array of one row": "echocal.distance(*one, out=out)",
        "echocal, 100 rows": "echocal.distance(*data)",
        "numpy, 100 rows": "0.5 * data[0] * peers.cramer(*air)",
        "pyfar, 100 rows": "0.5 * data[0] * peers.pyfar_speed(*air)",
    }
    return statements, names
