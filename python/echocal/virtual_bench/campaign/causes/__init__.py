"""Causes: to stage a further one, write a function with the decorator `cause` in the room where it acts."""

from echocal.virtual_bench.campaign.campaign import CAUSES, Cause
from echocal.virtual_bench.campaign.causes import bookkeeping, instrument, surroundings

__all__ = ["CAUSES", "Cause", "bookkeeping", "instrument", "surroundings"]
