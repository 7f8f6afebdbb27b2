"""A file with more columns: what was there is copied byte by byte, and the footer says where it is now."""

import base64
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache
from io import BytesIO
from typing import Any, BinaryIO

import numpy as np
from numpy.typing import NDArray

from echocal.correct.columns import labels_as_text
from echocal.correct.parquet import footer as f
from echocal.correct.parquet import thrift
from echocal.correct.parquet.footer import PAGES, check
from echocal.correct.parquet.thrift import STRUCT, Struct
from echocal.correct.results import DISTANCE, LEVEL, RESULTS, STATUS, UNCERTAINTY, UNUSABLE, results
from echocal.correct.rows import Rows, no_distance
from echocal.errors import DataError
from echocal.observations.arrow import arrow

_PART = 1 << 22  # bytes that are copied at a time
_STORED = b"ARROW:schema"
_PANDAS = b"pandas"
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
    footer, _ = _written(columns_of(no_distance(0, first=first)), [0], "NONE", whole=True)
    return list(footer.struct[f.SCHEMA][1][1][1:])


def encode(rows: Rows, sizes: Sequence[int], codec: str, *, whole: bool) -> list[Encoded]:
    """Encode results, for each of so many rows on its own.

    `sizes` are the rows of each row group, and `whole` tells whether these are whole ones. Parts of one have
    no dictionary, so that they can be joined.
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
    columns = {name: own for name, own in columns_of(no_distance(size)).items() if name in names}
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


class Splice:
    """Writes a file with the columns of another one, and results.

    `kept` are the columns of the source to copy, and `first` is the name of the first result.
    """

    def __init__(
        self, source: BinaryIO, footer: f.Footer, out: BinaryIO, kept: Sequence[f.Field], first: str
    ) -> None:
        self._source, self._footer, self._out, self._kept = source, footer, out, kept
        self._first = first
        self._all = len(kept) == len(f.fields_of(footer))
        self._groups: list[Struct] = []
        self._at = out.write(f.MAGIC)

    def add(self, group: Struct, results: Encoded) -> None:
        """Copy a row group, and append its results."""
        begins = self._at
        chunks: list[Struct] = group[f.COLUMNS][1][1]
        copied = [self._copy(chunks[leaf]) for field in self._kept for leaf in field.leaves]
        appended = []
        for chunk, data in results.chunks:
            appended.append(_moved(chunk, self._at - f.chunk_range(chunk)[0]))
            self._at += self._out.write(data)
        columns = [*copied, *appended]
        metas = [chunk[f.META][1] for chunk in columns]
        new = dict(group)
        new[f.COLUMNS] = f.structs(columns)
        new[f.BYTES] = f.whole(sum(meta[f.UNCOMPRESSED][1] for meta in metas))
        new[f.COMPRESSED] = f.whole(sum(meta[f.COMPRESSED_SIZE][1] for meta in metas))
        new[f.GROUP_OFFSET] = f.whole(begins)
        if not self._all:
            new.pop(f.SORTING, None)  # names columns by their places
        self._groups.append(new)

    def finish(self, key_values: Mapping[bytes, bytes]) -> None:
        """Copy the indexes of pages, and write the footer with more metadata."""
        self._copy_indexes()
        struct = dict(self._footer.struct)
        root, *_ = struct[f.SCHEMA][1][1]
        elements = [element for field in self._kept for element in field.elements]
        fields = len(self._kept) + len(RESULTS)
        root = {**root, f.CHILDREN: (thrift.I32, fields)}
        struct[f.SCHEMA] = f.structs([root, *elements, *result_elements(self._first)])
        struct[f.ROW_GROUPS] = f.structs(self._groups)
        pairs = {**self._metadata(key_values), **key_values}
        struct[f.KEY_VALUES] = f.structs([f.key_value(key, value) for key, value in pairs.items()])
        if f.COLUMN_ORDERS in struct:
            orders = struct[f.COLUMN_ORDERS][1][1]
            ours = [orders[leaf] for field in self._kept for leaf in field.leaves]
            by_type: list[Struct] = [{1: (STRUCT, {})} for _ in RESULTS]
            struct[f.COLUMN_ORDERS] = f.structs([*ours, *by_type])
        data = thrift.write(struct)
        self._out.write(data + len(data).to_bytes(4, "little") + f.MAGIC)

    def _copy(self, chunk: Struct) -> Struct:
        first, count = f.chunk_range(chunk)
        moved = _moved(chunk, self._at - first)
        self._bytes(first, count)
        return moved

    def _bytes(self, first: int, count: int) -> None:
        self._source.seek(first)
        while count:
            data = self._source.read(min(count, _PART))
            if not data:
                raise DataError(f"{self._source.name} became shorter while it was read")
            self._at += self._out.write(data)
            count -= len(data)

    def _copy_indexes(self) -> None:
        """Bloom filters and indexes of pages; they stand between the data and the footer."""
        for old, new in zip(self._footer.row_groups, self._groups, strict=True):
            olds = old[f.COLUMNS][1][1]
            leaves = [leaf for field in self._kept for leaf in field.leaves]
            for leaf, chunk in zip(leaves, new[f.COLUMNS][1][1], strict=False):
                shift = f.chunk_range(chunk)[0] - f.chunk_range(olds[leaf])[0]
                self._copy_bloom(olds[leaf], chunk)
                self._copy_index(olds[leaf], chunk, f.COLUMN_INDEX, 0)
                self._copy_index(olds[leaf], chunk, f.OFFSET_INDEX, shift)

    def _copy_bloom(self, old: Struct, chunk: Struct) -> None:
        meta = old[f.META][1]
        if f.BLOOM in meta and f.BLOOM_LENGTH in meta:
            new = chunk[f.META][1]
            new[f.BLOOM] = f.whole(self._at)
            new[f.BLOOM_LENGTH] = meta[f.BLOOM_LENGTH]
            self._bytes(meta[f.BLOOM][1], meta[f.BLOOM_LENGTH][1])

    def _copy_index(self, old: Struct, chunk: Struct, place: int, shift: int) -> None:
        if place not in old or place + 1 not in old:
            return
        self._source.seek(old[place][1])
        data = self._source.read(old[place + 1][1])
        if shift:  # pages are found by their place in the file
            try:
                index = thrift.read(data)
                check(index, PAGES)
            except ValueError as error:
                message = f"{self._source.name} is damaged: an index of pages cannot be read: {error}"
                raise DataError(message) from None
            for page in index[1][1][1]:
                page[1] = (page[1][0], page[1][1] + shift)
            data = thrift.write(index)
        chunk[place], chunk[place + 1] = f.whole(self._at), (thrift.I32, len(data))
        self._at += self._out.write(data)

    def _metadata(self, more: Mapping[bytes, bytes]) -> dict[bytes, bytes]:
        """Metadata of the source that fit the new columns; Arrow keeps a copy of all."""
        own = dict(self._footer.key_values)
        if _STORED in own:
            names = None if self._all else [field.name for field in self._kept]
            own[_STORED] = _with_results(own[_STORED], names, more, self._first)
        if not self._all:
            own.pop(_PANDAS, None)  # names columns that are left out
        return labels_as_text(own) or {}


def _moved(chunk: Struct, shift: int) -> Struct:
    """A column chunk elsewhere in a file; what points outside of it is left out."""
    outside = (f.OFFSET_INDEX, f.OFFSET_INDEX + 1, f.COLUMN_INDEX, f.COLUMN_INDEX + 1)
    meta = {key: own for key, own in chunk[f.META][1].items() if key not in (f.BLOOM, f.BLOOM_LENGTH)}
    for place in (f.DATA_PAGE, f.INDEX_PAGE, f.DICTIONARY_PAGE):
        if place in meta and meta[place][1] > 0:
            meta[place] = (meta[place][0], meta[place][1] + shift)
    kept = {key: own for key, own in chunk.items() if key not in outside}
    return {**kept, f.FILE_OFFSET: f.whole(0), f.META: (chunk[f.META][0], meta)}


def _with_results(
    stored: bytes, names: Sequence[str] | None, more: Mapping[bytes, bytes], first: str
) -> bytes:
    """The schema that Arrow keeps, with the results; of its columns only some, if they are named."""
    pa = arrow()
    try:
        schema: Any = pa.ipc.read_schema(pa.py_buffer(base64.b64decode(stored)))
    except (pa.ArrowException, ValueError, OSError):
        return stored
    fields = list(schema) if names is None else [schema.field(name) for name in names]
    kept = labels_as_text({**(schema.metadata or {}), **more}) or {}
    if names is not None:
        kept.pop(_PANDAS, None)
    new = pa.schema([*fields, *result_fields(first)], metadata=kept)
    return base64.b64encode(new.serialize().to_pybytes())
