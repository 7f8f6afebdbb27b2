"""What is measured: each case is a name and a function without arguments, on one set of inputs."""

import math
from collections.abc import Callable

import numpy as np
import peers
from numpy.typing import NDArray

import echocal

Case = Callable[[], object]


def inputs(rows: int, kind: type[np.floating]) -> list[NDArray[np.floating]]:
    """Time of flight, temperature, humidity and pressure, within every peer's range."""
    random = np.random.default_rng(0)
    bounds = ((0.001, 0.03), (0.0, 30.0), (0.0, 1.0), (9e4, 1.02e5))
    return [random.uniform(low, high, rows).astype(kind) for low, high in bounds]


def columns(rows: int, kind: type[np.floating]) -> dict[str, Case]:
    """Whole columns, into an array that is there already."""
    data = inputs(rows, kind)
    time, temperature = data[:2]
    out = np.zeros(rows, kind)
    cases: dict[str, Case] = {
        "numpy naive, 1 thread": lambda: peers.numpy_naive(out, *data),
        "numpy chunked, 1 thread": lambda: peers.numpy_chunked(out, *data),
        "pyfar, 1 thread": lambda: peers.pyfar_distance(out, *data),
        "numpy linear, 1 thread": lambda: peers.numpy_linear(out, time, temperature),
    }
    for n in (1, 2):
        of = f"{n} thread{'s' if n > 1 else ''}"
        five, three, numba = peers.memory_of_five(n), peers.memory_of_three(n), peers.numba_distance(n)
        cases |= {
            f"memory of five, {of}": lambda f=five: f(out, *data),
            f"memory of three, {of}": lambda f=three: f(out, time, temperature),
            f"echocal distance, {of}": lambda n=n: echocal.distance(*data, out=out, n_threads=n),
            f"echocal linear, {of}": lambda n=n: echocal.distance(
                time, temperature, law="linear", out=out, n_threads=n
            ),
            f"numba distance, {of}": lambda f=numba: f(out, *data),
        }
    return cases


def calls() -> tuple[dict[str, str], dict[str, object]]:
    """One row and a hundred rows: statements, timed without a call around them, and their names."""
    data = inputs(100, np.float64)
    names = {"echocal": echocal, "peers": peers, "exp": math.exp, "np": np, "data": data, "air": data[1:]}
    statements = {
        "echocal, one row, positional": "echocal.distance(0.01, 20.0, 0.5, 1e5)",
        "echocal, one row, keywords": (
            "echocal.distance(time_of_flight=0.01, temperature=20.0, relative_humidity=0.5)"
        ),
        "python math, one row": "0.005 * peers.cramer(20.0, 0.5, 1e5, exp)",
        "numpy, one row": "0.005 * peers.cramer(np.float64(20.0), 0.5, 1e5)",
        "pyfar, one row": "0.005 * peers.pyfar_speed(20.0, 0.5, 1e5)",
        "echocal, 100 rows": "echocal.distance(*data)",
        "numpy, 100 rows": "0.5 * data[0] * peers.cramer(*air)",
        "pyfar, 100 rows": "0.5 * data[0] * peers.pyfar_speed(*air)",
    }
    return statements, names
