"""What a footer must hold before anything relies on it: kinds of its fields, and ranges of its numbers.

Only what this package uses is looked at; all other fields are kept as they are. Source: parquet.thrift of
Apache Parquet's format 2.11.
"""

from dataclasses import dataclass
from typing import Any, TypeAlias

from echocal.correct.parquet.thrift import BINARY, INTEGERS, LIST, STRUCT, Struct

__all__ = ["FILE", "PAGES", "check"]

_ANY = range(-(2**63), 2**63)
_SIZE = range(2**63)
_SHORT = range(2**31)
_ROWS = range(2**31)
"""Rows of a row group: more are possible in a few bytes, and no writer makes them."""


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

    Raises
    ------
    ValueError
        If a field is absent, of another kind, or out of its range; the text names it.
    """
    _check(STRUCT, struct, wanted, "it")


def _check(kind: int, value: Any, wanted: _Kind, name: str) -> None:
    if isinstance(wanted, range):
        if kind not in INTEGERS or value not in wanted:
            message = f"its {name} is {value if kind in INTEGERS else 'no integer'}"
            raise ValueError(message)
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
                message = f"it lacks a {field.name}"
                raise ValueError(message)
    else:
        _expect(kind == BINARY, name, "text")
        if wanted is str:
            value.decode()


def _expect(holds: bool, name: str, kind: str) -> None:
    if not holds:
        message = f"its {name} is no {kind}"
        raise ValueError(message)
