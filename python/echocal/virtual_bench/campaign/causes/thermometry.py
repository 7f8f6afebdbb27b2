"""Causes between the air and the recorded temperature."""

import numpy as np

from echocal.virtual_bench.campaign.campaign import Campaign
from echocal.virtual_bench.campaign.causes.registry import cause
from echocal.virtual_bench.thermometers import following

__all__: list[str] = []


@cause("K", -2.0, 2.0)
def temperature_offset(campaign: Campaign, size: float, random: np.random.Generator) -> None:
    """The thermometer reads too low by a constant; with a negative size too high."""
    campaign.thermometer.append(lambda recorded: recorded - size)


@cause("1", -0.08, 0.08)
def temperature_gain(campaign: Campaign, size: float, random: np.random.Generator) -> None:
    """The thermometer's scale is wrong: it reads too low above 0 degC; with a negative size too high."""
    campaign.thermometer.append(lambda recorded: recorded / (1 + size))


@cause("s", 120.0, 1800.0, "time", "weather")
def temperature_lag(campaign: Campaign, size: float, random: np.random.Generator) -> None:
    """The thermometer follows the air slowly."""
    campaign.thermometer.append(lambda recorded: following(recorded, campaign.seconds, size))


@cause("s", 600.0, 3600.0, "time", "weather")
def temperature_timestamp_shift(campaign: Campaign, size: float, random: np.random.Generator) -> None:
    """The temperature of a row was measured earlier."""
    at = campaign.seconds
    campaign.thermometer.append(lambda recorded: np.interp(at - size, at, recorded))


@cause("K", 0.5, 3.0, "time")
def temperature_self_heating(campaign: Campaign, size: float, random: np.random.Generator) -> None:
    """The board warms the thermometer after it is switched on."""
    since = campaign.seconds - campaign.seconds[0]
    warms = random.uniform(300.0, 1500.0) if np.ptp(since) < 1e5 else random.uniform(2e3, 2e4)
    campaign.thermometer.append(lambda recorded: recorded + size * (1 - np.exp(-since / warms)))


@cause("K per kW/m2", 2.0, 8.0, "open air")
def temperature_radiation(campaign: Campaign, size: float, random: np.random.Generator) -> None:
    """The sun warms the thermometer; the radiation is logged."""
    campaign.thermometer.append(lambda recorded: recorded + size * 1e-3 * campaign.around.radiation)
    campaign.shown.add("radiation_W_m2")


@cause("1", 0.25, 0.8, "weather")
def thermometer_mix(campaign: Campaign, size: float, random: np.random.Generator) -> None:
    """The path is partly as warm as another place, whose thermometer is logged, too."""
    wall = (
        following(campaign.around.temperature, campaign.seconds, 4 * 3600.0)
        + 0.004 * campaign.around.radiation
    )
    campaign.air += size * (wall - campaign.around.temperature)
    campaign.second_thermometer = wall
    campaign.shown.add("temperature_wall_C")


@cause("K", 0.5, 1.0)
def temperature_quantization(campaign: Campaign, size: float, random: np.random.Generator) -> None:
    """The thermometer has coarse steps."""
    campaign.thermometer.append(lambda recorded: np.round(recorded / size) * size)
