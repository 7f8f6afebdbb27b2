"""The polars library, which a fleet is read with."""

from importlib import import_module
from typing import Any, TypeAlias

from echocal.errors import UsageError

__all__ = ["Frame", "polars"]

Frame: TypeAlias = Any
"""A ``polars.DataFrame``; the library may be absent."""


def polars() -> Any:
    """The library.

    Raises
    ------
    UsageError
        If it is not installed.
    """
    try:
        return import_module("polars")
    except ImportError:
        message = "a fleet is read with polars: pip install 'echocal[batch]'"
        raise UsageError(message) from None
