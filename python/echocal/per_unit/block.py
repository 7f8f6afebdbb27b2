"""The block of a unit: its parameters with a version and a checksum, as the firmware loads it."""

import binascii
import struct
from dataclasses import dataclass

from echocal.errors import DataError

VERSION = 1
"""Version of the layout."""

_FIELDS = struct.Struct("<BBIhh")  # version, 0, number of the unit, delay, rate
_CHECK = struct.Struct("<H")
BYTES = _FIELDS.size + _CHECK.size
"""Size of a block [byte]."""


def crc16(data: bytes) -> int:
    """Return the CRC-16/CCITT-FALSE: polynomial 0x1021, first value 0xFFFF, not reflected.

    Source: catalogue of parametrised CRC algorithms (G. Cook), CRC-16/IBM-3740, where it has this alias.

    Examples
    --------
    >>> hex(crc16(b"123456789"))
    '0x29b1'
    """
    return binascii.crc_hqx(data, 0xFFFF)


@dataclass(frozen=True)
class Block:
    """The parameters of one unit."""

    number: int  # of the unit, 0 to 4,294,967,295
    delay: int  # [2^-5 us]
    rate: int  # ``f / (1 + f)`` of a frequency error ``f`` [2^-19]

    def to_bytes(self) -> bytes:
        """Return the block.

        Examples
        --------
        >>> Block(7, 992, -105).to_bytes().hex(" ")
        '01 00 07 00 00 00 e0 03 97 ff 52 0b'
        """
        fields = _FIELDS.pack(VERSION, 0, self.number, self.delay, self.rate)
        return fields + _CHECK.pack(crc16(fields))

    @classmethod
    def from_bytes(cls, data: bytes) -> "Block":
        """Read a block.

        Raises `DataError` if its size, its version or its checksum is wrong.
        """
        if len(data) != BYTES:
            raise DataError(f"a block of unit data has {BYTES} bytes, not {len(data)}")
        fields, check = data[: _FIELDS.size], _CHECK.unpack(data[_FIELDS.size :])[0]
        version, _, number, delay, rate = _FIELDS.unpack(fields)
        if version != VERSION:
            raise DataError(f"the block has version {version}, this echocal reads version {VERSION}")
        if check != crc16(fields):
            raise DataError(
                f"the block's CRC is 0x{check:04X}, that of its bytes 0x{crc16(fields):04X}: it is damaged"
            )
        return cls(number, delay, rate)
