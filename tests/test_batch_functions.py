"""The batch functions over arrays: shapes, memory, precision, not-a-number, messages."""

import doctest

import numpy as np
import pytest
import xarray as xr
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as arrays
from numpy.typing import NDArray

import echocal
from echocal import _core

FUNCTIONS = ("speed_of_sound", "time_of_flight", "distance", "error", "absorption")
LAWS = [facts["id"] for facts in _core.laws()]


@pytest.mark.parametrize("name", FUNCTIONS)
def test_docstring_examples(name: str) -> None:
    text = getattr(echocal, name).__doc__
    for section in ("Parameters", "Returns", "Raises", "References", "Examples"):
        assert f"\n{section}\n{'-' * len(section)}\n" in text
    test = doctest.DocTestParser().get_doctest(text, {}, name, None, None)
    assert test.examples
    assert doctest.DocTestRunner().run(test).failed == 0


@pytest.mark.parametrize("law", [*LAWS, "331.3+0.606*T"])
def test_functions_agree_with_each_other(law: str) -> None:
    temperature, humidity = np.linspace(-20, 60, 301), np.linspace(0, 1, 301)
    speed = echocal.speed_of_sound(temperature, humidity, law=law)
    time = echocal.time_of_flight(1.5, temperature, humidity, law=law)
    np.testing.assert_allclose(time, 3.0 / speed, rtol=4e-16)
    np.testing.assert_allclose(echocal.distance(time, temperature, humidity, law=law), 1.5, rtol=4e-16)
    error = echocal.error(1.5, temperature, humidity, law=law, reading_speed=343)
    np.testing.assert_allclose(error, 343 * time / 2 - 1.5, atol=1e-15)


def test_agrees_with_the_model() -> None:
    model = echocal.Model("cramer")
    temperature = np.linspace(-10, 50, 100)
    time = echocal.time_of_flight(2.0, temperature, 0.3)
    expected = model.time_of_flight(2.0, temperature=temperature, relative_humidity=0.3)
    # many rows take the saturation pressure from a polynomial, within 2e-9 of the exponential
    np.testing.assert_allclose(time, expected, rtol=1e-12)


def test_numbers_in_float_out() -> None:
    for value in (20.0, 20, np.float64(20), np.float32(20), np.array(20.0), np.int64(20)):
        speed = echocal.speed_of_sound(value, 0.5)
        assert type(speed) is float
        assert speed == pytest.approx(343.98689, abs=1e-4)


def test_broadcasts_without_materializing() -> None:
    """A terabyte of input by its shape; only the answer is allocated."""
    time = np.broadcast_to(np.float64(0.01), (1 << 20, 1))
    temperature = np.broadcast_to(np.linspace(0, 40, 3), (1 << 20, 3))
    result = echocal.distance(time, temperature)
    assert result.shape == (1 << 20, 3)
    np.testing.assert_array_equal(result[-1], echocal.distance(0.01, np.linspace(0, 40, 3)))


@given(
    shapes=arrays.mutually_broadcastable_shapes(num_shapes=3, max_dims=3, max_side=5),
    flip=st.tuples(*[st.booleans()] * 3),
    single=st.booleans(),
)
def test_any_shape_and_stride(
    shapes: arrays.BroadcastableShapes, flip: tuple[bool, bool, bool], single: bool
) -> None:
    kind = np.float32 if single else np.float64
    bounds = ((0.001, 0.03), (-20, 60), (0, 1))
    inputs = []
    for (low, high), shape, turned in zip(bounds, shapes.input_shapes, flip, strict=True):
        wide = np.linspace(low, high, 3 * int(np.prod(shape)), dtype=kind)
        values: NDArray[np.floating] = wide[::3].reshape(shape, order="F" if turned else "C")
        inputs.append(values[..., ::-1] if turned and values.ndim else values)
    result = np.asarray(echocal.distance(*inputs))
    assert result.shape == shapes.result_shape
    rows = [column.ravel().tolist() for column in np.broadcast_arrays(*inputs)]
    each = [echocal.distance(*row) for row in zip(*rows, strict=True)]
    tolerance = 4e-6 if single else 0
    np.testing.assert_allclose(result.ravel(), each, rtol=tolerance)


