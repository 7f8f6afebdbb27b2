"""Output over input: whatever memory `out` shares, the answer is the one for copied inputs, bit for bit."""

import warnings
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray as xr
from hypothesis import given, note, settings
from hypothesis import strategies as st
from numpy.lib.stride_tricks import as_strided
from numpy.typing import NDArray

import echocal
from echocal import DomainWarning, UsageError

Array = NDArray[Any]
Call = Callable[..., Any]

MODEL = echocal.Model("linear", {"fixed_delay": {"delay": 3e-5}})
FUNCTIONS: dict[str, Call] = {
    name: getattr(echocal, name)
    for name in ("speed_of_sound", "absorption", "time_of_flight", "distance", "error")
}
SEVERAL = echocal.Model(
    "cramer",
    {
        "fixed_delay": {"delay": 3e-5},
        "temperature_gain": {"gain": 0.02},
        "clock_error": {"frequency_error": 2e-4},
        "zero_error": {"offset": -4e-3},
    },
)
METHODS: dict[str, Call] = {
    f"Model.{name}": getattr(MODEL, name)
    for name in ("indicate", "speed_of_sound", "time_of_flight", "correct", "distance")
}
SEVERAL_THREADS = {**dict.fromkeys(FUNCTIONS, 130_000), **dict.fromkeys(METHODS, 20_000)}  # rows


def called(name: str, inputs: list[Any], **options: Any) -> Any:
    """Call with three inputs, the others plain numbers."""
    with warnings.catch_warnings(), np.errstate(all="ignore"):
        warnings.simplefilter("ignore", DomainWarning)
        warnings.simplefilter("ignore", RuntimeWarning)
        if name in METHODS:
            first, temperature, humidity = inputs
            return METHODS[name](first, temperature=temperature, relative_humidity=humidity, **options)
        others = [40e3] if name == "absorption" else []
        return FUNCTIONS[name](*inputs, *others, **options)


def check(name: str, memory: Array, inputs: list[Any], out: Array, **options: Any) -> None:
    """Compare the whole memory with what copied inputs and an output of its own give."""
    fresh = [value.copy() if isinstance(value, np.ndarray) else value for value in inputs]
    apart = {key: np.array(value) if key == "where" else value for key, value in options.items()}
    own = np.array(out)
    called(name, fresh, out=own, **apart)
    expected = memory.copy()
    lies_at = out.__array_interface__["data"][0] - memory.__array_interface__["data"][0]
    np.ndarray(out.shape, out.dtype, expected, lies_at, out.strides)[...] = own
    assert called(name, inputs, out=out, **options) is out
    np.testing.assert_array_equal(out, own)  # NaN is NaN, whatever its bits
    same = np.ones(memory.shape, dtype=bool)
    np.ndarray(out.shape, (np.void, out.dtype.itemsize), same, lies_at, out.strides)[...] = b"\0"
    np.testing.assert_array_equal(memory[same], expected[same])  # beside the output nothing changed


def is_nested(view: Array) -> bool:
    """Whether each axis steps over all that the axes of shorter steps reach."""
    span = view.itemsize
    for stride, count in sorted((abs(s), n) for s, n in zip(view.strides, view.shape, strict=True) if n > 1):
        if stride < span:
            return False
        span += stride * (count - 1)
    return True


def bytes_of(view: Array, memory: Array) -> Array:
    """Where each element begins, in bytes."""
    start = view.__array_interface__["data"][0] - memory.__array_interface__["data"][0]
    for length, stride in zip(view.shape, view.strides, strict=True):
        start = np.add.outer(start, stride * np.arange(length))
    return np.sort(np.ravel(start))


