"""Models over arrays: the same bits row by row, any type in and out, threads, memory."""

import warnings

import dask.array as da
import numpy as np
import pandas as pd
import pytest
import xarray as xr

import echocal

EFFECTS = {
    "fixed_delay": {"delay": 31e-6},
    "clock_error": {"frequency_error": 2e-3},
    "zero_error": {"offset": -4e-3},
}
MODEL = echocal.Model("virial", EFFECTS)
METHODS = ("indicate", "speed_of_sound", "time_of_flight", "correct")
ROWS = 100_003


def columns(rows: int) -> tuple[np.ndarray, np.ndarray]:
    random = np.random.default_rng(3)
    return random.uniform(0.1, 4.0, rows), random.uniform(-10.0, 40.0, rows)


@pytest.mark.parametrize("name", METHODS)
def test_a_batch_is_the_scalar_loop(name: str) -> None:
    first, temperature = columns(50)
    method = getattr(MODEL, name)
    batch = method(first, temperature=temperature, relative_humidity=0.4)
    rows = zip(first.tolist(), temperature.tolist(), strict=True)
    np.testing.assert_array_equal(batch, [method(x, temperature=t, relative_humidity=0.4) for x, t in rows])


@pytest.mark.parametrize("name", METHODS)
def test_threads_and_out(name: str) -> None:
    first, temperature = columns(ROWS)
    method = getattr(MODEL, name)
    alone = method(first, temperature=temperature, n_threads=1)
    out = np.empty(ROWS)
    assert method(first, temperature=temperature, n_threads=3, out=out) is out
    np.testing.assert_array_equal(out, alone)


def test_round_trip_through_times() -> None:
    first, temperature = columns(1000)
    time = MODEL.time_of_flight(first, temperature=temperature)
    np.testing.assert_allclose(MODEL.distance(time, temperature=temperature), first, rtol=0, atol=1e-12)


def test_types_come_back() -> None:
    first, temperature = columns(6)
    expected = MODEL.correct(first, temperature=temperature)
    series = MODEL.correct(pd.Series(first), temperature=pd.Series(temperature))
    assert isinstance(series, pd.Series)
    np.testing.assert_array_equal(series, expected)
    labelled = MODEL.correct(xr.DataArray(first, dims="row", attrs={"units": "m"}), temperature=temperature)
    assert isinstance(labelled, xr.DataArray)
    assert labelled.name == "distance"
    lazy = MODEL.correct(da.from_array(first, chunks=4), temperature=temperature)
    assert isinstance(lazy, da.Array)
    np.testing.assert_array_equal(lazy.compute(), expected)


def test_single_precision_is_rounded_double() -> None:
    first, temperature = (column.astype(np.float32) for column in columns(700))
    single = MODEL.correct(first, temperature=temperature)
    assert single.dtype == np.float32
    wide = MODEL.correct(first.astype(np.float64), temperature=temperature.astype(np.float64))
    np.testing.assert_array_equal(single, wide.astype(np.float32))


@pytest.mark.parametrize("effect", ["none", "zero_error", "fixed_delay", "temperature_offset"])
@pytest.mark.parametrize("law", ["linear", "ideal_gas", "cramer", "virial"])
def test_a_batch_is_the_scalar_loop_at_absolute_zero_and_in_a_vacuum(law: str, effect: str) -> None:
    """The formulas go on there; a single call had no distance, and a batch had one."""
    effects = {
        "none": {},
        "zero_error": {"zero_error": {"offset": 2e-3}},
        "fixed_delay": {"fixed_delay": {"delay": 3e-5}},
        "temperature_offset": {"temperature_offset": {"offset": 1.0}},
    }[effect]
    model = echocal.Model(law, effects)
    grid = np.meshgrid([-300.0, -273.15, -273.1499, 0.0], [-1.0, 0.0, 1e-300, 101_325.0], [0.0, 0.5, 1.0])
    temperature, pressure, humidity = (values.ravel() for values in grid)
    with warnings.catch_warnings(action="ignore"):
        for method, value in (("distance", 0.01), ("correct", 1.5), ("time_of_flight", 1.5)):
            call = getattr(model, method)
            batch = call(
                np.full(temperature.shape, value),
                temperature=temperature,
                relative_humidity=humidity,
                pressure=pressure,
            )
            single = [
                call(value, temperature=t, relative_humidity=h, pressure=p)
                for t, h, p in zip(temperature, humidity, pressure, strict=True)
            ]
            np.testing.assert_array_equal(batch, single, err_msg=method)
            at_zero = (temperature == -273.15) & (pressure == 101_325.0)
            if law in ("linear", "cramer") and effect != "temperature_offset":
                assert np.isfinite(batch[at_zero]).all()
