import re
from itertools import product
from pathlib import Path
from typing import Any

import matplotlib.pyplot as plt
import numpy as np
import pandas as pd
import pytest
import xarray as xr
from hypothesis import given
from hypothesis import strategies as st

import echocal
from echocal.plots.sweep import plot_sweep, sweep_figure
from echocal.sweep import parse, write
from echocal.sweep.grid import axis

DEVICE = echocal.Model(
    "cramer", {"fixed_speed": {"weight": 1.0, "speed": 343.0}, "fixed_delay": {"delay": 3e-5}}
)


def test_every_cell_is_the_model_at_its_conditions() -> None:
    grid = echocal.sweep(
        DEVICE, temperature=(0, 50, 10), distance=[0.5, 2.0], relative_humidity=(0, 0.4, 0.2)
    )
    assert grid.error.dims == ("temperature", "distance", "relative_humidity")
    for cell in product(*(grid[name].to_numpy().tolist() for name in grid.error.dims)):
        at = dict(zip(grid.error.dims, cell, strict=True))
        conditions = {name: at[name] for name in ("temperature", "relative_humidity")}
        expected = float(DEVICE.indicate(at["distance"], **conditions))
        assert float(grid.indication.sel(at)) == expected
        assert float(grid.error.sel(at)) == expected - at["distance"]
        assert float(grid.time_of_flight.sel(at)) == float(
            DEVICE.time_of_flight(at["distance"], **conditions)
        )


def test_speed_of_sound_is_that_of_the_path() -> None:
    base = echocal.sweep("331.4+0.6*T", temperature=(0, 50, 10))
    np.testing.assert_allclose(base.speed_of_sound, 331.4 + 0.6 * base.temperature, rtol=1e-15)
    np.testing.assert_allclose(base.time_of_flight, 4.0 / base.speed_of_sound, rtol=1e-15)
    delayed = echocal.Model("331.4+0.6*T", {"fixed_delay": {"delay": 1e-4}})
    xr.testing.assert_equal(
        echocal.sweep(delayed, temperature=(0, 50, 10)).speed_of_sound, base.speed_of_sound
    )


def test_every_variable_has_units_and_a_name() -> None:
    grid = echocal.sweep(DEVICE, temperature=[20.0], pressure=9e4, wind_speed=[0.0, 2.0])
    for variable in grid.variables.values():
        assert variable.attrs["units"]
        assert variable.attrs["long_name"]
    assert grid.speed_of_sound.attrs["units"] == "m s-1"
    assert grid.temperature.attrs["standard_name"] == "air_temperature"
    assert grid.attrs["Conventions"].startswith("CF-")


@given(st.floats(-40, 40), st.integers(0, 200), st.sampled_from([0.1, 0.25, 0.5, 2.0, -0.5]))
def test_stop_is_included(start: float, steps: int, step: float) -> None:
    start = round(start, 3)
    values = axis("temperature", (start, start + steps * step, step))
    assert len(values) == steps + 1
    assert values[-1] == pytest.approx(start + steps * step, abs=1e-9)


def test_a_stop_off_the_steps_is_not_passed() -> None:
    assert axis("temperature", (0, 50, 20)).tolist() == [0.0, 20.0, 40.0]
    assert axis("distance", (0.1, 0.3, 0.1)).tolist() == [0.1, 0.2, 0.3]


def test_texts() -> None:
    assert parse("temperature", "0:50:2") == (0.0, 50.0, 2.0)
    assert parse("temperature", "-5") == -5.0
    assert parse("temperature", "1,2.5,9") == [1.0, 2.5, 9.0]


@pytest.mark.parametrize(
    ("ranges", "message"),
    [
        (
            {"temperature": (0, 50)},
            "temperature: a tuple is (start, stop, step), got (0, 50); write values one by one",
        ),
        ({"temperature": (0, 50, 0)}, "temperature: from 0 to 50 in steps of 0 never gets there"),
        ({"temperature": (0, 50, -1)}, "temperature: from 0 to 50 in steps of -1 never gets there"),
        ({"temperature": (0, 50, 1e-9)}, "temperature: from 0 to 50 in steps of 1e-09 has too many values"),
        (
            {"temperature": []},
            "temperature: expected one value, (start, stop, step) or a list, got shape (0,)",
        ),
        ({"temperature": "warm"}, "temperature must be real numbers, but has dtype <U4"),
        ({"temperature": [0.0, np.nan]}, "temperature: expected finite numbers"),
        ({"temperature": [1.0, 1.0]}, "temperature: a value occurs more than once"),
        (
            {"temperature": 20.0, "humidity": 0.5},
            "unknown influence quantity 'humidity'; did you mean 'relative_humidity'? Known: temp",
        ),
        (
            {"temperature": (0, 50, 0.001), "distance": (0, 4, 0.0001)},
            "50001 x 40001 combinations are more than 1e+08; take larger steps",
        ),
    ],
)
def test_bad_ranges(ranges: dict[str, Any], message: str) -> None:
    with pytest.raises(echocal.UsageError, match=re.escape(message)):
        echocal.sweep(DEVICE, **ranges)


