"""One number that decides a verdict: its value, and beside it what a reader asks about it."""

from __future__ import annotations

from dataclasses import field
from typing import Any

__all__ = ["number"]


def number(value: Any, unit: str, meaning: str, source: str) -> Any:
    """A field of a settings class.

    Parameters
    ----------
    value : float, int, tuple or mapping
        The default.
    unit : str
        ``"1"`` for a pure number.
    meaning : str
        What it decides, as a phrase.
    source : str
        Where the value comes from: the run that measured it, a source, or an argument; "chosen by
        hand" where there is none of these.
    """
    return field(default=value, metadata={"unit": unit, "meaning": meaning, "source": source})
