"""Columns of a table in Arrow, so that a correction changes none of them."""

import json
from typing import Any

import numpy as np
import pandas as pd

from echocal.correct.results import DISTANCE, RESULTS, UNCERTAINTY
from echocal.errors import DataError
from echocal.observations.arrow import Table, arrow
from echocal.observations.fields import row
from echocal.observations.numbers import EMPTY, EXACT

__all__ = ["as_text", "from_text", "labels_as_text", "with_results"]

_WHOLE = r"^(0|-?[1-9][0-9]*)$"  # "007" is a name, and stays one
_INTEGER = r"^[-+]?[0-9]+$"
_PADDED = r"^[-+]?0[0-9]+$"
_NUMBER = r"^[-+]?([0-9]+\.?[0-9]*|\.[0-9]+)([eE][-+]?[0-9]+)?$"
_TRUTHS = ("True", "False", "TRUE", "FALSE", "true", "false")
_INDEX = "__index_level_0__"


def with_results(table: Table, results: pd.DataFrame) -> Table:
    """Append the two columns of a correction; all others stay unchanged."""
    pa = arrow()
    for name in RESULTS:
        values = results[name] if name in (DISTANCE, UNCERTAINTY) else results[name].astype("category")
        table = table.append_column(name, pa.Array.from_pandas(values))
    return table.replace_schema_metadata(labels_as_text(table.schema.metadata))


def from_text(table: pd.DataFrame, decimal: str) -> Table:
    """Arrow table from fields of text: numbers if that loses no digit, else text; null if empty."""
    pa = arrow()
    columns = {name: _of_text(pa.array(table[name], pa.large_string()), decimal) for name in table.columns}
    return pa.table(columns)


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
    return pd.DataFrame(columns).set_axis(_names(table), axis="columns"), notes


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


def _of_text(column: Any, decimal: str) -> Any:
    """Truth values, integers or floats where all fields are such, else text."""
    pa = arrow()
    pc = pa.compute
    absent = pc.is_in(column, pa.array(sorted(EMPTY), column.type))
    texts = pc.if_else(absent, pa.scalar(None, column.type), column)
    if texts.null_count == len(texts):
        return _or_null(column)
    if pc.all(pc.is_in(texts.drop_null(), pa.array(_TRUTHS, column.type))).as_py():
        return pc.equal(pc.utf8_lower(texts), "true")
    if pc.all(pc.match_substring_regex(texts, _WHOLE)).as_py():
        for kind in (pa.int64(), pa.uint64()):
            try:
                return texts.cast(kind)
            except pa.ArrowInvalid:  # wider than that
                continue
    numbers = _floats(texts, decimal)
    return _or_null(column) if numbers is None else numbers


def _floats(texts: Any, decimal: str) -> Any | None:
    """Floats of texts that are all numbers of a float's range, and whose integers lose no digit."""
    pa = arrow()
    pc = pa.compute
    filled = texts.drop_null()
    if decimal != "." and pc.any(pc.match_substring(filled, ".")).as_py():
        return None  # a separator of thousands, a date
    plain = pc.replace_substring(texts, decimal, ".")
    if not pc.all(pc.match_substring_regex(plain, _NUMBER)).as_py():
        return None
    if pc.any(pc.match_substring_regex(filled, _PADDED)).as_py():
        return None
    numbers = plain.cast(pa.float64())
    long = pc.and_(pc.match_substring_regex(texts, _INTEGER), pc.greater_equal(pc.abs(numbers), EXACT))
    integers = pc.filter(texts, long, null_selection_behavior="drop").to_pylist()
    exact = pc.all(pc.is_finite(numbers)).as_py() and all(int(text) == float(text) for text in integers)
    return numbers if exact else None


def _or_null(column: Any) -> Any:
    pa = arrow()
    return pa.compute.if_else(pa.compute.equal(column, ""), pa.scalar(None, column.type), column)


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
        message = f"column '{name}' has a date at {row(far[0])} that no text can hold; write Parquet"
        raise DataError(message)
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


def _names(table: Table) -> list[str]:
    """Names of the columns; pandas has an index of times without a name under one of its own."""
    pa = arrow()
    names = list(table.column_names)
    if _INDEX in names and "time" not in names and pa.types.is_timestamp(table.schema.field(_INDEX).type):
        names[names.index(_INDEX)] = "time"
    return names
