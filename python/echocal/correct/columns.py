"""Columns of a table in Arrow, so that a correction changes none of them."""

import json
from typing import Any

import numpy as np
import pandas as pd

from echocal.errors import DataError
from echocal.observations.arrow import Table, arrow
from echocal.observations.fields import row

_INDEX = "__index_level_0__"


def as_text(table: Table) -> tuple[pd.DataFrame, list[str]]:
    """Fields of an Arrow table for a text file, and what a person should know of them.

    Integers, decimals, dates and times are written in all their digits, lists and other nested values
    as JSON, bytes as hexadecimal digits.
    """
    pa = arrow()
    columns, notes = {}, []
    for place, (field, column) in enumerate(zip(table.schema, table.columns, strict=True)):
        try:
            columns[place] = _fields(column, field.name, pa)
        except (pa.ArrowException, ArithmeticError) as error:
            message = f"column '{field.name}' ({field.type}) cannot be text: {error}; write Parquet"
            raise DataError(message) from None
        if pa.types.is_nested(field.type):
            notes.append(f"column '{field.name}' ({field.type}) is written as JSON")
        elif _is_binary(field.type, pa):
            notes.append(f"column '{field.name}' ({field.type}) is written as hexadecimal digits")
    names = with_time(list(table.column_names), table.schema)
    return pd.DataFrame(columns).set_axis(names, axis="columns"), notes


def labels_as_text(notes: dict[bytes, bytes] | None) -> dict[bytes, bytes] | None:
    """Notes on a schema that pandas can follow: it would turn every name into a number or a date again."""
    try:
        own = json.loads((notes or {})[b"pandas"])
        kinds = [index["pandas_type"] for index in own["column_indexes"]]
    except (KeyError, TypeError, ValueError):
        return notes
    if notes is None or not kinds or kinds in (["unicode"], ["string"], ["empty"]):
        return notes
    text = {"name": None, "pandas_type": "unicode", "numpy_type": "object", "metadata": None}
    return {**notes, b"pandas": json.dumps({**own, "column_indexes": [text]}).encode()}


def _fields(column: Any, name: str, pa: Any) -> Any:
    kind = column.type
    if isinstance(kind, pa.BaseExtensionType):
        stored = [part.storage for part in column.chunks]
        return _fields(pa.chunked_array(stored, kind.storage_type), name, pa)
    if pa.types.is_dictionary(kind):
        return _fields(column.cast(kind.value_type), name, pa)
    if pa.types.is_nested(kind) or _is_binary(kind, pa):
        return [None if value is None else _plain(value) for value in column.to_pylist()]
    if any(holds(kind) for holds in (pa.types.is_floating, pa.types.is_boolean, pa.types.is_duration)):
        return column.to_pandas()
    if pa.types.is_timestamp(kind):
        try:
            return column.to_pandas()
        except pa.ArrowException:  # an unknown time zone
            column = column.cast(pa.timestamp(kind.unit, "UTC" if kind.tz else None))
    texts = column.cast(pa.string()).to_pandas().astype(object)
    far = np.flatnonzero(texts.astype(str).str.startswith("<value out of range"))
    if pa.types.is_temporal(kind) and len(far):
        raise DataError(f"column '{name}' has a date at {row(far[0])} that no text can hold; write Parquet")
    return texts


def _plain(value: Any) -> str:
    """JSON of a nested value, hexadecimal digits of bytes."""
    if isinstance(value, bytes):
        return value.hex()
    return json.dumps(value, ensure_ascii=False, default=_inner)


def _inner(value: Any) -> str:
    return value.hex() if isinstance(value, bytes) else str(value)


def _is_binary(kind: Any, pa: Any) -> bool:
    types = pa.types
    tests = (types.is_binary, types.is_large_binary, types.is_fixed_size_binary, types.is_binary_view)
    return any(holds(kind) for holds in tests)


def with_time(names: list[str], schema: Any) -> list[str]:
    """Names of columns; pandas has an index of times without a name under one of its own."""
    unnamed = _INDEX in names and "time" not in names
    if unnamed and arrow().types.is_timestamp(schema.field(names.index(_INDEX)).type):
        names[names.index(_INDEX)] = "time"
    return names
