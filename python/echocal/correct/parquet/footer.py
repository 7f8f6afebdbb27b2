"""The footer of a Parquet file: what is where, and what it must hold before anything relies on it.

Only what this package uses is looked at; all other fields are kept as they are. Source: parquet.thrift of
Apache Parquet's format 2.11.
"""

from dataclasses import dataclass
from itertools import pairwise
from typing import Any, BinaryIO, TypeAlias

from echocal.correct.parquet import thrift
from echocal.correct.parquet.thrift import BINARY, I32, I64, INTEGERS, LIST, STRUCT, Struct
from echocal.errors import DataError
from echocal.keywords import keyword

MAGIC = b"PAR1"
_ENCRYPTED = b"PARE"
_END = 8  # bytes: length of the footer, and the magic
_LEAST = 1 << 19  # fields and elements that are read in any memory: those of 17,000 column chunks
_COPIES = (
    8  # of the bytes of a footer, here and in Arrow: about 5 for one of 100 MB, measured; the rest is reserve
)
_LONGEST = 1 << 27
"""Bytes of a footer at most: that of a million column chunks; judgement."""

# numbers of fields in parquet.thrift
SCHEMA, ROWS, ROW_GROUPS, KEY_VALUES, COLUMN_ORDERS = 2, 3, 4, 5, 7  # FileMetaData
TYPE, REPETITION, NAME, CHILDREN = 1, 3, 4, 5  # SchemaElement
_REPEATED = 2  # of REPETITION
COLUMNS, BYTES, GROUP_ROWS, SORTING, GROUP_OFFSET, COMPRESSED = 1, 2, 3, 4, 5, 6  # RowGroup
FILE_PATH, FILE_OFFSET, META, OFFSET_INDEX, COLUMN_INDEX, CRYPTO = 1, 2, 3, 4, 6, 8  # ColumnChunk
KIND, PATH, CODEC, VALUES, UNCOMPRESSED, COMPRESSED_SIZE = 1, 3, 4, 5, 6, 7  # ColumnMetaData
DATA_PAGE, INDEX_PAGE, DICTIONARY_PAGE = 9, 10, 11
STATISTICS, ENCODING_STATS, BLOOM, BLOOM_LENGTH = 12, 13, 14, 15
_ANY = range(-(2**63), 2**63)
_SIZE = range(2**63)
_SHORT = range(2**31)
_ROWS = range(2**31)
"""Rows of a row group: more are possible in a few bytes, and no writer makes them."""


@dataclass(frozen=True)
class Field:
    """A column of the schema, nested or not."""

    name: str
    elements: list[Struct]  # its elements of the schema
    leaves: range  # places of its column chunks in a row group

    @property
    def flat(self) -> bool:
        """Whether each row has one value of it, or a null."""
        first = self.elements[0]
        repeated = REPETITION in first and first[REPETITION][1] == _REPEATED
        return len(self.elements) == 1 and not repeated

    def with_chunks(self) -> list[Struct]:
        """Its elements that have column chunks."""
        return [element for element in self.elements if TYPE in element]


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


