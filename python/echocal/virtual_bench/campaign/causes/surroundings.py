"""Causes around the sensor: air, wind, target, mount, and what the thermometer makes of the air."""

from dataclasses import replace

import numpy as np

from echocal.virtual_bench.campaign.campaign import Campaign, cause
from echocal.virtual_bench.instruments import following

__all__: list[str] = []

_NEUTRAL_CO2 = 4.2e-4


@cause("mol/mol", 1.5e-3, 2e-2)
def gas_composition(campaign: Campaign, size: float, random: np.random.Generator) -> None:
    """The air holds more carbon dioxide than usual."""
    campaign.co2 = _NEUTRAL_CO2 + size


@cause("K/m", -1.0, 1.0, "distances")
def temperature_gradient(campaign: Campaign, size: float, random: np.random.Generator) -> None:
    """The air gets warmer toward the target."""
    campaign.air += 0.5 * size * campaign.distance


@cause("1", 0.7, 1.3, "open air")
def wind(campaign: Campaign, size: float, random: np.random.Generator) -> None:
    """Wind blows along the path; its log is there."""
    gusts = 6.0 * size / max(np.abs(campaign.around.wind_along).mean(), 1e-9)
    campaign.around.wind_along *= min(gusts, 8.0)
    campaign.shown.add("wind_m_s")


@cause("rad", 0.06, 0.2, "reference", "distances")
def oblique_target(campaign: Campaign, size: float, random: np.random.Generator) -> None:
    """A wide plate is tilted, so its nearest point is not the one that the ruler tells."""
    campaign.target = replace(campaign.target, tilt=size, half_width=1.5, half_height=1.0)


@cause("m", 2e-3, 8e-3, "reference", "visits")
def target_geometry(campaign: Campaign, size: float, random: np.random.Generator) -> None:
    """Some placements have another target, whose front is nearer than its mark."""
    other = random.permutation(campaign.placement.max() + 1)[: (campaign.placement.max() + 1) // 2]
    nearer = np.isin(campaign.placement, other)
    campaign.distance -= np.where(nearer, size, 0.0)
    campaign.logger.append(lambda table: table.assign(target=np.where(nearer, 2, 1)))


@cause("m", 0.15, 0.5, "distances")
def multipath(campaign: Campaign, size: float, random: np.random.Generator) -> None:
    """A floor below the axis returns the sound together with a narrow target."""
    campaign.sensor = campaign.sensor.but(ideal=False)
    campaign.scene |= {"floor": size, "floor_reflectivity": 0.8}
    campaign.target = replace(campaign.target, half_width=0.04, half_height=0.6)


@cause("m", 0.02, 0.12, "distances")
def beam_edge(campaign: Campaign, size: float, random: np.random.Generator) -> None:
    """A small thing stands beside the axis, nearer than the far targets."""
    campaign.sensor = campaign.sensor.but(ideal=False)
    place = np.quantile(campaign.distance, 0.6)
    campaign.scene |= {"object_distance": place, "object_aside": size, "object_size": 0.15}


@cause("1", 0.02, 0.1)
def crosstalk(campaign: Campaign, size: float, random: np.random.Generator) -> None:
    """Another sensor's burst arrives in some of the readings."""
    campaign.sensor = campaign.sensor.but(ideal=False)
    heard = random.uniform(size=len(campaign)) < size
    arrives = random.uniform(1.5e-3, 25e-3, len(campaign))
    campaign.scene |= {"other_time": np.where(heard, arrives, np.inf), "other_size": 0.4}


@cause("1", 3.0, 8.0, "distances")
def noise_growth(campaign: Campaign, size: float, random: np.random.Generator) -> None:
    """The air is turbulent: readings scatter more the longer the path."""
    own = campaign.turbulence
    campaign.turbulence = replace(own, way=size * own.way, time_constant=0.1)


@cause("K", 0.25, 0.8, "time")
def correlated_noise(campaign: Campaign, size: float, random: np.random.Generator) -> None:
    """The air of the path differs from that at the thermometer, slowly and irregularly."""
    campaign.slow_air = size


@cause("m", 3e-3, 2e-2, "time", "unknown distance")
def slow_level(campaign: Campaign, size: float, random: np.random.Generator) -> None:
    """The target itself moves slowly: nobody tells the reference."""
    phase = 2 * np.pi * (campaign.seconds - campaign.seconds[0]) / np.ptp(campaign.seconds)
    campaign.distance += size * np.sin(random.uniform(0.6, 1.4) * phase + random.uniform(0, 6))


@cause("m", 5e-4, 1.2e-3, "weather")
def recorded_amplitude(campaign: Campaign, size: float, random: np.random.Generator) -> None:
    """The surface becomes rough and smooth again, so its echo weakens; the amplitude is logged."""
    campaign.sensor = campaign.sensor.but(ideal=False)
    phase = 2 * np.pi * (campaign.seconds - campaign.seconds[0]) / np.ptp(campaign.seconds)
    rough = size * np.sin(random.uniform(1.0, 2.0) * phase + random.uniform(0, 6)) ** 2
    campaign.target = replace(campaign.target, roughness=rough)
    campaign.shown.add("amplitude")


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
