"""Tables and labelled arrays come back as their own type, lazily where they are lazy."""

import pickle

import dask.array as da
import numpy as np
import pandas as pd
import polars as pl
import pytest
import xarray as xr

import echocal
from echocal.model import Shape

TIME = np.array([0.004, 0.01, 0.02])
TEMPERATURE = np.array([-5.0, 20.0, 35.0])
EXPECTED = echocal.distance(TIME, TEMPERATURE, 0.4)


def test_pandas() -> None:
    frame = pd.DataFrame({"time": TIME, "temperature": TEMPERATURE}, index=["a", "b", "c"])
    result = echocal.distance(frame["time"], frame["temperature"], 0.4)
    assert isinstance(result, pd.Series)
    assert result.name == "distance"
    assert list(result.index) == ["a", "b", "c"]
    np.testing.assert_array_equal(result, EXPECTED)
    mixed = echocal.distance(frame["time"], TEMPERATURE, 0.4)
    assert isinstance(mixed, pd.Series)
    turned = echocal.distance(frame["time"], frame["temperature"][::-1], 0.4)
    np.testing.assert_array_equal(turned[["a", "b", "c"]], EXPECTED)


def test_xarray_keeps_coordinates_not_units() -> None:
    time = xr.DataArray(TIME, dims="row", coords={"row": [1, 2, 3]}, attrs={"units": "s"}, name="time")
    temperature = xr.DataArray([0.0, 20.0], dims="day", attrs={"units": "degC"})
    result = echocal.distance(time, temperature, 0.4)
    assert result.dims == ("row", "day")
    assert result.attrs == {"units": "m", "long_name": "distance"}
    assert result.name == "distance"
    assert time.attrs == {"units": "s"}
    np.testing.assert_array_equal(result[1], echocal.distance(TIME[1], np.array([0.0, 20.0]), 0.4))


@pytest.mark.parametrize("scheduler", ["synchronous", "threads", "processes"])
def test_dask_is_lazy(scheduler: str) -> None:
    time, temperature = da.from_array(TIME, chunks=2), da.from_array(TEMPERATURE, chunks=2)
    result = echocal.distance(time, temperature, 0.4, law="331.3+0.606*T")
    assert isinstance(result, da.Array)
    assert result.dtype == np.float64
    expected = echocal.distance(TIME, TEMPERATURE, 0.4, law="331.3+0.606*T")
    np.testing.assert_array_equal(result.compute(scheduler=scheduler), expected)


def test_xarray_over_dask_is_lazy() -> None:
    time = xr.DataArray(TIME, dims="row").chunk({"row": 2})
    result = echocal.distance(time, xr.DataArray(TEMPERATURE, dims="row"), 0.4)
    assert isinstance(result.data, da.Array)
    np.testing.assert_array_equal(result, EXPECTED)


def test_polars_series() -> None:
    time, temperature = pl.Series("time", TIME), pl.Series("temperature", TEMPERATURE)
    result = echocal.distance(time, temperature, 0.4)
    assert isinstance(result, pl.Series)
    assert result.name == "distance"
    np.testing.assert_array_equal(result, EXPECTED)
    single = echocal.distance(time.cast(pl.Float32), 20.0)
    assert single.dtype == pl.Float32
    missing = echocal.distance(pl.Series([0.01, None, 0.02]), 20.0)
    assert missing.is_null().to_list() == [False, True, False]


def test_polars_expressions_are_lazy() -> None:
    frame = pl.LazyFrame({"time": TIME, "temperature": TEMPERATURE})
    expression = echocal.distance(pl.col("time"), pl.col("temperature"), 0.4)
    assert isinstance(expression, pl.Expr)
    for engine in ("in-memory", "streaming"):
        table = frame.with_columns(expression).collect(engine=engine)
        assert table.columns == ["time", "temperature", "distance"]
        np.testing.assert_array_equal(table["distance"], EXPECTED)


MODELS = {
    "effects": echocal.Model("cramer", {"fixed_delay": {"delay": 3e-5}}, air={"relative_humidity": 0.4}),
    "shape": echocal.Model("linear", shape=Shape("temperature", (0.0, 20.0), (0.0, 2e-3), (1e-4, 1e-4))),
}


@pytest.mark.parametrize("engine", ["in-memory", "streaming"])
@pytest.mark.parametrize("model", MODELS.values(), ids=MODELS.keys())
def test_models_take_polars_expressions(model: echocal.Model, engine: str) -> None:
    frame = pl.LazyFrame({"reading": [1.0, 1.5, None, 2.0], "air": [10.0, None, 20.0, 30.0]})
    expression = model.correct(pl.col("reading"), temperature=pl.col("air"))
    assert isinstance(expression, pl.Expr)
    table = frame.with_columns(expression).collect(engine=engine)
    assert table["distance"].is_null().to_list() == [False, True, True, False]
    expected = model.correct(np.array([1.0, 2.0]), temperature=np.array([10.0, 30.0]))
    np.testing.assert_array_equal(table["distance"].drop_nulls(), expected)
    fixed = frame.select(model.indicate(2.0, temperature=pl.col("air"))).collect()["indication"]
    np.testing.assert_array_equal(fixed[0], model.indicate(2.0, temperature=10.0))


def test_polars_decides_on_threads() -> None:
    with pytest.raises(echocal.UsageError, match="n_threads cannot be given for polars expressions"):
        MODELS["effects"].distance(pl.col("time"), temperature=20.0, n_threads=2)


def test_an_array_interface_is_enough() -> None:
    class Wrapped:
        def __array__(self, dtype: object = None, copy: bool | None = None) -> np.ndarray:
            return TIME

    np.testing.assert_array_equal(echocal.distance(Wrapped(), TEMPERATURE, 0.4), EXPECTED)


def test_pickled_by_name() -> None:
    lazy = echocal.speed_of_sound(da.from_array(TEMPERATURE), frequency=40e3, law="virial")
    again = pickle.loads(pickle.dumps(lazy))
    np.testing.assert_array_equal(again, echocal.speed_of_sound(TEMPERATURE, frequency=40e3, law="virial"))
