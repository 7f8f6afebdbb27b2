"""From a file or a table of any library to a pandas table, nothing interpreted yet."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import pandas as pd
from numpy.typing import NDArray

from echocal.conditions import unmasked
from echocal.errors import DataError, UsageError
from echocal.observations import text

__all__ = ["load"]

_PARQUET = b"PAR1"
_NO_TEXT = {
    b"PK\x03\x04": "a zip archive or a spreadsheet; save the table as CSV",
    b"ARRO": "an Arrow (Feather) file; save it as Parquet, or read it with pyarrow and pass the table",
    b"\x89HDF": "an HDF5 or NetCDF file; read it with xarray or pandas and pass the table",
    b"CDF": "a NetCDF file; read it with xarray and pass the dataset",
    b"SQLi": "an SQLite database; save the table as CSV",
    b"{": "JSON; save the table as CSV or Parquet, or read it with pandas and pass the table",
    b"[{": "JSON; save the table as CSV or Parquet, or read it with pandas and pass the table",
}
"""What files begin with that are no table of text."""


def load(source: Any, layout: text.Layout | None = None, *, verbatim: bool = False) -> pd.DataFrame:
    """Load a table, every row and every column of it.

    Parameters
    ----------
    source : path, DataFrame of any library, or mapping of str to array_like
        See `echocal.read_observations`.
    layout : Layout, optional
        How a text file is written.
    verbatim : bool
        Keep every field of a text file as the text it is, for writing it again unchanged.

    Raises
    ------
    DataError
        If the source cannot be read as a table.
    UsageError
        If the source is no table.
    """
    if isinstance(source, str | Path):
        table = _file(Path(source), layout or text.Layout(), verbatim)
        where = f"{source}"
    else:
        table, where = _object(source), "the table"
    table.columns = pd.Index([str(name).strip() for name in table.columns])
    repeated = table.columns[table.columns.duplicated()]
    if len(repeated):
        message = f"{where} has more than one column '{repeated[0]}'; rename all but one"
        raise DataError(message)
    if not len(table.columns):
        message = f"{where} has no columns"
        raise DataError(message)
    if table.empty:
        message = f"{where} has a header ({', '.join(table.columns)}) and no rows"
        raise DataError(message)
    return table


def _file(path: Path, layout: text.Layout, verbatim: bool) -> pd.DataFrame:
    head = _head(path)
    if head.startswith(_PARQUET):
        return _parquet(path)
    for start, told in _NO_TEXT.items():
        if head.startswith(start):
            message = f"{path} is {told}"
            raise DataError(message)
    return text.read(path, layout, verbatim)


def _head(path: Path) -> bytes:
    if path.is_dir():
        message = f"{path} is a folder; name one file of it"
        raise DataError(message)
    try:
        with path.open("rb") as file:
            head = file.read(4)
    except FileNotFoundError:
        message = f"no file {path}"
        raise DataError(message) from None
    except OSError as error:
        message = f"{path} cannot be read: {error.strerror}"
        raise DataError(message) from None
    if not head:
        message = f"{path} is empty"
        raise DataError(message)
    return head


def _parquet(path: Path) -> pd.DataFrame:
    try:
        return _index_as_columns(pd.read_parquet(path))
    except ImportError:
        message = "Parquet needs pyarrow: pip install 'echocal[batch]'"
        raise UsageError(message) from None
    except (OSError, ValueError) as error:  # pyarrow's own errors are ValueErrors
        message = f"{path} begins like Parquet and cannot be read: {str(error).splitlines()[0]}"
        raise DataError(message) from None


def _object(source: Any) -> pd.DataFrame:
    if isinstance(source, pd.DataFrame):
        return _index_as_columns(source)
    if callable(getattr(source, "to_dataframe", None)):  # xarray, whose datasets are mappings, too
        return _xarray(source)
    if isinstance(source, Mapping):
        return _mapping(source)
    for method in ("collect", "to_pandas"):  # polars lazy; polars, arrow
        if callable(getattr(source, method, None)):
            source = getattr(source, method)()
            if isinstance(source, pd.DataFrame):
                return _index_as_columns(source)
    if hasattr(source, "__dataframe__"):
        return pd.api.interchange.from_dataframe(source)
    message = (
        f"expected a path, a table or a mapping of columns, got {type(source).__name__}; "
        "pandas.DataFrame(...) makes a table of most things"
    )
    raise UsageError(message)


def _index_as_columns(table: pd.DataFrame) -> pd.DataFrame:
    """A table whose index holds nothing: levels with a name, and times without one, become columns."""
    if isinstance(table.index, pd.DatetimeIndex) and table.index.name is None:
        table = table.rename_axis("time")
    held = [str(name).strip() for name in table.columns]
    # pandas names the index of a table after what it was; a column of that name says the same
    kept = [n for n, name in enumerate(table.index.names) if name is not None and str(name) not in held]
    columns = {str(table.index.names[n]): table.index.get_level_values(n) for n in kept}
    bare = table.reset_index(drop=True)
    for place, (name, values) in enumerate(columns.items()):
        bare.insert(place, name, values)
    return bare


def _xarray(source: Any) -> pd.DataFrame:
    """One row for each point; dimensions without coordinates only count."""
    try:
        table: pd.DataFrame = source.to_dataframe()
    except ValueError as error:  # no name
        message = f"{type(source).__name__} is no table: {error}"
        raise UsageError(message) from None
    table.index.names = [name if name in source.coords else None for name in table.index.names]
    return _index_as_columns(table)


def _mapping(source: Mapping[Any, Any]) -> pd.DataFrame:
    columns = {name: _column(name, values) for name, values in source.items()}
    shapes = {values.shape for values in columns.values()}
    if len(shapes) > 1 or any(len(shape) != 1 for shape in shapes):
        found = ", ".join(f"{name} {values.shape}" for name, values in columns.items())
        message = f"columns must be one-dimensional and of equal length; got {found}"
        raise DataError(message)
    return pd.DataFrame(columns, copy=False)  # every column is copied when it is read


def _column(name: Any, values: Any) -> NDArray[Any]:
    try:
        return unmasked(values)
    except ValueError:
        message = f"column '{name}' holds lists of different lengths; give one value for each row"
        raise DataError(message) from None
