"""Arrow tables: Parquet as it was written, and pandas tables whose integers stay integers."""

import base64
from importlib import import_module
from pathlib import Path
from typing import Any, TypeAlias

import pandas as pd

from echocal.errors import DataError, UsageError

Table: TypeAlias = Any
"""A ``pyarrow.Table``; the library has no types, and may be absent."""

_STORED = b"ARROW:schema"  # where Arrow keeps the types that Parquet has not
_NULLABLE = {f"{sign}int{bits}": f"{sign.upper()}Int{bits}" for sign in ("", "u") for bits in (8, 16, 32, 64)}


def arrow(what: str = "Parquet") -> Any:
    """The Arrow library, which `what` needs. Raises `UsageError` if it is not installed."""
    try:
        for part in ("compute", "parquet"):
            import_module(f"pyarrow.{part}")
        return import_module("pyarrow")
    except ImportError:
        raise UsageError(f"{what} needs pyarrow: pip install 'echocal[batch]'") from None


def has_arrow() -> bool:
    """Whether the Arrow library is installed."""
    try:
        arrow()
    except UsageError:
        return False
    return True


def read_parquet(path: Path) -> tuple[Table, str]:
    """Read a Parquet file, every type as it was stored, and the compression of its columns.

    Raises `UsageError` if pyarrow is not installed, and `DataError` if the file cannot be read.
    """
    pa = arrow()
    try:
        # a file, not its name: Arrow takes "station=7" in a name for a column, and only UTF-8 for a name
        with path.open("rb") as raw, pa.parquet.ParquetFile(raw, page_checksum_verification=True) as file:
            facts = file.metadata
            table = as_stored(file.read(), (facts.metadata or {}).get(_STORED))
            filled = facts.num_row_groups and facts.num_columns
            return table, facts.row_group(0).column(0).compression if filled else "SNAPPY"
    except (OSError, pa.ArrowException) as error:
        reason = next(iter(str(error).splitlines()), type(error).__name__)
        raise DataError(f"{path} begins like Parquet and cannot be read: {reason}") from None


def to_pandas(table: Table) -> pd.DataFrame:
    """The same table in pandas; integers with nulls stay integers, which a float would round."""
    pa = arrow()
    holed = {
        column.type for column in table.columns if column.null_count and pa.types.is_integer(column.type)
    }
    kept = {kind: pd.api.types.pandas_dtype(_NULLABLE[str(kind)]) for kind in holed}
    try:
        frame: pd.DataFrame = table.to_pandas(types_mapper=kept.get)
    except (pa.ArrowException, ArithmeticError, LookupError, TypeError, ValueError):
        # what pandas has no type for, or notes of pandas that do not fit the table
        columns = {place: _objects(column, pa) for place, column in enumerate(table.columns)}
        frame = pd.DataFrame(columns).set_axis(table.column_names, axis="columns")
    return frame


def _objects(column: Any, pa: Any) -> Any:
    try:
        return column.to_pandas()
    except (pa.ArrowException, ArithmeticError, LookupError, TypeError, ValueError):
        return pd.Series(list(column), dtype=object)  # refused where they are to be numbers


def as_stored(table: Table, schema: bytes | None) -> Table:
    """Give columns the types that they were stored as, which Parquet alone does not know."""
    pa = arrow()
    if schema is None:
        return table
    stored = pa.ipc.read_schema(pa.py_buffer(base64.b64decode(schema)))
    for place, field in enumerate(stored if len(stored) == table.num_columns else ()):
        column = table.column(place)
        if field.type == column.type or field.name != table.field(place).name:
            continue
        try:
            if pa.types.is_dictionary(field.type) and not pa.types.is_dictionary(column.type):
                column = column.dictionary_encode()
            column = column.cast(field.type)
        except pa.ArrowException:
            continue  # as Parquet has it
        table = table.set_column(place, table.field(place).with_type(field.type), column)
    return table
