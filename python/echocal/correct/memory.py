"""Amounts of memory."""

import re

from echocal.errors import UsageError
from echocal.keywords import keyword

__all__ = ["in_bytes"]

_LEAST = 256 << 20
"""Bytes below which the libraries alone do not fit; measured."""

_UNITS = {"": 1, "B": 1, "KB": 1 << 10, "MB": 1 << 20, "GB": 1 << 30, "TB": 1 << 40}


def in_bytes(text: int | str) -> int:
    """Bytes of an amount of memory.

    Raises
    ------
    UsageError
        If it is no amount, or too small for the libraries.

    Examples
    --------
    >>> in_bytes("512MB") == 512 * 2**20, in_bytes("1.5 GiB") == 3 * 2**29
    (True, True)
    """
    match = re.fullmatch(r"\s*(\d+(?:\.\d+)?)\s*([KMGT]?)i?(B?)\s*", str(text), re.IGNORECASE)
    unit = "" if match is None else (match[2] + (match[3] or ("B" if match[2] else ""))).upper()
    if match is None or unit not in _UNITS:
        message = f"{keyword('memory', text)} is no amount of memory; e.g. 512MB, 2GB"
        raise UsageError(message)
    amount = int(float(match[1]) * _UNITS[unit])
    if amount < _LEAST:
        message = f"{keyword('memory', text)} is too little: the libraries alone take {_LEAST >> 20}MB"
        raise UsageError(message)
    return amount
