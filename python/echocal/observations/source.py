"""From a file or a table of any library to a pandas table, nothing interpreted yet."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from echocal.conditions import unmasked
from echocal.errors import DataError, UsageError
from echocal.keywords import command_line
from echocal.observations import readers, text
from echocal.observations.arrow import arrow, read_parquet, to_pandas
from echocal.observations.limits import refuse_names

__all__ = ["is_folder", "is_parquet", "load", "refuse_other_kinds", "refuse_unstreamed"]

_PARQUET = b"PAR1"
_NO_TEXT = {
    b"ARRO": "an Arrow (Feather) file; save it as Parquet, or read it with pyarrow and pass the table",
    b"\x89HDF": "an HDF5 or NetCDF file; read it with xarray or pandas and pass the table",
    b"CDF": "a NetCDF file; read it with xarray and pass the dataset",
    b'"TOB': "binary data of a Campbell logger; convert it to TOA5 with CardConvert (LoggerNet, PC400)",
    b"SQLi": "an SQLite database; save the table as CSV",
}
"""What files begin with that are no table of text."""


def load(
    source: Any, layout: text.Layout | None = None, *, verbatim: bool = False, sheet: str | None = None
) -> pd.DataFrame:
    """Load a table, every row and every column of it.

    Parameters
    ----------
    source : path, DataFrame of any library, or mapping of str to array_like
        See `echocal.read_observations`.
    layout : Layout, optional
        How a text file is written.
    verbatim : bool
        Keep every field of a text file as the text it is, for writing it again unchanged.
    sheet : str, optional
        Sheet of a spreadsheet.

    Raises
    ------
    DataError
        If the source cannot be read as a table.
    UsageError
        If the source is no table.
    """
    if isinstance(source, str | Path):
        table = _file(Path(source), layout or text.Layout(), verbatim, sheet)
        where = f"{source}"
    else:
        table, where = _object(source), "the table"
    refuse_names(table.columns, where)
    table.columns = pd.Index([str(name).strip() for name in table.columns], dtype=object)
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


def is_folder(path: Path) -> bool:
    """Whether a path is a folder; what cannot be a name is none."""
    try:
        return path.is_dir()
    except (OSError, ValueError):
        return False


def is_parquet(path: Path) -> bool:
    """Whether a file begins as Parquet does.

    Raises
    ------
    DataError
        If it cannot be read.
    """
    return _head(path).startswith(_PARQUET)


def refuse_other_kinds(path: Path) -> None:
    """Raise `DataError` for a file that is neither Parquet nor text."""
    head = _head(path)
    for start, told in _NO_TEXT.items():
        if head.startswith(start):
            message = f"{path} is {told}"
            raise DataError(message)


def refuse_unstreamed(path: Path, layout: text.Layout) -> None:
    """Refuse a log that cannot be written again line by line.

    Raises
    ------
    DataError
        With the command that makes a table of it.
    """
    kind = readers.format_of(path, layout)
    if not kind and text.resolved(path, layout)[0].nameless:
        kind = "text without a header"
    if kind:
        message = (
            f"{path} is {kind}, which cannot be kept line by line; make a table of it first: "
            + command_line("inspect", path, write="table.csv")
        )
        raise DataError(message)


def _file(path: Path, layout: text.Layout, verbatim: bool, sheet: str | None) -> pd.DataFrame:
    if is_parquet(path):
        return _index_as_columns(to_pandas(read_parquet(path)[0]))
    refuse_other_kinds(path)
    table = readers.read(path, layout, sheet)
    if table is None:
        table = text.read(path, layout, verbatim)
    return table if verbatim else readers.tidy(table)


def _head(path: Path) -> bytes:
    try:
        with path.open("rb") as file:
            head = file.read(4)
    except IsADirectoryError:
        message = f"{path} is a folder; name one file of it"
        raise DataError(message) from None
    except FileNotFoundError:
        message = f"no file {path}"
        raise DataError(message) from None
    except OSError as error:
        message = f"{path} cannot be read: {error.strerror}"
        raise DataError(message) from None
    except ValueError as error:  # a NUL byte, a lone surrogate
        message = f"{str(path)!r} cannot be the name of a file: {error}"
        raise DataError(message) from None
    if not head:
        message = f"{path} is empty"
        raise DataError(message)
    return head


def _object(source: Any) -> pd.DataFrame:
    if isinstance(source, pd.DataFrame):
        return _index_as_columns(source)
    if callable(getattr(source, "to_dataframe", None)):  # xarray, whose datasets are mappings, too
        return _xarray(source)
    if isinstance(source, Mapping):
        return _mapping(source)
    if callable(getattr(source, "collect", None)):  # polars lazy
        source = source.collect()
    if callable(getattr(source, "to_arrow", None)):  # polars
        arrow(f"a table of {type(source).__module__.partition('.')[0]}")
        source = source.to_arrow()
    if type(source).__module__.startswith("pyarrow.") and hasattr(source, "schema"):
        return _index_as_columns(to_pandas(source))
    if callable(getattr(source, "to_pandas", None)):
        source = source.to_pandas()
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
    bare = table.reset_index(drop=True)
    for place, level in enumerate(kept):
        name = str(table.index.names[level])
        bare.insert(place, name, table.index.get_level_values(level), allow_duplicates=True)
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
    texts = "OU"  # pandas keeps no half characters as text
    held = (pd.Series(v, dtype=object) if v.dtype.kind in texts else v for v in columns.values())
    table = pd.DataFrame(dict(enumerate(held)), copy=False)  # every column is copied when it is read
    return table.set_axis(pd.Index(list(columns), dtype=object, tupleize_cols=False), axis="columns")


def _column(name: Any, values: Any) -> NDArray[Any]:
    try:
        column = unmasked(values)
    except ValueError:
        message = f"column '{name}' holds lists of different lengths; give one value for each row"
        raise DataError(message) from None
    except (RuntimeError, TypeError) as error:  # what says that it is an array, and is none
        message = f"column '{name}' is a {type(values).__name__} that makes no array: {error}"
        raise DataError(message) from None
    # NumPy makes a type without a unit of nothing but NaT
    bare = column.dtype.kind in "mM" and np.datetime_data(column.dtype)[0] == "generic"
    return column.astype(f"{column.dtype.kind}8[ns]") if bare else column
