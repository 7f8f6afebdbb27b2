"""The results of some rows as column chunks of Parquet."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache
from io import BytesIO
from typing import Any

import numpy as np
from numpy.typing import NDArray

from echocal.correct.parquet import footer as f
from echocal.correct.parquet.thrift import Struct
from echocal.correct.results import DISTANCE, LEVEL, RESULTS, STATUS, UNCERTAINTY, UNUSABLE, results
from echocal.correct.rows import Rows
from echocal.observations.arrow import arrow

__all__ = ["Encoded", "columns_of", "encode", "result_elements", "result_fields"]

_SPLIT = "BYTE_STREAM_SPLIT"


@dataclass(frozen=True)
class Encoded:
    """Column chunks of the results of a row group, or of a part of it: description and bytes of each."""

    rows: int
    chunks: list[tuple[Struct, bytes]]

    def __add__(self, other: "Encoded") -> "Encoded":
        """The chunks of two parts: pages without a dictionary follow each other."""
        pairs = zip(self.chunks, other.chunks, strict=True)
        return Encoded(self.rows + other.rows, [_joined(one, two) for one, two in pairs])


def result_fields(first: str) -> list[Any]:
    """Fields of the results in Arrow."""
    pa = arrow()
    text = pa.dictionary(pa.int16(), pa.string())
    kinds = {first: pa.float64(), UNCERTAINTY: pa.float32(), STATUS: text, UNUSABLE: text}
    return [pa.field(name, kinds[name]) for name in results(first)]


def result_elements(first: str) -> list[Struct]:
    """Elements of the results in the schema of a file."""
    nothing = Rows(np.zeros(0), np.zeros(0, np.float32), np.zeros(0, np.int16), ("",), (False,), (), first)
    footer, _ = _written(columns_of(nothing), [0], "NONE", whole=True)
    return list(footer.struct[f.SCHEMA][1][1][1:])


def encode(rows: Rows, sizes: Sequence[int], codec: str, *, whole: bool) -> list[Encoded]:
    """Encode results, for each of so many rows on its own.

    Parameters
    ----------
    sizes : sequence of int
        Rows of each row group.
    codec : str
        Compression, as pyarrow names it.
    whole : bool
        Whether these are whole row groups. Parts of one have no dictionary, so that they can be joined.
    """
    constant = _constants(rows)
    columns = {name: own for name, own in columns_of(rows).items() if name not in constant}
    found = _encoded(columns, sizes, codec, whole=whole)
    repeated = [_of_constant(constant, size, codec, whole) for size in sizes]
    each = zip(sizes, found, repeated, strict=True)
    return [
        Encoded(size, [{**own, **same}[name] for name in results(rows.first)]) for size, own, same in each
    ]


def _constants(rows: Rows) -> tuple[str, ...]:
    """Columns that are empty in every row. Most row groups have such; they are encoded once."""
    nothing, usable = bool(np.isnan(rows.uncertainty).all()), not rows.codes.any()
    empty = {UNCERTAINTY: nothing, STATUS: usable, UNUSABLE: usable}
    return tuple(name for name in RESULTS if empty.get(name))


@lru_cache(maxsize=64)
def _of_constant(
    names: tuple[str, ...], size: int, codec: str, whole: bool
) -> dict[str, tuple[Struct, bytes]]:
    if not names:
        return {}
    nothing = Rows(
        np.zeros(size), np.full(size, np.nan, np.float32), np.zeros(size, np.int16), ("",), (False,), ()
    )
    columns = {name: own for name, own in columns_of(nothing).items() if name in names}
    return _encoded(columns, [size], codec, whole=whole)[0]


def _encoded(
    columns: Mapping[str, Any], sizes: Sequence[int], codec: str, *, whole: bool
) -> list[dict[str, tuple[Struct, bytes]]]:
    """Chunks of some columns by name, for each row group."""
    footer, data = _written(columns, sizes, codec, whole=whole)
    found = []
    for group in footer.row_groups:
        chunks: dict[str, tuple[Struct, bytes]] = {}
        for name, chunk in zip(columns, group[f.COLUMNS][1][1], strict=True):
            first, count = f.chunk_range(chunk)
            chunks[name] = chunk, data[first : first + count]
        found.append(chunks)
    return found


def _written(
    columns: Mapping[str, Any], sizes: Sequence[int], codec: str, *, whole: bool
) -> tuple[f.Footer, bytes]:
    pa = arrow()
    first = LEVEL if LEVEL in columns else DISTANCE
    fields = [field for field in result_fields(first) if field.name in columns]
    table = pa.table(dict(columns), schema=pa.schema(fields))
    sink = pa.BufferOutputStream()
    options = {
        "compression": codec,
        "use_dictionary": [name for name in (STATUS, UNUSABLE) if name in columns] if whole else False,
        "column_encoding": {name: _SPLIT for name in (first, UNCERTAINTY) if name in columns},
        "write_statistics": whole,
        "store_schema": False,
    }
    with pa.parquet.ParquetWriter(sink, table.schema, **options) as writer:
        at = 0
        for size in sizes:
            writer.write_table(table.slice(at, size), row_group_size=max(size, 1))
            at += size
    data = sink.getvalue().to_pybytes()
    return f.read_footer(BytesIO(data), "the results"), data


def columns_of(rows: Rows) -> dict[str, Any]:
    """Results in Arrow, by name."""
    pa = arrow()
    status = pa.DictionaryArray.from_arrays(pa.array(rows.codes, pa.int16()), pa.array(rows.reasons))
    return {
        rows.first: _numbers(rows.distance),
        UNCERTAINTY: _numbers(rows.uncertainty),
        STATUS: status,
        UNUSABLE: status,
    }


def _numbers(values: NDArray[Any]) -> Any:
    """Null where there is no number."""
    absent = np.isnan(values)
    return arrow().array(values, mask=absent if absent.any() else None)


def _joined(one: tuple[Struct, bytes], two: tuple[Struct, bytes]) -> tuple[Struct, bytes]:
    meta, more = one[0][f.META][1], two[0][f.META][1]
    kept = {
        key: own
        for key, own in meta.items()
        if key not in (f.STATISTICS, f.ENCODING_STATS, f.DICTIONARY_PAGE)
    }
    for key in (f.VALUES, f.UNCOMPRESSED, f.COMPRESSED_SIZE):
        kept[key] = (meta[key][0], meta[key][1] + more[key][1])
    return {**one[0], f.META: (one[0][f.META][0], kept)}, one[1] + two[1]
