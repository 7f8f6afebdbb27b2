"""Sweeps: a model over a grid of conditions, as a labeled grid with units."""

import json
import warnings
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
import pandas as pd
import xarray as xr
from numpy.typing import NDArray

from echocal._core import __version__
from echocal._verb import callable_as
from echocal.errors import DomainWarning, UsageError, among
from echocal.model import Model
from echocal.outputs import replacing
from echocal.quantities import QUANTITIES
from echocal.quantities.units import in_cf
from echocal.sweep.grid import Range, axis, parse, parse_named

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["Range", "parse", "parse_named", "sweep", "table", "write"]

callable_as(__name__)

_LARGEST = 100_000_000
_RESULTS = {
    "speed_of_sound": ("m s-1", "speed of sound on the path"),
    "time_of_flight": ("s", "recorded echo time, out and back"),
    "indication": ("m", "indication of the device"),
    "error": ("m", "indication minus distance"),
}
_COLUMNS = {name: facts.si_column for name, facts in QUANTITIES.items()} | {
    "distance": "distance_m",
    "speed_of_sound": "speed_of_sound_m_s",
    "time_of_flight": "echo_s",
    "indication": "reading_m",
    "error": "error_m",
}

_ENDINGS = (".csv", ".parquet", ".nc")


def sweep(
    model: Model | str, *, temperature: Range, distance: Range = 2.0, **conditions: Range
) -> "xr.Dataset":
    """Simulate a device over every combination of conditions.

    Parameters
    ----------
    model : Model or str
        The model of air and device; the name or expression of a law is the base simulation.
    temperature : range
        Air temperature [degC]. A range is one value, a tuple (start, stop, step) with the stop
        included, or an array or list of values, shape (n,).
    distance : range
        True distance [m].
    **conditions : range
        Other influence quantities by name [SI], e.g. ``relative_humidity=(0, 1, 0.25)``; what is
        not given takes the model's own value or the default.

    Returns
    -------
    xarray.Dataset
        Variables ``speed_of_sound`` [m/s], ``time_of_flight`` [s], ``indication`` [m] and
        ``error`` [m]; one dimension for every range that is not a single value, in the order
        given; units and long names as attributes after the CF conventions.

    Raises
    ------
    UsageError
        If a quantity is unknown, a range is none, or there are too many combinations.

    Examples
    --------
    >>> import echocal
    >>> device = echocal.Model("linear", {"fixed_speed": {"weight": 1.0, "speed": 343.0}})
    >>> grid = echocal.sweep(device, temperature=(0, 50, 25), distance=[1.0, 2.0])
    >>> dict(grid.sizes), grid.error.attrs["units"]
    ({'temperature': 3, 'distance': 2}, 'm')
    >>> print(grid.indication.sel(distance=2.0).round(3).values)
    [2.07  1.98  1.898]
    """
    import xarray as xr  # takes long to import: only who sweeps waits for it

    model = Model(model) if isinstance(model, str) else model
    unknown = sorted(set(conditions) - set(QUANTITIES))
    if unknown:
        message = f"unknown influence quantity '{unknown[0]}'{among(unknown[0], QUANTITIES, 'known:')}"
        raise UsageError(message)
    given = {"temperature": temperature, "distance": distance, **conditions}
    axes = {name: axis(name, range_) for name, range_ in given.items()}
    dimensions = [name for name, values in axes.items() if values.ndim]
    shape = tuple(len(axes[name]) for name in dimensions)
    if np.prod(shape, dtype=float) > _LARGEST:
        raise UsageError(
            f"{' x '.join(map(str, shape))} combinations are more than {_LARGEST:.0e}; take larger steps"
        )
    placed = {name: _placed(values, name, dimensions) for name, values in axes.items()}
    results = _simulate(model, shape, placed)
    return xr.Dataset(
        {name: (dimensions, values, _result_attributes(name)) for name, values in results.items()},
        {name: (name if values.ndim else (), values, _attributes(name)) for name, values in axes.items()},
        {
            "Conventions": "CF-1.11",
            "title": "Simulated ultrasonic distance measurements",
            "source": f"echocal {__version__}, effects {json.dumps(model.effects)}",
            "model": " + ".join([f"law {model.law}", *model.effects]),
        },
    )


def _simulate(
    model: Model, shape: tuple[int, ...], placed: dict[str, NDArray[np.float64]]
) -> dict[str, NDArray[np.float64]]:
    distance = np.broadcast_to(placed.pop("distance"), shape)
    indication = np.asarray(model.indicate(distance, **placed))
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", DomainWarning)  # it was said once
        return {
            "speed_of_sound": np.asarray(model.speed_of_sound(distance, **placed)),
            "time_of_flight": np.asarray(model.time_of_flight(distance, **placed)),
            "indication": indication,
            "error": indication - distance,
        }


def _placed(values: NDArray[np.float64], name: str, dimensions: list[str]) -> NDArray[np.float64]:
    """Values along their own dimension, ready to broadcast."""
    return (
        values.reshape([-1 if name == dimension else 1 for dimension in dimensions])
        if values.ndim
        else values
    )


def _attributes(name: str) -> dict[str, str]:
    if name == "distance":
        return {"units": "m", "long_name": "true distance"}
    facts = QUANTITIES[name]
    attributes = {"units": in_cf(facts.unit), "long_name": facts.words}
    return attributes | ({"standard_name": facts.standard_name} if facts.standard_name else {})


def _result_attributes(name: str) -> dict[str, str]:
    units, long_name = _RESULTS[name]
    return {"units": units, "long_name": long_name}


def table(grid: xr.Dataset) -> pd.DataFrame:
    """One row per combination; `echocal.read_observations` reads the names back."""
    flat = grid.to_dataframe().reset_index() if grid.sizes else pd.DataFrame([_scalars(grid)])
    first = [str(name) for name in grid.coords]
    return flat[first + [str(name) for name in grid.data_vars]].rename(columns=_COLUMNS)


def refuse_ending(path: Path) -> None:
    """Refuse a file that no sweep can be written as.

    Raises `UsageError` if its ending is none of .csv, .parquet and .nc.
    """
    if path.suffix not in _ENDINGS:
        raise UsageError(f"cannot write '{path.suffix}' ({path}); endings: {', '.join(_ENDINGS)}")


def write(grid: xr.Dataset, path: Path) -> None:
    """Write a sweep as .csv, .parquet or .nc; a file is either complete or not there.

    Raises `UsageError` if the ending is another, Parquet lacks its library, or the file cannot be written.
    """
    refuse_ending(path)
    try:
        with replacing(path) as unfinished:
            match path.suffix:
                case ".csv":
                    table(grid).to_csv(unfinished, index=False)
                case ".parquet":
                    table(grid).to_parquet(unfinished, index=False)
                case _:
                    grid.to_netcdf(unfinished, engine="netcdf4" if find_spec("netCDF4") else "scipy")
    except ImportError:
        raise UsageError("Parquet needs pyarrow: pip install 'echocal[batch]'") from None


def _scalars(grid: xr.Dataset) -> dict[str, float]:
    return {str(name): float(variable) for name, variable in grid.variables.items()}
