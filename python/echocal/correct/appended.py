"""The table of the user with the results beside it, of the kind that it is."""

from collections.abc import Mapping
from typing import Any

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from echocal.correct.results import DISTANCE, LEVEL, UNCERTAINTY
from echocal.observations.arrow import arrow

__all__ = ["appended"]

_ATTRS = {
    DISTANCE: {"units": "m", "long_name": "corrected distance"},
    LEVEL: {"units": "m", "long_name": "corrected level"},
    UNCERTAINTY: {"units": "m", "long_name": "standard uncertainty of the corrected distance"},
}
"""Attributes of the variables of xarray, as the CF conventions have them."""


def appended(table: Any, whole: pd.DataFrame, results: Mapping[str, NDArray[Any]]) -> Any:
    """A table with columns more; nothing that it holds is changed.

    Parameters
    ----------
    table : DataFrame of any library, or what was loaded
    whole : pandas.DataFrame
        What was loaded of it: the result where its kind holds no columns, or is not known.
    results : mapping of str to ndarray, shape (n,)
        New columns by name.
    """
    library = type(table).__module__.partition(".")[0]
    if isinstance(table, pd.DataFrame):
        return table.assign(**results)
    if library == "polars":
        import polars as pl  # the user has it

        columns = {name: v if v.dtype.kind == "f" else v.tolist() for name, v in results.items()}
        return table.with_columns([pl.Series(name, values) for name, values in columns.items()])
    if library == "pyarrow":
        for name, values in results.items():
            table = table.append_column(name, arrow().array(values))
        return table
    if library == "xarray":
        return _xarray(table, results)
    return whole.assign(**results)


def _xarray(table: Any, results: Mapping[str, NDArray[Any]]) -> Any:
    """A dataset; an array becomes one that holds it. The rows are its points, the last dimension first."""
    dims = {dim: table.sizes[dim] for dim in (table.dims if hasattr(table, "dtype") else table.sizes)}
    held = table.to_dataset() if hasattr(table, "dtype") else table
    shape = tuple(dims.values())
    return held.assign(
        {
            name: (tuple(dims), np.reshape(values, shape), _ATTRS.get(name, {}))
            for name, values in results.items()
        }
    )
