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
from echocal.observations.file import TextFile
from echocal.observations.layout import Layout
from echocal.observations.limits import refuse_names


def load(source: Any, layout: Layout | None = None, *, sheet: str | None = None) -> pd.DataFrame:
    """Load a table, every row and every column of it.

    Raises `DataError` if the source cannot be read as a table, and `UsageError` if the source is no table.

    Parameters
    ----------
    source : path, TextFile, DataFrame of any library, or mapping of str to array_like
        See `echocal.read_observations`.
    layout : Layout, optional
        How a text file is written.
    sheet : str, optional
        Sheet of a spreadsheet.
    """
    if isinstance(source, str | Path):
        source = TextFile(Path(source), layout or Layout())
    if isinstance(source, TextFile):
        table, where = _file(source, sheet), f"{source.path}"
    else:
        table, where = readers.with_dates(_object(source)), "the table"
    refuse_names(table.columns, where)
    table.columns = pd.Index([str(name).strip() for name in table.columns], dtype=object)
    repeated = table.columns[table.columns.duplicated()]
    if len(repeated):
        raise DataError(f"{where} has more than one column '{repeated[0]}'; rename all but one")
    if not len(table.columns):
        raise DataError(f"{where} has no columns")
    if table.empty:
        raise DataError(f"{where} has a header ({', '.join(table.columns)}) and no rows")
    return table


def is_folder(path: Path) -> bool:
    """Whether a path is a folder; what cannot be a name is none."""
    try:
        return path.is_dir()
    except (OSError, ValueError):
        return False


def refuse_unstreamed(file: TextFile) -> None:
    """Refuse a log that cannot be written again line by line.

    Raises `DataError` with the command that makes a table of it.
    """
    kind = readers.format_of(file)
    if not kind and file.head.nameless:
        kind = "text without a header"
    if kind:
        raise DataError(
            f"{file.path} is {kind}, which cannot be kept line by line; make a table of it first: "
            + command_line("inspect", file.path, write="table.csv")
        )


def _file(file: TextFile, sheet: str | None) -> pd.DataFrame:
    if file.is_parquet:
        return readers.with_dates(_index_as_columns(to_pandas(read_parquet(file.path)[0])))
    table = readers.read(file, sheet)
    return readers.tidy(text.read(file) if table is None else table)


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
    raise UsageError(
        f"expected a path, a table or a mapping of columns, got {type(source).__name__}; "
        "pandas.DataFrame(...) makes a table of most things"
    )


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
        raise UsageError(f"{type(source).__name__} is no table: {error}") from None
    table.index.names = [name if name in source.coords else None for name in table.index.names]
    return _index_as_columns(table)


def _mapping(source: Mapping[Any, Any]) -> pd.DataFrame:
    columns = {name: _column(name, values) for name, values in source.items()}
    shapes = {values.shape for values in columns.values()}
    if len(shapes) > 1 or any(len(shape) != 1 for shape in shapes):
        found = ", ".join(f"{name} {values.shape}" for name, values in columns.items())
        raise DataError(f"columns must be one-dimensional and of equal length; got {found}")
    texts = "OU"  # pandas keeps no half characters as text
    held = (pd.Series(v, dtype=object) if v.dtype.kind in texts else v for v in columns.values())
    table = pd.DataFrame(dict(enumerate(held)), copy=False)  # every column is copied when it is read
    return table.set_axis(pd.Index(list(columns), dtype=object, tupleize_cols=False), axis="columns")


def _column(name: Any, values: Any) -> NDArray[Any]:
    try:
        column = unmasked(values)
    except ValueError:
        raise DataError(
            f"column '{name}' holds lists of different lengths; give one value for each row"
        ) from None
    except (RuntimeError, TypeError) as error:  # what says that it is an array, and is none
        raise DataError(
            f"column '{name}' is a {type(values).__name__} that makes no array: {error}"
        ) from None
    # NumPy makes a type without a unit of nothing but NaT
    bare = column.dtype.kind in "mM" and np.datetime_data(column.dtype)[0] == "generic"
    return column.astype(f"{column.dtype.kind}8[ns]") if bare else column