def read_footer(file: BinaryIO, name: str, memory: int | None = None) -> Footer:
    """Read and check a footer, which may take so much memory [B].

    Raises `DataError` if the file is truncated or damaged, or of a kind that cannot be copied; the text says
    which.
    """
    size = file.seek(0, 2)
    file.seek(max(size - _END, 0))
    end = file.read(_END)
    if end[4:] == _ENCRYPTED:
        raise DataError(f"{name} is encrypted Parquet; decrypt it first")
    length = int.from_bytes(end[:4], "little")
    if end[4:] != MAGIC or length + _END + len(MAGIC) > size:
        raise DataError(f"{name} begins like Parquet and has no footer: it is truncated or damaged")
    longest, most = _LONGEST, thrift.MOST
    if memory is not None:
        longest = min(max(memory // _COPIES, _LEAST << 5), _LONGEST)
        most = min(max(memory // thrift.BYTES, _LEAST), thrift.MOST)
    if length > longest:
        raise DataError(
            f"{name} has a footer of {length:,} bytes, and {longest:,} are the most: it is damaged, or needs "
            f"a larger {keyword('memory')}, or larger row groups"
        )
    begins = size - _END - length
    file.seek(begins)
    try:
        struct = thrift.read(file.read(length), most)
        check(struct, FILE)
        footer = Footer(struct, begins)
        fields = fields_of(footer)
    except (IndexError, ValueError) as error:
        raise DataError(f"{name} begins like Parquet and its footer cannot be read: {error}") from None
    damage = _damage(footer, fields)
    if damage:
        raise DataError(f"{name} is damaged: {damage}")
    _refuse_elsewhere(footer, name)
    return footer


def _refuse_elsewhere(footer: Footer, name: str) -> None:
    for group in footer.row_groups:
        for chunk in group[COLUMNS][1][1]:
            if FILE_PATH in chunk or CRYPTO in chunk or META not in chunk:
                message = f"{name} has columns in another file, or encrypted; write it as one plain file"
                raise DataError(message)


def _damage(footer: Footer, fields: list[Field]) -> str:
    """What of a footer contradicts the rest of it, or the file; empty if nothing does."""
    leaves = [(field.flat, element) for field in fields for element in field.with_chunks()]
    orders = footer.struct[COLUMN_ORDERS][1][1] if COLUMN_ORDERS in footer.struct else leaves
    if len(orders) != len(leaves):
        return f"it has orders of {len(orders)} columns of {len(leaves)}"
    rows = 0
    places: list[tuple[int, int]] = []
    for group in footer.row_groups:
        own = group[GROUP_ROWS][1]
        rows += own
        chunks = group[COLUMNS][1][1]
        if len(chunks) != len(leaves):
            return f"a row group has {len(chunks)} columns of {len(leaves)}"
        for chunk, leaf in zip(chunks, leaves, strict=True):
            if META in chunk:
                if damage := _damage_of_chunk(chunk, own, *leaf):
                    return damage
                places += _parts(chunk)
    if rows != footer.rows:
        return f"its row groups have {rows} rows of {footer.rows}"
    places.sort()
    if places and not len(MAGIC) <= places[0][0] <= sum(places[-1]) <= footer.begins:
        return "a column lies outside of the file"
    if any(first + count > then for (first, count), (then, _) in pairwise(places)):
        return "two columns lie in the same place"
    return ""


def _damage_of_chunk(chunk: Struct, rows: int, flat: bool, element: Struct) -> str:
    """The same of one column chunk."""
    meta, name = chunk[META][1], element[NAME][1]
    if flat and meta[VALUES][1] != rows:
        return f"a column has {meta[VALUES][1]} values in {rows} rows"
    if meta[KIND][1] != element[TYPE][1] or meta[PATH][1][1][-1:] != [name]:
        return f"column '{name.decode()}' has another name or type in a row group"
    return ""


def _parts(chunk: Struct) -> list[tuple[int, int]]:
    """First byte and number of bytes of all that a column has in the file."""
    meta = chunk[META][1]
    parts = [chunk_range(chunk)]
    for held, place, size in (
        (meta, BLOOM, BLOOM_LENGTH),
        (chunk, OFFSET_INDEX, OFFSET_INDEX + 1),
        (chunk, COLUMN_INDEX, COLUMN_INDEX + 1),
    ):
        if place in held and size in held:
            parts.append((held[place][1], held[size][1]))
    return [(first, count) for first, count in parts if count]


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


@dataclass(frozen=True)
class _Field:
    name: str
    of: "_Kind"
    needed: bool = False


_Kind: TypeAlias = "range | type[bytes | str] | list[_Kind] | dict[int, _Field]"
"""An integer in a range, bytes, a text in UTF-8, a list, a structure with these fields and any others."""

_ELEMENT: _Kind = {
    1: _Field("type", range(8)),
    3: _Field("repetition", range(3)),
    4: _Field("name", str, needed=True),
    5: _Field("number of children", _SHORT),
}
_META: _Kind = {
    1: _Field("type", range(8), needed=True),
    3: _Field("path of a column", [bytes], needed=True),
    4: _Field("codec", range(8), needed=True),
    5: _Field("number of values", _SIZE, needed=True),
    6: _Field("uncompressed size", _SIZE, needed=True),
    7: _Field("compressed size", _SIZE, needed=True),
    9: _Field("place of the data", _SIZE, needed=True),
    10: _Field("place of an index", _ANY),
    11: _Field("place of the dictionary", _ANY),
    14: _Field("place of the Bloom filter", _ANY),
    15: _Field("size of the Bloom filter", _SHORT),
}
_CHUNK: _Kind = {
    3: _Field("metadata", _META),
    4: _Field("place of the offsets", _ANY),
    5: _Field("size of the offsets", _SHORT),
    6: _Field("place of the index", _ANY),
    7: _Field("size of the index", _SHORT),
}
_GROUP: _Kind = {
    1: _Field("columns", [_CHUNK], needed=True),
    3: _Field("number of rows", _ROWS, needed=True),
}
_PAIR: _Kind = {1: _Field("key", bytes, needed=True), 2: _Field("value", bytes)}
FILE: _Kind = {
    2: _Field("schema", [_ELEMENT], needed=True),
    3: _Field("number of rows", _SIZE, needed=True),
    4: _Field("row groups", [_GROUP]),
    5: _Field("metadata", [_PAIR]),
    7: _Field("orders of columns", [{}]),
}
"""A footer."""

PAGES: _Kind = {1: _Field("pages", [{1: _Field("place of a page", _ANY, needed=True)}], needed=True)}
"""An index of the places of pages."""


def check(struct: Struct, wanted: _Kind) -> None:
    """Look at a structure.

    Raises `ValueError` if a field is absent, of another kind, or out of its range; the text names it.
    """
    _check(STRUCT, struct, wanted, "it")


def _check(kind: int, value: Any, wanted: _Kind, name: str) -> None:
    if isinstance(wanted, range):
        if kind not in INTEGERS or value not in wanted:
            raise ValueError(f"its {name} is {value if kind in INTEGERS else 'no integer'}")
    elif isinstance(wanted, list):
        _expect(kind == LIST, name, "list")
        element, values = value
        for one in values:
            _check(element, one, wanted[0], name)
    elif isinstance(wanted, dict):
        _expect(kind == STRUCT, name, "structure")
        for number, field in wanted.items():
            if number in value:
                own, held = value[number]
                _check(own, held, field.of, field.name)
            elif field.needed:
                raise ValueError(f"it lacks a {field.name}")
    else:
        _expect(kind == BINARY, name, "text")
        if wanted is str:
            value.decode()


def _expect(holds: bool, name: str, kind: str) -> None:
    if not holds:
        raise ValueError(f"its {name} is no {kind}")
