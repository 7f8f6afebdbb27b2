"""Sweeps as files: CSV and Parquet with units in the names, NetCDF with units as attributes."""

from importlib.util import find_spec
from pathlib import Path

import pandas as pd
import xarray as xr

from echocal.errors import UsageError
from echocal.outputs import replacing
from echocal.quantities import QUANTITIES

__all__ = ["table", "write"]

_COLUMNS = {name: facts.si_column for name, facts in QUANTITIES.items()} | {
    "distance": "distance_m",
    "speed_of_sound": "speed_of_sound_m_s",
    "time_of_flight": "echo_s",
    "indication": "reading_m",
    "error": "error_m",
}

_ENDINGS = (".csv", ".parquet", ".nc")


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
        message = f"cannot write '{path.suffix}' ({path}); endings: {', '.join(_ENDINGS)}"
        raise UsageError(message)


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
        message = "Parquet needs pyarrow: pip install 'echocal[batch]'"
        raise UsageError(message) from None


def _scalars(grid: xr.Dataset) -> dict[str, float]:
    return {str(name): float(variable) for name, variable in grid.variables.items()}