@pytest.mark.parametrize("text", ["0:50", "a", "0:50:2:1", "", "1,,2"])
def test_bad_texts(text: str) -> None:
    with pytest.raises(echocal.UsageError, match=r"is no range; write 20, or 0:50:2 \(start:stop:step\)"):
        parse("temperature", text)


@pytest.mark.parametrize("ending", [".csv", ".parquet"])
def test_tables_are_read_back_as_observations(ending: str, tmp_path: Path) -> None:
    grid = echocal.sweep(DEVICE, temperature=(0, 50, 10), distance=[0.5, 2.0], relative_humidity=0.5)
    path = tmp_path / f"sweep{ending}"
    write(grid, path)
    data = echocal.read_observations(path, {"reading_m": "ignore"})
    np.testing.assert_array_equal(data.echo_time, grid.time_of_flight.to_numpy().ravel())
    np.testing.assert_array_equal(data.reference_distance, np.tile([0.5, 2.0], 6))
    np.testing.assert_array_equal(data.conditions["relative_humidity"], 0.5)
    assert list(tmp_path.iterdir()) == [path]


def test_netcdf_keeps_units_and_values(tmp_path: Path) -> None:
    grid = echocal.sweep(DEVICE, temperature=(0, 50, 10), distance=[0.5, 2.0])
    write(grid, tmp_path / "sweep.nc")
    with xr.open_dataset(tmp_path / "sweep.nc") as back:
        xr.testing.assert_identical(back.load(), grid)


def test_one_single_point_is_a_table_of_one_row(tmp_path: Path) -> None:
    write(echocal.sweep(DEVICE, temperature=20.0), tmp_path / "point.csv")
    assert len(pd.read_csv(tmp_path / "point.csv")) == 1


def test_other_endings_are_refused(tmp_path: Path) -> None:
    with pytest.raises(echocal.UsageError, match=r"cannot write '.xlsx' .*; endings: .csv, .parquet, .nc"):
        write(echocal.sweep(DEVICE, temperature=20.0), tmp_path / "sweep.xlsx")


@pytest.mark.parametrize("distance", [2.0, [1.0, 2.0, 3.0], (0.2, 4, 0.2)])
def test_plot_draws_one_line_for_each_of_the_rest(distance: Any) -> None:
    grid = echocal.sweep(DEVICE, temperature=(0, 50, 2), distance=distance)
    figure, ax = plt.subplots()
    plot_sweep(grid, "error", ax)
    lines = [line for line in ax.lines if len(np.asarray(line.get_xdata())) == 26]
    assert len(lines) == grid.sizes.get("distance", 1)
    np.testing.assert_allclose(
        np.asarray(lines[-1].get_ydata()), grid.error.to_numpy().reshape(26, -1)[:, -1] * 1e3
    )
    plt.close(figure)


def test_figures_of_many_sweeps_are_not_kept() -> None:
    before = plt.get_fignums()
    for _ in range(3):
        sweep_figure(echocal.sweep("linear", temperature=(0, 50, 25)))
    assert plt.get_fignums() == before


def test_figure_shows_what_changes() -> None:
    device = sweep_figure(echocal.sweep(DEVICE, temperature=(0, 50, 2)))
    base = sweep_figure(echocal.sweep("linear", temperature=(0, 50, 2)))
    assert [ax.get_ylabel() for ax in device.axes] == ["speed of sound [m/s]", "echo time [ms]", "error [mm]"]
    assert [ax.get_ylabel() for ax in base.axes] == ["speed of sound [m/s]", "echo time [ms]"]
    plt.close("all")


def test_colors_and_dashes_are_explained_and_only_what_matters_is_drawn() -> None:
    grid = echocal.sweep(
        "cramer", temperature=(0, 40, 5), distance=[0.5, 1, 2, 4], relative_humidity=[0.0, 0.3, 0.6]
    )
    speed, time = sweep_figure(grid).axes
    texts = [[text.get_text() for text in ax.get_legend().get_texts()] for ax in (speed, time)]
    humidity = [f"relative humidity {value:g}" for value in (0, 0.3, 0.6)]
    assert texts == [humidity, [f"true distance {value:g} m" for value in (0.5, 1, 2, 4)] + humidity]
    assert (len(speed.lines), len(time.lines)) == (3, 12)
    assert len({(str(line.get_color()), line.get_linestyle()) for line in time.lines}) == 12
    plt.close("all")


def test_leaving_the_domain_is_said_once() -> None:
    with pytest.warns(echocal.DomainWarning, match="water_vapor_mole_fraction") as caught:
        echocal.sweep("cramer", temperature=(0, 50, 10), relative_humidity=1.0)
    assert len(caught) == 1
