"""Causes that the catalogue does not have."""

import numpy as np

from echocal.virtual_bench.campaign.campaign import Campaign
from echocal.virtual_bench.campaign.causes.registry import cause

__all__: list[str] = []


@cause("m", 2e-3, 8e-3, "time", "weather", in_catalogue=False)
def leaning_mast(campaign: Campaign, size: float, random: np.random.Generator) -> None:
    """The sun bends the mast toward the target, an hour late."""
    hours = campaign.seconds / 3600.0 % 24
    campaign.distance += size * np.maximum(0.0, np.sin(2 * np.pi * (hours - 7) / 24)) ** 2


@cause("m", 2e-3, 8e-3, "distances", in_catalogue=False)
def standing_wave(campaign: Campaign, size: float, random: np.random.Generator) -> None:
    """A thin film in front of the sensor makes the reading wave with the distance."""
    period = random.uniform(0.4, 0.9)
    campaign.distance += size * np.sin(2 * np.pi * campaign.distance / period + random.uniform(0, 6))


@cause("m", 2e-3, 8e-3, "time", "weather", in_catalogue=False)
def morning_pump(campaign: Campaign, size: float, random: np.random.Generator) -> None:
    """A machine next door runs in the morning and shifts the target."""
    hours = campaign.seconds / 3600.0 % 24
    campaign.distance += size * ((hours > 6.0) & (hours < 10.5))
