"""A file with more columns: what was there is copied byte by byte, and the footer says where it is now."""

import base64
from collections.abc import Mapping, Sequence
from typing import Any, BinaryIO

from echocal.correct.columns import labels_as_text
from echocal.correct.parquet import footer as f
from echocal.correct.parquet import thrift
from echocal.correct.parquet.encode import Encoded, result_elements, result_fields
from echocal.correct.parquet.footer import PAGES, check
from echocal.correct.parquet.thrift import STRUCT, Struct
from echocal.correct.results import RESULTS
from echocal.errors import DataError
from echocal.observations.arrow import arrow

__all__ = ["Splice"]

_PART = 1 << 22  # bytes that are copied at a time
_STORED = b"ARROW:schema"
_PANDAS = b"pandas"


class Splice:
    """Writes a file with the columns of another one, and results.

    Parameters
    ----------
    source : file
        The other file, open for reading.
    footer : Footer
        Its footer.
    out : file
        The new file, open for writing.
    kept : sequence of Field
        Columns of the source to copy.
    first : str
        Name of the first result.
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
                message = f"{self._source.name} became shorter while it was read"
                raise DataError(message)
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
                index, _ = thrift.read(data)
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
