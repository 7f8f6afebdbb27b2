"""The footer of a Parquet file: what is where. Source: parquet.thrift of Apache Parquet's format 2.11."""

from dataclasses import dataclass
from typing import Any, BinaryIO

from echocal.correct.parquet import thrift
from echocal.correct.parquet.thrift import BINARY, I32, I64, LIST, STRUCT, Struct
from echocal.errors import DataError

__all__ = ["Field", "Footer", "chunk_range", "fields_of", "read_footer"]

MAGIC = b"PAR1"
_ENCRYPTED = b"PARE"
_END = 8  # bytes: length of the footer, and the magic

# numbers of fields in parquet.thrift
SCHEMA, ROWS, ROW_GROUPS, KEY_VALUES, COLUMN_ORDERS = 2, 3, 4, 5, 7  # FileMetaData
TYPE, NAME, CHILDREN = 1, 4, 5  # SchemaElement
COLUMNS, BYTES, GROUP_ROWS, SORTING, GROUP_OFFSET, COMPRESSED = 1, 2, 3, 4, 5, 6  # RowGroup
FILE_PATH, FILE_OFFSET, META, OFFSET_INDEX, COLUMN_INDEX, CRYPTO = 1, 2, 3, 4, 6, 8  # ColumnChunk
CODEC, VALUES, UNCOMPRESSED, COMPRESSED_SIZE = 4, 5, 6, 7  # ColumnMetaData
DATA_PAGE, INDEX_PAGE, DICTIONARY_PAGE = 9, 10, 11
STATISTICS, ENCODING_STATS, BLOOM, BLOOM_LENGTH = 12, 13, 14, 15


@dataclass(frozen=True)
class Field:
    """A column of the schema, nested or not.

    Attributes
    ----------
    name : str
    elements : list
        Its elements of the schema.
    leaves : range
        Places of its column chunks in a row group.
    """

    name: str
    elements: list[Struct]
    leaves: range


@dataclass(frozen=True)
class Footer:
    """A footer and its size [B]; the data end where it begins."""

    struct: Struct
    begins: int

    @property
    def rows(self) -> int:
        """Number of rows."""
        return int(self.struct[ROWS][1])

    @property
    def row_groups(self) -> list[Struct]:
        """Row groups."""
        return list(self.struct[ROW_GROUPS][1][1]) if ROW_GROUPS in self.struct else []

    @property
    def key_values(self) -> dict[bytes, bytes]:
        """Metadata by key."""
        if KEY_VALUES not in self.struct:
            return {}
        return {pair[1][1]: pair[2][1] if 2 in pair else b"" for pair in self.struct[KEY_VALUES][1][1]}


def read_footer(file: BinaryIO, name: str) -> Footer:
    """Read and check a footer.

    Raises
    ------
    DataError
        If the file is truncated or damaged, or of a kind that cannot be copied; the text says which.
    """
    size = file.seek(0, 2)
    file.seek(max(size - _END, 0))
    end = file.read(_END)
    if end[4:] == _ENCRYPTED:
        message = f"{name} is encrypted Parquet; decrypt it first"
        raise DataError(message)
    length = int.from_bytes(end[:4], "little")
    if end[4:] != MAGIC or length + _END + len(MAGIC) > size:
        message = f"{name} begins like Parquet and has no footer: it is truncated or damaged"
        raise DataError(message)
    begins = size - _END - length
    file.seek(begins)
    try:
        struct, _ = thrift.read(file.read(length))
        footer = Footer(struct, begins)
        _check(footer, name)
    except (KeyError, TypeError, ValueError) as error:
        message = f"{name} begins like Parquet and its footer cannot be read: {error!r:.80}"
        raise DataError(message) from None
    return footer


def _check(footer: Footer, name: str) -> None:
    leaves = sum(len(field.leaves) for field in fields_of(footer))
    rows = 0
    for group in footer.row_groups:
        rows += group[GROUP_ROWS][1]
        chunks = group[COLUMNS][1][1]
        if len(chunks) != leaves:
            message = f"{name} has a row group with {len(chunks)} columns of {leaves}: it is damaged"
            raise DataError(message)
        for chunk in chunks:
            if FILE_PATH in chunk or CRYPTO in chunk or META not in chunk:
                message = f"{name} has columns in another file, or encrypted; write it as one plain file"
                raise DataError(message)
            first, count = chunk_range(chunk)
            if count and not len(MAGIC) <= first <= first + count <= footer.begins:
                message = f"{name} is damaged: a column lies outside of the file"
                raise DataError(message)
    if rows != footer.rows:
        message = f"{name} is damaged: its row groups have {rows} rows of {footer.rows}"
        raise DataError(message)


def fields_of(footer: Footer) -> list[Field]:
    """Columns of the schema, in order."""
    elements: list[Struct] = footer.struct[SCHEMA][1][1]
    count = elements[0][CHILDREN][1] if CHILDREN in elements[0] else 0
    found: list[Field] = []
    at, leaf = 1, 0
    for _ in range(count):
        begin, first, open_ = at, leaf, 1
        while open_:
            element = elements[at]
            children = element[CHILDREN][1] if CHILDREN in element else 0
            leaf += TYPE in element
            open_ += children - 1
            at += 1
        found.append(Field(elements[begin][NAME][1].decode(), elements[begin:at], range(first, leaf)))
    if at != len(elements):
        raise ValueError("a schema with elements left over")
    return found


def chunk_range(chunk: Struct) -> tuple[int, int]:
    """First byte of a column chunk in its file, and the number of its bytes."""
    meta = chunk[META][1]
    first: int = meta[DATA_PAGE][1]
    dictionary = meta[DICTIONARY_PAGE][1] if DICTIONARY_PAGE in meta else 0
    if 0 < dictionary < first or not first:  # without rows there may be a dictionary alone
        first = dictionary
    return first, meta[COMPRESSED_SIZE][1]


def key_value(key: bytes, value: bytes) -> Struct:
    """A pair of the metadata."""
    return {1: (BINARY, key), 2: (BINARY, value)}


def structs(values: list[Struct]) -> tuple[int, Any]:
    """A list of structures as a field."""
    return LIST, (STRUCT, values)


def whole(value: int, kind: int = I64) -> tuple[int, int]:
    """An integer as a field."""
    return (I32 if kind == I32 else I64), value