@st.composite
def views(draw: st.DrawFn, memory: Array, shape: tuple[int, ...], kinds: list[str]) -> Array:
    """Draw a view of this shape: any dtype, strides, directions and offset, aligned or not."""
    kind = np.dtype(draw(st.sampled_from(kinds)))
    strides, span = [0] * len(shape), 0
    for axis in draw(st.permutations(range(len(shape)))):
        unit = draw(st.sampled_from([kind.itemsize, kind.itemsize, span + kind.itemsize, 1]))
        strides[axis] = unit * draw(st.integers(-3, 3))
        span += abs(strides[axis]) * (shape[axis] - 1)
    unit = draw(st.sampled_from([kind.itemsize, kind.itemsize, 1]))
    offset = unit * draw(st.integers(0, min(96, (memory.nbytes - span - kind.itemsize) // unit)))
    first = offset - sum(min(0, stride * (n - 1)) for stride, n in zip(strides, shape, strict=True))
    return np.ndarray(shape, kind, memory, first, tuple(strides))


def peak() -> int:
    """Return the largest memory of this process since the last call [bytes]."""
    status = Path("/proc/self/status").read_text()
    Path("/proc/self/clear_refs").write_text("5")
    return 1024 * int(status.split("VmHWM:")[1].split()[0])


SHAPES = st.sampled_from([(1,), (7,), (33,), (300,), (3, 5), (4, 4), (17, 17), (2, 3, 4)])
INPUTS = ["f8", "f8", "f8", "f4", "f4", "i8", "i2", ">f8", "?"]
OUTPUTS = ["f8", "f8", "f8", "f4", "f4", ">f8", "<f4", "f2"]


def buffer(rows: int) -> Array:
    values = np.random.default_rng(rows).uniform(0.1, 3.0, 40 * rows + 200)
    return values.view(np.uint8)


@pytest.mark.slow
@settings(max_examples=400, deadline=None, print_blob=True)
@given(data=st.data(), name=st.sampled_from([*FUNCTIONS, *METHODS]), shape=SHAPES)
def test_any_views_of_one_memory(data: st.DataObject, name: str, shape: tuple[int, ...]) -> None:
    memory = buffer(int(np.prod(shape)))
    inputs = [data.draw(views(memory, shape, INPUTS)) for _ in range(3)]
    out = data.draw(views(memory, shape, OUTPUTS))
    options: dict[str, Any] = {"n_threads": data.draw(st.sampled_from([None, 1, 3]))}
    if name in FUNCTIONS and data.draw(st.booleans()):
        memory[:] &= 1 if data.draw(st.integers(0, 9)) == 0 else 255
        options["where"] = data.draw(views(memory, shape, ["?"])) & True
    note(f"{name}: out {out.dtype} {out.strides}, inputs {[(i.dtype, i.strides) for i in inputs]}")
    if is_nested(out):
        assert (np.diff(bytes_of(out, memory)) >= out.dtype.itemsize).all()
        check(name, memory, inputs, out, **options)
    else:
        before = memory.copy()
        with pytest.raises(UsageError, match="elements share memory, or may"):
            called(name, inputs, out=out, **options)
        np.testing.assert_array_equal(memory, before)


@settings(max_examples=40, deadline=None, print_blob=True)
@given(data=st.data(), name=st.sampled_from([*FUNCTIONS, *METHODS]))
def test_any_views_of_many_rows(data: st.DataObject, name: str) -> None:
    """Enough rows for several threads."""
    rows = SEVERAL_THREADS[name] + data.draw(st.integers(0, 999))
    kind = data.draw(st.sampled_from(["f8", "f8", "f4"]))
    memory = np.random.default_rng(rows).uniform(0.1, 3.0, 3 * rows + 500).astype(kind)

    def view() -> Array:
        step = data.draw(st.sampled_from([1, 1, 1, 2, -1, -2]))
        first = data.draw(st.integers(0, 499)) - min(0, step * (rows - 1))
        return memory[first:][:: abs(step)][:rows] if step > 0 else memory[first::step][:rows]

    inputs = [view(), view(), 0.4]
    threads = data.draw(st.sampled_from([None, 1, 2, 5]))
    check(name, memory.view(np.uint8), inputs, view(), n_threads=threads)


@pytest.mark.slow
@pytest.mark.parametrize("kind", ["f8", "f4"])
@pytest.mark.parametrize("shift", [1, -1, 7, 240, 1000])
@pytest.mark.parametrize("name", [*FUNCTIONS, *METHODS])
def test_shifted_by_some_rows(name: str, shift: int, kind: str) -> None:
    """The case that was wrong in one run of three: threads met where one's output is the next one's input."""
    rows = SEVERAL_THREADS[name]
    for seed in range(4):
        memory = np.random.default_rng(seed).uniform(0.1, 3.0, rows + abs(shift)).astype(kind)
        ahead, behind = memory[abs(shift) :], memory[: -abs(shift)]
        first, out = (ahead, behind) if shift > 0 else (behind, ahead)
        check(name, memory.view(np.uint8), [first, 20.0, 0.4], out, n_threads=4)


@pytest.mark.parametrize("kind", ["f8", "f4"])
@pytest.mark.parametrize(
    "call",
    [echocal.distance, echocal.time_of_flight, MODEL.correct, SEVERAL.indicate, SEVERAL.correct],
    ids=["distance", "time_of_flight", "one effect", "several effects", "several effects, inverse"],
)
def test_an_input_ahead_of_the_output(call: Call, kind: str) -> None:
    """NumPy copies no such input: a thread that begins in the middle would overwrite what another reads."""
    rows = 110_003  # several threads in either precision, for models too
    for shift in (1, 24, 333):
        for seed in range(3):
            memory = np.random.default_rng(seed).uniform(0.1, 3.0, rows + shift).astype(kind)
            first, out = memory[shift:], memory[:-shift]
            expected = call(first.copy(), temperature=20.0, n_threads=4)
            assert call(first, temperature=20.0, out=out, n_threads=4) is out
            np.testing.assert_array_equal(out, expected)


@pytest.mark.parametrize("name", [*FUNCTIONS, *METHODS])
def test_transposed_and_beside(name: str) -> None:
    side = int(SEVERAL_THREADS[name] ** 0.5) + 1
    square = np.random.default_rng(5).uniform(0.1, 3.0, (side, side))
    check(name, square.reshape(-1).view(np.uint8), [square, square.T, 0.4], square.T)
    table = np.random.default_rng(6).uniform(0.1, 3.0, (SEVERAL_THREADS[name], 3))
    memory = table.reshape(-1).view(np.uint8)
    check(name, memory, [table[:, 0], table[:, 2], 0.4], table[:, 1], n_threads=3)
    check(name, memory, [table[:, 0], table[:, 1], 0.4], table[:, 1], n_threads=3)
    check(name, memory, [table[::-1, 0], table[:, 1], 0.4], table[:, 0], n_threads=3)


@pytest.mark.parametrize("name", FUNCTIONS)
def test_condition_among_what_is_written(name: str) -> None:
    memory = np.random.default_rng(7).uniform(0.1, 3.0, 400_001)
    where = memory[:50_000].view(bool)[: 400_000 - 8]
    memory[:50_000].view(np.uint8)[:] &= 1
    check(name, memory.view(np.uint8), [memory[9:], 20.0, 0.4], memory[1:-8], where=where, n_threads=3)


@pytest.mark.skipif(not Path("/proc/self/clear_refs").exists(), reason="only Linux tells the peak")
@pytest.mark.parametrize("layout", ["side by side", "every third", "backwards", "transposed", "2-D"])
@pytest.mark.parametrize("name", ["distance", "Model.correct"])
def test_in_place_makes_no_copy(name: str, layout: str) -> None:
    rows = 1_000_000
    wide = np.random.default_rng(8).uniform(0.1, 3.0, 3 * rows)
    views: dict[str, Array] = {
        "side by side": wide,
        "every third": wide[::3],
        "backwards": wide[::-1],
        "transposed": wide.reshape(3, rows).T,
        "2-D": wide.reshape(3, rows)[:, 5:-5],
    }
    values = views[layout]
    expected = called(name, [values.copy(), 20.0, 0.4])
    called(name, [values[:1], 20.0, 0.4])  # the kernel is made, its modules are there
    peak()
    before = peak()
    called(name, [values, 20.0, 0.4], out=values)
    assert peak() - before < values.nbytes / 2
    np.testing.assert_array_equal(values, expected)


@pytest.mark.parametrize("name", [*FUNCTIONS, *METHODS])
def test_out_that_shares_its_own_memory_is_refused(name: str) -> None:
    memory = np.full(64, 1.5)
    crossed = ((2, 3), (24, 16))  # elements 0, 2, 4 and 3, 5, 7: each has its own, which nobody looks at
    shared = [((6,), (0,)), ((6,), (4,)), ((2, 6), (8, 8)), ((3, 2, 2), (16, 8, 16))]
    for shape, strides in [*shared, crossed]:
        out = as_strided(memory, shape, strides)
        with pytest.raises(UsageError, match=r"out has shape .* share memory, or may; .*numpy\.empty"):
            called(name, [np.full(shape, 1.5), 20.0, 0.4], out=out)
    assert (memory == 1.5).all()


@pytest.mark.parametrize("name", [*FUNCTIONS, *METHODS])
def test_slices_of_every_kind_are_no_such_out(name: str) -> None:
    whole = np.zeros((6, 5, 8))
    views = [whole[::2], whole[:, ::-1], whole.T, whole[1:3, 4:, ::-3], whole[:, None, 2], whole[:0]]
    for out in views:
        values = np.random.default_rng(9).uniform(0.1, 3.0, out.shape)
        assert called(name, [values, 20.0, 0.4], out=out) is out
        np.testing.assert_array_equal(out, called(name, [values, 20.0, 0.4]))


def test_outputs_that_do_not_fit() -> None:
    time = np.full(4, 0.01)
    fixed = np.empty(4)
    fixed.flags.writeable = False
    cases: list[tuple[Any, str]] = [
        (np.empty(3), r"out has shape \(3,\), but the result has shape \(4,\)"),
        (np.empty(()), r"out has shape \(\), but the result has shape \(4,\)"),
        (np.empty(4, dtype=int), "out has dtype int64, which cannot hold the result"),
        (np.empty(4, dtype=bool), "out has dtype bool, which cannot hold the result"),
        (np.empty(4, dtype="M8[s]"), r"out has dtype datetime64\[s\], which cannot hold"),
        (fixed, "out is read-only"),
        ([0.0] * 4, "out must be a NumPy array, but is a list"),
        ("out.npy", "out must be a NumPy array, but is a str"),
        ((np.empty(4), np.empty(4)), "out must be one array, but is a tuple of 2"),
    ]
    for out, message in cases:
        with pytest.raises(UsageError, match=message) as caught:
            echocal.distance(time, 20.0, out=out)
        assert "\n" not in str(caught.value)
        if not isinstance(out, tuple):
            with pytest.raises(UsageError, match=message):
                MODEL.correct(time, temperature=20.0, out=out)


def test_what_is_known_of_an_output_names_its_cause() -> None:
    with pytest.raises(UsageError, match="out has shape") as caught:
        echocal.distance(np.full(4, 0.01), 20.0, out=np.empty(3))
    assert "broadcast" in str(caught.value.__cause__)


def test_errors_of_others_stay_theirs() -> None:
    """With an output as without: it is not at fault for what xarray refuses."""
    time = xr.DataArray(np.full(4, 0.01), dims="row", coords={"row": range(4)})
    warm = xr.DataArray(np.full(4, 20.0), dims="row", coords={"row": range(1, 5)})
    for options in ({}, {"out": np.empty(4)}):
        refused = pytest.raises(ValueError, match="cannot align")
        with xr.set_options(arithmetic_join="exact"), refused as caught:
            echocal.distance(time, warm, **options)
        assert not isinstance(caught.value, UsageError)


class Named(np.ndarray):
    """An array with a name, as users make them."""


def test_outputs_of_every_make() -> None:
    time = np.linspace(0.001, 0.03, 50)
    expected = echocal.distance(time, 20.0)
    packed = np.zeros(50, dtype=[("flag", "i1"), ("value", "f8")])
    made: list[Array] = [packed["value"], np.empty(50, ">f8"), np.empty(50).view(Named), np.ma.zeros(50)]
    for out in made:
        assert echocal.distance(time, 20.0, out=out) is out
        np.testing.assert_array_equal(out, expected)
    assert not packed["flag"].any()
    swapped = time.astype(">f8")
    echocal.distance(swapped, 20.0, out=swapped)
    np.testing.assert_array_equal(swapped, expected)
