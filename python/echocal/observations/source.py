"""From a file or a table of any library to a pandas table, nothing interpreted yet."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import pandas as pd

from echocal.conditions import unmasked
from echocal.errors import DataError, UsageError
from echocal.observations import text

__all__ = ["load"]

_PARQUET, _ZIP = b"PAR1", b"PK\x03\x04"


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
    if table.empty:
        message = f"{where} has a header ({', '.join(table.columns)}) and no rows"
        raise DataError(message)
    return table


def _file(path: Path, layout: text.Layout, verbatim: bool) -> pd.DataFrame:
    head = _head(path)
    if head.startswith(_PARQUET):
        return _parquet(path)
    if head.startswith(_ZIP):
        message = f"{path} is a zip archive or a spreadsheet; save the table as CSV"
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
        return pd.read_parquet(path)
    except ImportError:
        message = "Parquet needs pyarrow: pip install 'echocal[batch]'"
        raise UsageError(message) from None
    except (OSError, ValueError) as error:  # pyarrow's own errors are ValueErrors
        message = f"{path} begins like Parquet and cannot be read: {str(error).splitlines()[0]}"
        raise DataError(message) from None


def _object(source: Any) -> pd.DataFrame:
    if isinstance(source, pd.DataFrame):
        return source.copy(deep=False)
    if isinstance(source, Mapping):
        return _mapping(source)
    for method in ("collect", "to_pandas", "to_dataframe"):  # polars lazy; polars, arrow; xarray
        if callable(getattr(source, method, None)):
            source = getattr(source, method)()
            if isinstance(source, pd.DataFrame):
                return source if method == "to_pandas" else source.reset_index()
    if hasattr(source, "__dataframe__"):
        return pd.api.interchange.from_dataframe(source)
    message = f"expected a path, a table or a mapping of columns, got {type(source).__name__}"
    raise UsageError(message)


def _mapping(source: Mapping[Any, Any]) -> pd.DataFrame:
    columns = {name: unmasked(values) for name, values in source.items()}
    shapes = {values.shape for values in columns.values()}
    if len(shapes) > 1 or any(len(shape) != 1 for shape in shapes):
        found = ", ".join(f"{name} {values.shape}" for name, values in columns.items())
        message = f"columns must be one-dimensional and of equal length; got {found}"
        raise DataError(message)
    return pd.DataFrame(columns)
