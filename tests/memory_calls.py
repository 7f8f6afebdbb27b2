"""Call what `echocal._core` computes on memory of every layout, for a checker of memory to watch.

    valgrind --error-exitcode=1 python memory_calls.py [read | write]

`.ci/memory` runs it. With `read` or `write` it does one row beyond an array what the checker must see, and
nothing else. Lengths lie around the 240 rows of a block and around the widths of vectors, arrays
are side by side, strided, turned round, or share memory with the output. Each array is allocated with
exactly its own length, so that a read or a write beyond it is seen.
"""

import importlib.util
import itertools
import sys
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
from numpy.lib.stride_tricks import as_strided


def core() -> Any:
    """The compiled core without the package around it, which takes a checker of memory a minute to import."""
    package = importlib.util.find_spec("echocal")
    assert package is not None
    assert package.origin is not None
    (place,) = Path(package.origin).parent.glob("_core*.so")
    spec = importlib.util.spec_from_file_location("_core", place)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


_core = core()
BLOCK = 240  # rows
LENGTHS = (1, 17, BLOCK - 1, BLOCK, BLOCK + 1)
LAYOUTS = ("side by side", "every third", "turned round", "constant")
EFFECTS = [("temperature_gain", [("gain", 0.02)]), ("fixed_delay", [("delay", 3e-5)])]
BENT = [*EFFECTS, ("beam_edge", [])]
METHODS = ("indicate", "speed_of_sound", "time_of_flight", "correct", "distance")
QUANTITIES = [facts["name"] for facts in _core.quantities()]

Array = np.ndarray[Any, Any]


def column(rows: int, layout: str, kind: type = np.float64, low: float = 0.1, high: float = 0.9) -> Array:
    """An array in memory of its own, of which the layout leaves no byte beyond the last row."""
    values = np.linspace(low, high, rows, dtype=kind)
    match layout:
        case "every third":
            memory = np.zeros(3 * rows - 2, kind)
            memory[::3] = values
            return memory[::3]
        case "turned round":
            return values[::-1].copy()[::-1]
        case "constant":
            return np.broadcast_to(kind(low), rows)
        case _:
            return values


def functions() -> Iterator[tuple[str, Callable[..., Array], int]]:
    """Every function over columns, with how many it takes."""
    for name, inputs in (("speed_of_sound", 4), ("time_of_flight", 5), ("distance", 5), ("error", 5)):
        yield name, getattr(_core, name), inputs
    yield "absorption", _core.absorption, 4
    yield "dispersed", lambda *given, **more: _core.distance(*given[:5], frequency=given[5], **more), 6
    for law, effects in (("linear", EFFECTS), ("virial", BENT)):
        model = _core.Model(law, effects)
        for method in METHODS:
            yield f"Model.{method}", of_model(getattr(model, method)), 3


def of_model(method: Callable[..., Array]) -> Callable[..., Array]:
    def called(first: Array, temperature: Array, other: Array, **more: Any) -> Array:
        conditions = [temperature if name == "temperature" else other for name in QUANTITIES]
        return method(first, conditions, **more)

    return called


def layouts(function: Callable[..., Array], inputs: int) -> None:
    """Every length and layout, in both precisions, into memory of its own or given."""
    for rows, layout, kind in itertools.product(LENGTHS, LAYOUTS, (np.float64, np.float32)):
        given = [column(rows, layout if k % 2 == 0 else LAYOUTS[0], kind) for k in range(inputs)]
        expected = function(*given)
        out = column(rows, layout if layout != "constant" else "side by side", kind)
        function(*given, out=out)
        np.testing.assert_array_equal(out, expected)


def overlapping(function: Callable[..., Array], inputs: int) -> None:
    """The output where an input lies, as far ahead and behind as threads and blocks can meet."""
    for rows, apart in itertools.product((BLOCK + 1, 2 * BLOCK + 16), (0, 1, 8, BLOCK)):
        for ahead in (True, False):
            memory = np.linspace(0.1, 0.9, rows + apart)
            first, last = memory[:rows], memory[apart:]
            given, out = (last, first) if ahead else (first, last)
            others = [column(rows, LAYOUTS[0]) for _ in range(inputs - 1)]
            expected = function(given.copy(), *others)
            function(given, *others, out=out)
            np.testing.assert_array_equal(out, expected)


def threads() -> None:
    """Enough rows that several threads share them, in place and apart."""
    rows = 100_001
    given = [column(rows, LAYOUTS[0]) for _ in range(5)]
    apart = _core.distance(*given, n_threads=2)
    _core.distance(*given, out=given[0], n_threads=2)
    np.testing.assert_array_equal(given[0], apart)
    given = [column(rows, LAYOUTS[0]) for _ in range(3)]
    called = of_model(_core.Model("linear", EFFECTS).correct)
    called(*[one[:16_003].copy() for one in given], n_threads=2)


def jacobians() -> None:
    model = _core.Model("virial", BENT)
    for rows in LENGTHS:
        conditions = [column(rows, LAYOUTS[0]) for _ in QUANTITIES]
        assert model.jacobian(column(rows, LAYOUTS[0]), conditions).shape[0] == rows


def domains() -> None:
    for rows, layout in itertools.product(LENGTHS, LAYOUTS):
        _core.departures("cramer", [column(rows, layout) for _ in range(5)])


def planted(what: str) -> None:
    """One row beyond an array is read or written, as NumPy says that it is there."""
    rows = 4 * BLOCK  # so many bytes that no neighbor lies where the row would be
    right = np.full(rows, 0.5)
    wrong = as_strided(np.full(rows - 1, 0.5), (rows,), (8,))
    if what == "read":
        _core.speed_of_sound(wrong, right, right, right)
    else:
        _core.speed_of_sound(right, right, right, right, out=wrong)


def main() -> None:
    if len(sys.argv) > 1:
        return planted(sys.argv[1])
    every = list(functions())
    for _, function, inputs in every:
        layouts(function, inputs)
        overlapping(function, inputs)
    _core.set_instruction_set("baseline")  # slow under a checker: one function, and one of a model
    for name, function, inputs in every:
        if name in ("absorption", "Model.correct"):
            layouts(function, inputs)
    _core.set_instruction_set(None)
    threads()
    jacobians()
    domains()
    print(f"memory: {len(every)} functions were called")


if __name__ == "__main__":
    main()
