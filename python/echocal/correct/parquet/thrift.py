"""Thrift's compact protocol, in which Parquet writes its footers.

Only what a footer needs: structures are read as they are, without a list of their fields, so that a field
that this version does not know is kept. Source: "Thrift Compact protocol encoding", in the specification of
Apache Thrift (doc/specs/thrift-compact-protocol.md).
"""

from typing import Any, TypeAlias

from echocal.keywords import keyword

TRUE, FALSE, BYTE, I16, I32, I64, DOUBLE, BINARY, LIST, SET, MAP, STRUCT = range(1, 13)
INTEGERS = (I16, I32, I64)

_WIDEST = 1000
"""Fields of one structure; Parquet has 17 at most."""

MOST = 1 << 23
"""Fields and elements of a structure and of all that it holds: those of 300,000 column chunks; judgement."""

BYTES = 160
"""Bytes that one of them takes in memory; measured with lists of structures."""

Value: TypeAlias = Any
"""int, bytes, bool, a `Struct`; a list is ``(kind of its elements, [values])``."""
Struct: TypeAlias = dict[int, tuple[int, Value]]
"""Kind and value by the number of the field, in the order of writing."""


def read(data: bytes, most: int = MOST) -> Struct:
    """Read a structure of so many fields and elements at most.

    Raises `ValueError` if the bytes are no such structure.
    """
    try:
        return _Reader(data, most).struct()
    except (IndexError, OverflowError, RecursionError) as error:
        raise ValueError(f"no structure of Thrift: {error}") from None


def write(struct: Struct) -> bytes:
    """Write a structure."""
    out = bytearray()
    _struct(out, struct)
    return bytes(out)


class _Reader:
    def __init__(self, data: bytes, most: int) -> None:
        self.data, self.at = data, 0
        self._most = self._left = most

    def struct(self) -> Struct:
        found: Struct = {}
        field = 0
        while True:
            head = self._byte()
            if head == 0:
                self._count(len(found))
                return found
            kind, delta = head & 0x0F, head >> 4
            field = field + delta if delta else self._zigzag()
            if field in found or len(found) > _WIDEST:
                raise ValueError(f"field {field} twice" if field in found else f"more than {_WIDEST} fields")
            found[field] = (kind, kind == TRUE if kind in (TRUE, FALSE) else self._value(kind))

    def _value(self, kind: int) -> Value:
        if kind in INTEGERS:
            return self._zigzag()
        if kind == BINARY:
            return self._take(self._varint())
        if kind == STRUCT:
            return self.struct()
        if kind in (LIST, SET):
            return self._list()
        if kind in (BYTE, TRUE, FALSE):
            return self._byte()
        if kind == DOUBLE:
            return self._take(8)
        raise ValueError(f"a field of kind {kind}")

    def _list(self) -> tuple[int, list[Value]]:
        head = self._byte()
        kind, count = head & 0x0F, head >> 4
        if count == 15:
            count = self._varint()
        if count > len(self.data) - self.at:
            raise ValueError(f"a list of {count} elements where {len(self.data) - self.at} bytes are left")
        self._count(count)
        return kind, [self._value(kind) for _ in range(count)]

    def _count(self, more: int) -> None:
        self._left -= more
        if self._left < 0:
            raise ValueError(
                f"it has more than {self._most:,} fields and elements: it is damaged, or needs a larger "
                f"{keyword('memory')}, or larger row groups"
            )

    def _byte(self) -> int:
        value = self.data[self.at]
        self.at += 1
        return value

    def _take(self, count: int) -> bytes:
        taken = self.data[self.at : self.at + count]
        if len(taken) < count:
            raise ValueError(f"{count} bytes where {len(taken)} are left")
        self.at += count
        return taken

    def _varint(self) -> int:
        value = self._byte()
        if value < 0x80:  # as most are
            return value
        value, shift = value & 0x7F, 7
        while True:
            byte = self._byte()
            value |= (byte & 0x7F) << shift
            if byte < 0x80 and value < 1 << 64:
                return value
            shift += 7
            if shift > 63:
                raise ValueError("an integer of more than 64 bits")

    def _zigzag(self) -> int:
        value = self._varint()
        return (value >> 1) ^ -(value & 1)


def _struct(out: bytearray, struct: Struct) -> None:
    last = 0
    for field, (kind, value) in sorted(struct.items()):
        written = (TRUE if value else FALSE) if kind in (TRUE, FALSE) else kind
        if 0 < field - last <= 15:
            out.append((field - last) << 4 | written)
        else:
            out.append(written)
            _zigzag(out, field)
        last = field
        if kind not in (TRUE, FALSE):
            _value(out, kind, value)
    out.append(0)


def _value(out: bytearray, kind: int, value: Value) -> None:
    if kind in INTEGERS:
        _zigzag(out, value)
    elif kind == BINARY:
        _varint(out, len(value))
        out += value
    elif kind == STRUCT:
        _struct(out, value)
    elif kind in (LIST, SET):
        element, values = value
        if len(values) < 15:
            out.append(len(values) << 4 | element)
        else:
            out.append(0xF0 | element)
            _varint(out, len(values))
        for one in values:
            _value(out, element, one)
    elif kind == DOUBLE:
        out += value
    else:
        out.append(value)


def _zigzag(out: bytearray, value: int) -> None:
    _varint(out, value << 1 if value >= 0 else (-value << 1) - 1)


def _varint(out: bytearray, value: int) -> None:
    while value >= 0x80:
        out.append(value & 0x7F | 0x80)
        value >>= 7
    out.append(value)
