"""One number that decides, with its unit, its meaning and its source."""

from dataclasses import field
from typing import Any

__all__ = ["PROBABLE", "threshold"]

PROBABLE = 0.5
"""Probability from which on something counts as present: more probable than not."""


def threshold(value: Any, unit: str, source: str) -> Any:
    """Field of a settings class.

    Parameters
    ----------
    value : float or tuple
        Default.
    unit : str
        SI; ``"1"`` for a pure number.
    source : str
        Meaning and source of the number.
    """
    return field(default=value, metadata={"unit": unit, "source": source})
