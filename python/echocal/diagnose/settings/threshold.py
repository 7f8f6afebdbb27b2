"""One number that decides, with its unit, its meaning and its source."""

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
        Meaning and source of the number.
    """
    return field(default=value, metadata={"unit": unit, "source": source})


def number(value: Any, unit: str, meaning: str, source: str) -> Any:
    """The same, with meaning and source as two texts; the value may be a tuple."""
    return threshold(value, unit, f"{meaning}; {source}")