def test_out_in_place_and_overlapping() -> None:
    time = np.linspace(0.001, 0.03, 1000)
    expected = echocal.distance(time, 20.0)
    out = np.empty(1000)
    assert echocal.distance(time, 20.0, out=out) is out
    np.testing.assert_array_equal(out, expected)
    echocal.distance(out := time.copy(), 20.0, out=out)
    np.testing.assert_array_equal(out, expected)
    shifted = np.concatenate([time, [0.0]])
    echocal.distance(shifted[:-1], 20.0, out=shifted[1:])
    np.testing.assert_array_equal(shifted[1:], expected)
    backwards = time.copy()
    echocal.distance(backwards[::-1], 20.0, out=backwards)
    np.testing.assert_array_equal(backwards, expected[::-1])


def test_where() -> None:
    time, some = np.full(7, 0.01), np.arange(7) % 3 == 0
    result = echocal.distance(time, 20.0, where=some)
    np.testing.assert_array_equal(np.isnan(result), ~some)
    np.testing.assert_array_equal(result[some], echocal.distance(0.01, 20.0))
    assert echocal.distance(time.astype(np.float32), 20.0, where=some).dtype == np.float32
    kept = echocal.distance(time, 20.0, where=some, out=np.full(7, -1.0))
    np.testing.assert_array_equal(kept == -1.0, ~some)


@pytest.mark.parametrize("law", LAWS)
def test_float32_stays_and_is_close(law: str) -> None:
    temperature = np.linspace(-20, 50, 5001)
    single = echocal.speed_of_sound(temperature.astype(np.float32), 0.5, law=law)
    assert single.dtype == np.float32
    np.testing.assert_allclose(single, echocal.speed_of_sound(temperature, 0.5, law=law), atol=1e-4)


def test_other_kinds_of_numbers() -> None:
    expected = echocal.speed_of_sound(np.arange(30.0))
    np.testing.assert_array_equal(echocal.speed_of_sound(np.arange(30)), expected)
    np.testing.assert_array_equal(echocal.speed_of_sound(list(range(30))), expected)
    swapped = np.arange(30.0).astype(">f8")
    np.testing.assert_array_equal(echocal.speed_of_sound(swapped), expected)
    misaligned = np.zeros(30, dtype=[("byte", "i1"), ("value", "f8")])
    misaligned["value"] = np.arange(30)
    np.testing.assert_array_equal(echocal.speed_of_sound(misaligned["value"]), expected)
    assert echocal.speed_of_sound(np.empty((0, 3))).shape == (0, 3)


def test_nan_in_nan_out_in_silence() -> None:
    temperature = np.array([20.0, np.nan, np.inf, 20.0] * 100)
    with np.errstate(all="raise"):
        speed = echocal.speed_of_sound(temperature, 0.5)
    np.testing.assert_array_equal(np.isfinite(speed), np.isfinite(temperature))
    assert np.isnan(echocal.distance(np.nan, 20.0))


def test_frequency() -> None:
    at_40_khz = echocal.speed_of_sound(20.0, 0.5, frequency=40e3)
    assert at_40_khz - echocal.speed_of_sound(20.0, 0.5) == pytest.approx(0.087, abs=5e-4)
    both = echocal.speed_of_sound(20.0, 0.5, frequency=np.array([0.0, 40e3]))
    np.testing.assert_array_equal(both, [echocal.speed_of_sound(20.0, 0.5), at_40_khz])


def test_messages() -> None:
    with pytest.raises(echocal.UsageError, match=r"time_of_flight \(3,\), temperature \(2,\)"):
        echocal.distance(np.ones(3), np.ones(2))
    with pytest.raises(echocal.UsageError, match=r"unknown law 'cramr'; use one of .*cramer"):
        echocal.distance(0.01, 20.0, law="cramr")
    with pytest.raises(echocal.UsageError, match="temperature must be real numbers, but has dtype <U2"):
        echocal.distance([0.01, 0.02], ["20", "21"])
    with pytest.raises(echocal.UsageError, match="relative_humidity must be real numbers"):
        echocal.speed_of_sound(20.0, "half")
    for count in (0, -1, 2**70, 1.5):
        with pytest.raises(echocal.UsageError, match=f"n_threads is {count}; give 1 or more"):
            echocal.distance(np.ones(3), 20.0, n_threads=count)  # type: ignore[arg-type]
    with pytest.raises(echocal.UsageError, match=r"temperature has dtype float128.*\.astype\(float\)"):
        echocal.speed_of_sound(np.longdouble([20.0]))
    with pytest.raises(echocal.UsageError, match="Dataset is several variables"):
        echocal.speed_of_sound(xr.Dataset({"inside": ("x", [20.0]), "outside": ("x", [5.0])}))
    with pytest.raises(TypeError, match="temperature"):
        echocal.distance(0.01)  # type: ignore[call-overload]
