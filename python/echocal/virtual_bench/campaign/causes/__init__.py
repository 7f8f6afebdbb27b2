"""Causes: to stage a further one, write a function with the decorator `cause` in the room where it acts."""

from echocal.virtual_bench.campaign.campaign import CAUSES, Cause
from echocal.virtual_bench.campaign.causes import instrument, surroundings

__all__ = ["CAUSES", "Cause", "instrument", "surroundings"]
