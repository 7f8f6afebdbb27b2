"""A valid call of everything in `echocal._core`, for `core_fuzz.py` to spoil."""

import ctypes
import json
import mmap
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from echocal import _core

ROWS = 48  # a multiple of every vector's width: blocks are read where they lie
PAGE = mmap.PAGESIZE
QUANTITIES = [facts["name"] for facts in _core.quantities()]


def guard(array: Any) -> Any:
    """Copy to memory that ends where a page begins that nobody may read."""
    array = np.asarray(array)
    pages = 1 + -(-array.nbytes // PAGE)
    memory = mmap.mmap(-1, pages * PAGE)
    start = ctypes.addressof(ctypes.c_char.from_buffer(memory))
    ctypes.CDLL(None).mprotect(ctypes.c_void_p(start + (pages - 1) * PAGE), ctypes.c_size_t(PAGE), 0)
    end = (pages - 1) * PAGE
    view = np.frombuffer(memory, "u1")[end - array.nbytes : end].view(array.dtype).reshape(array.shape)
    view[...] = array
    return view


@dataclass
class Call:
    """A call with valid arguments."""

    function: Callable[..., Any]
    arguments: list[Any]
    columns: tuple[int, ...] = ()  # arguments that must agree in length
    names: list[str] = field(default_factory=list)  # of the last arguments, by keyword

    def __post_init__(self) -> None:
        self.nested = [isinstance(argument, list) for argument in self.arguments]

    def run(self) -> Any:
        split = len(self.arguments) - len(self.names)
        named = dict(zip(self.names, self.arguments[split:], strict=True))
        return self.function(*self.arguments[:split], **named)

    def lengths(self) -> set[int]:
        """Rows of the columns that must agree."""
        given = [(self.arguments[at], self.nested[at]) for at in self.columns]
        lists = [value for value, nested in given if nested and isinstance(value, list | tuple)]
        arrays = [value for value, nested in given if not nested] + [one for some in lists for one in some]
        return {len(one) for one in arrays if isinstance(one, np.ndarray) and one.ndim == 1}

    def restore(self) -> None:
        """Undo what a call may have set for the whole process."""
        if self.function is _core.set_instruction_set:
            _core.set_instruction_set(None)


def column(low: float = 0.5, high: float = 3.0, rows: int = ROWS) -> Any:
    return guard(np.linspace(low, high, rows))


def model() -> _core.Model:
    return _core.Model("linear", [("fixed_delay", [("delay", 3e-5)])])


def conditions() -> list[Any]:
    return [column(5.0, 25.0) if name == "temperature" else None for name in QUANTITIES]


def recorded() -> list[Any]:
    return [column(5.0, 25.0) if name == "temperature" else 0.5 for name in QUANTITIES]


def groups() -> Any:
    return guard(np.repeat(np.arange(4, dtype=np.uint32), ROWS // 4))


def columns() -> _core.Columns:
    made = _core.Columns(model(), column(), recorded(), groups())
    made.slope()
    made.store(column(-1.0, 1.0))
    made.tangent("zero_error", [], False, None, "offset", 1.0)
    made.legendre(column(), 0.5, 3.0, 1, [1.0, 1.0], LINES)
    made.settle()
    return made


def starts() -> Any:
    return guard(np.arange(ROWS) % 12 == 0)


def lines(text: bytes) -> Any:
    return _core.Scanner(ord(","), 1 + text.partition(b"\n")[0].count(b","), True, False, []).scan(text, True)


def layout() -> list[Any]:
    """First rows, blocks, cells, distance; block and group of each cell, series of each; correlations."""
    blocks = guard(np.repeat(np.arange(2, dtype=np.uint32), ROWS // 2))
    places, series = [(0, 0), (0, 1), (1, 2), (1, 3)], column(2.0, 2.0, rows=2)
    return [starts(), blocks, groups(), column(), places, series, [None, 0.5, (0.6, 0.3, False)], True]


def sums() -> _core.Sums:
    return columns().products(*layout())


def products() -> Any:
    table = np.random.default_rng(1).normal(size=(3, ROWS, 6))
    return guard(np.einsum("nri,nrj->nij", table, table))


def form(cause: int | None, free: list[int]) -> tuple[Any, ...]:
    """Arguments of a form."""
    return cause, [], free, [(-np.inf, np.inf)] * len(free), 1.0


def forms(given: Any) -> list[_core.Form]:
    """Forms of their arguments, which the fuzzer spoils."""
    return [_core.Form(*one) for one in given]


def fit_hypotheses(*given: Any) -> tuple[Any, ...]:
    """Fit hypotheses given as arguments of their forms."""
    *stack, hypotheses, one_width = given
    found = _core.fit_hypotheses(*stack, [forms(one) for one in hypotheses], one_width)
    return tuple((one.log_evidence, one.mean, one.covariance, one.noise, one.variance) for one in found)


def posterior(*given: Any) -> tuple[Any, ...]:
    """Search hypotheses, given everything as arguments."""
    *stack, some, prior, options = given
    found = _core.posterior(*stack, forms(some), _core.Prior(*prior), _core.SearchOptions(*options))
    return tuple((one.forms, one.prior, one.fit.log_evidence) for one in found.outcomes)


def whiten(noises: Any, used: Any) -> tuple[Any, ...]:
    """Whiten sums for noises given as arguments."""
    return sums().whiten([_core.NoiseModel(*one) for one in noises], used)


def firmware_request() -> dict[str, Any]:
    return {
        "target": "c99",
        "package": "c",
        "name": "echocal",
        "prefer": "size",
        "form": "polynomial",
        "temperature": (10.0, 0.0, 20.0, 0.0, 0),
        "thermistor": None,
        "humidity": None,
        "further": None,
        "echo": (500.0, 0.0, 20_000.0, 16),
        "output_unit": "um",
        "output_type": None,
        "maximum_error": 0.01,
        "maximum_distance": 2.0,
        "maximum_table": 1024,
        "widest": 64,
        "median": (5, 0.3),
        "threads": 1,
        "accept": [],
        "assumed": [20.0 if name == "temperature" else 0.0 for name in QUANTITIES],
        "command": "echocal",
        "diagnosis": [],
        "model_hash": "0" * 64,
        "standard_uncertainty": [(0.5, 0.001), (2.0, 0.002)],
        "fitted": [],
        "outside_domain": [],
    }


_FIRMWARE = _core.design_firmware(model(), firmware_request(), None)
_TEXTS = ("core", "compiler", "options", "simulator")
_COUNTS = ("flash_bytes", "own_flash_bytes", "ram_bytes", "stack_bytes")
_STEPS = ("cycles", "fewest_cycles", "instructions", "fewest_instructions")
MEASURED = {**dict.fromkeys(_TEXTS, "x"), **dict.fromkeys(_COUNTS, 100), **dict.fromkeys(_STEPS, 50)}
_SIDE = dict.fromkeys(("low", "span", "default", "steps", "shift", "factor", "back"), 3)
_WHOLE = ("places", "center", "slope", "mask", "most_more", "more_scale", "most_delay", "least_apart")
_AIR = (
    *("amplified", "drop", "error_K", "error_codes", "error_mm", "generator", "half", "interval"),
    *("interval_ms", "lag", "lead_drop", "lead_shift", "maximum_distance", "places", "ratio", "share"),
    "smoothing",
)
UNIT: dict[str, Any] = {
    **dict.fromkeys(("generator", "block_version", "block_bytes", "maximum_distance"), 1),
    **dict.fromkeys(("error_mm", "asked_mm"), "0.5"),
    **dict.fromkeys(_WHOLE, 7),
    **{"box": ["x"], "shares": ["x"], "natural": True, "delay": _SIDE, "rate": _SIDE},
}
STATED: dict[str, Any] = {"includes": ["x"], "expanded": [(1.0, 0.01)], "offset": 1e-3, "slope": 1e-3}


def batch(name: str, inputs: int, *, law: bool = True) -> Callable[[], Call]:
    def make() -> Call:
        arguments: list[Any] = [column() for _ in range(inputs)]
        names = [*(["law"] if law else []), "out", "where", "n_threads"]
        options = [*(["cramer"] if law else []), column(), guard(np.ones(ROWS, bool)), 2]
        return Call(getattr(_core, name), arguments + options, names=names)

    return make


def of_model(name: str) -> Callable[[], Call]:
    return lambda: Call(getattr(model(), name), [column(), conditions(), column(), 2])


def of_sums(name: str, *arguments: Any) -> Callable[[], Call]:
    return lambda: Call(getattr(sums(), name), [argument() for argument in arguments])


def of_columns(name: str, *arguments: Any, rows: tuple[int, ...] = ()) -> Callable[[], Call]:
    return lambda: Call(
        getattr(columns(), name), [a() if callable(a) else a for a in arguments], columns=rows
    )


def evidence(function: Any, *arguments: Any) -> Callable[[], Call]:
    given = [50.0, 1e-12, *arguments]
    return lambda: Call(function, [products(), column(-2.0, -1.0, rows=3), *given])


FORMS = [form(0, [1]), form(1, [2]), form(2, [3]), form(None, [4])]
PRIOR = [[0.4, 0.3, 0.2, 0.1], 0.1]
OFFSET = [("offset", 1e-3)]
LINES = [(0.1, 0.2), (0.3, 0.4)]
LEVELS = [1.0, 1.5, 2.0, 2.5]
CALLS: dict[str, Callable[[], Call]] = {
    "speed_of_sound": batch("speed_of_sound", 4),
    "time_of_flight": batch("time_of_flight", 5),
    "distance": batch("distance", 5),
    "error": batch("error", 5),
    "absorption": batch("absorption", 4, law=False),
    "__getattr__": lambda: Call(_core.__getattr__, ["distance:cramer"]),
    "instruction_sets": lambda: Call(_core.instruction_sets, []),
    "set_instruction_set": lambda: Call(_core.set_instruction_set, ["baseline"]),
    "effects": lambda: Call(_core.effects, []),
    "laws": lambda: Call(_core.laws, []),
    "quantities": lambda: Call(_core.quantities, []),
    "departure_names": lambda: Call(_core.departure_names, []),
    "departure": lambda: Call(_core.departure, ["cramer", [20.0, 0.5, 1e5, 4e-4, 0.0]]),
    "departures": lambda: Call(_core.departures, ["cramer", [column() for _ in range(5)]], columns=(1,)),
    "Model": lambda: Call(_core.Model, ["linear", [("fixed_delay", [("delay", 3e-5)])]]),
    **{f"Model.{name}": of_model(name) for name in ("indicate", "speed_of_sound", "time_of_flight")},
    **{f"Model.{name}": of_model(name) for name in ("correct", "distance")},
    "Model.jacobian": lambda: Call(
        model().jacobian, [column(), [column() for _ in QUANTITIES]], columns=(0, 1)
    ),
    "Columns": lambda: Call(_core.Columns, [model(), column(), recorded(), groups()], columns=(1, 2, 3)),
    "Columns.slope": of_columns("slope"),
    "Columns.store": lambda: of_columns("store", column)(),
    "Columns.shift": of_columns("shift", "zero_error", OFFSET, LEVELS),
    "Columns.tangent": of_columns("tangent", "zero_error", OFFSET, True, LEVELS, "offset", 1.0),
    "Columns.legendre": of_columns("legendre", column, 0.5, 3.0, 1, [1.0, 1.0], LINES),
    "Columns.waves": of_columns("waves", column, 1.0, [1.0, 1.0], LINES),
    "Columns.settle": of_columns("settle"),
    "Columns.made": of_columns("made", [0, 4], lambda: guard(np.array([0, 5, 47], np.uintp))),
    "Columns.combined": of_columns("combined", [(0, 1.0), (4, -2.0)]),
    "Columns.gram": of_columns("gram"),
    "Columns.products": lambda: Call(columns().products, layout(), columns=(0, 1, 2, 3)),
    "Sums.whiten": lambda: Call(whiten, [[(1, 0.5, 0.1, 0.7, -1.0)], [True, True]]),
    "Sums.joined": of_sums("joined", sums),
    "Sums.without_infinite": of_sums("without_infinite"),
    "Firmware.files": lambda: Call(_FIRMWARE.files, [[MEASURED], STATED]),
    "Firmware.unit_files": lambda: Call(_FIRMWARE.unit_files, [json.dumps(UNIT)]),
    "Firmware.air_files": lambda: Call(_FIRMWARE.air_files, [json.dumps(dict.fromkeys(_AIR, 3))]),
    "Firmware.filtered": lambda: Call(
        _FIRMWARE.filtered, [guard(np.arange(ROWS, dtype="i4")), guard(np.zeros(ROWS, "u1"))]
    ),
    "firmware_targets": lambda: Call(_core.firmware_targets, []),
    "output_units": lambda: Call(_core.output_units, []),
    "Firmware.ranked_by": lambda: Call(_FIRMWARE.ranked_by, []),
    "Firmware.steps": lambda: Call(_FIRMWARE.steps, []),
    "Firmware.evaluate": lambda: Call(
        _FIRMWARE.evaluate, [[guard(np.arange(ROWS)), guard(np.arange(ROWS) % 3)]], columns=(0,)
    ),
    "design_firmware": lambda: Call(_core.design_firmware, [model(), firmware_request(), lambda *_: None]),
    "echo_times": lambda: Call(_core.echo_times, [model(), firmware_request(), [0.02, 4.0]]),
    "Form": lambda: Call(_core.Form, [0, [1], [2, 3], [(-1.0, 1.0), (-np.inf, np.inf)], 0.5]),
    "NoiseModel": lambda: Call(_core.NoiseModel, [1, 0.5, 0.1, 0.7, -1.0]),
    "Prior": lambda: Call(_core.Prior, [*PRIOR]),
    "Prior.no_cause": lambda: Call(_core.Prior(*PRIOR).no_cause, [True]),
    "SearchOptions": lambda: Call(_core.SearchOptions, [25.0, 1.5, 1e-3]),
    "fit_hypotheses": evidence(fit_hypotheses, [FORMS, FORMS[:1]], False),
    "posterior": evidence(posterior, FORMS, PRIOR, [25.0, 1.5, 1e-3]),
    "preferred_form": lambda: Call(_core.preferred_form, [[0.0, -1.0], [1, 2], 1.5]),
    "Scanner": lambda: Call(_core.Scanner, [44, 2, True, False, [b"a,b"]]),
    "Scanner.scan": lambda: Call(_core.Scanner(44, 2, True, False, []).scan, [b'1,2\n3,"4\n', False]),
    "Lines.unread": lambda: Call(lines(b"1,2\n3,4,5\n").unread, []),
    "Lines.records": lambda: Call(lines(b'1,2\n3,"4"\n').records, []),
    "Lines.short": lambda: Call(lines(b"1,2\n3\n").short, []),
    "Lines.numbers": lambda: Call(lines(b"1,2\n3,4\n").numbers, [[0], 46, [b""]]),
    "Lines.texts": lambda: Call(lines(b'1,a\n3,"b"\n').texts, [[0, 1]]),
    "Lines.with_results": lambda: Call(
        lines(b"1\n" * ROWS).with_results,
        [column(), column().astype(np.float32), guard(np.zeros(ROWS, np.int16)), [b"\n"], 46],
        columns=(0, 1, 2),
    ),
    "whitened": lambda: Call(
        _core.whitened, [0.5, 0.3, 0.9, column(), starts(), column()], columns=(3, 4, 5)
    ),
}


RESULTS = {"Firmware", "Sums", "HypothesisFit", "Outcome", "Posterior", "Lines"}
"""Classes that come from other calls alone."""


def public_names() -> set[str]:
    """Everything that the core offers, and what its classes do."""
    names = {"__getattr__"}
    for name in dir(_core):
        if name.startswith("__"):
            continue
        thing = getattr(_core, name)
        made = isinstance(thing, type)
        if not made or name not in RESULTS:
            names.add(name)
        own = (method for method in vars(thing) if not method.startswith("_")) if made else ()
        names |= {f"{name}.{method}" for method in own if callable(getattr(thing, method))}
    return names
