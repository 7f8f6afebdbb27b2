"""Every cause of the catalogue, planted by the oracle's physics."""

from hidden_effects.causes import (
    acoustics,
    bookkeeping,
    clock,
    distribution,
    geometry,
    speed_law,
    supply,
    thermometry,
)
from hidden_effects.causes.registry import CAUSES, Cause

__all__ = [
    "CAUSES",
    "Cause",
    "acoustics",
    "bookkeeping",
    "clock",
    "distribution",
    "geometry",
    "speed_law",
    "supply",
    "thermometry",
]
