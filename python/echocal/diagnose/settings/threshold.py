"""One number that decides: its value, and beside it what a reader asks about it."""

from dataclasses import field
from typing import Any

__all__ = ["number", "threshold"]


def threshold(value: float, unit: str, source: str) -> Any:
    """Field of a settings class.

    Parameters
    ----------
    value : float
        Default.
    unit : str
        SI; ``"1"`` for a pure number.
    source : str
        What the number means and where it comes from.
    """
    return field(default=value, metadata={"unit": unit, "source": source})


def number(value: Any, unit: str, meaning: str, source: str) -> Any:
    """The same, also of tuples; its meaning and its source apart."""
    return threshold(value, unit, f"{meaning}; {source}")
