"""Causes in the sensor, its timer and its supply."""

from dataclasses import replace

import numpy as np

from echocal.virtual_bench.campaign.campaign import Campaign, cause

__all__: list[str] = []


@cause("s", 1.5e-5, 1.2e-4)
def fixed_delay(campaign: Campaign, size: float, random: np.random.Generator) -> None:
    """The pulse is longer by a constant."""
    campaign.pulse.append(lambda seconds: seconds + size)


@cause("m", -1.5e-2, 1.5e-2, "reference")
def zero_error(campaign: Campaign, size: float, random: np.random.Generator) -> None:
    """The ruler's zero is before the face of the sensor, so it tells too little; negative: too much."""
    campaign.distance += size


@cause("1", -0.005, 0.005)
def clock_error(campaign: Campaign, size: float, random: np.random.Generator) -> None:
    """The clock of the timer runs fast; with a negative size slow."""
    campaign.pulse.append(lambda seconds: seconds * (1 + size))


@cause("1/K", -1.5e-4, 1.5e-4)
def clock_temperature_coefficient(campaign: Campaign, size: float, random: np.random.Generator) -> None:
    """The clock's frequency rises with the temperature; with a negative size it falls."""
    celsius = campaign.device_temperature
    campaign.pulse.append(lambda seconds: seconds * (1 + size * (celsius - 25.0)))


@cause("1", 0.0058, 0.006)
def interrupt_loss(campaign: Campaign, size: float, random: np.random.Generator) -> None:
    """A loop that counts loses time to interrupts, as pulseIn() of Arduino does."""
    campaign.pulse.append(lambda seconds: seconds * (1 - size))


@cause("s", 4e-6, 2e-5)
def timer_quantization(campaign: Campaign, size: float, random: np.random.Generator) -> None:
    """The timer has coarse ticks."""
    campaign.pulse.append(lambda seconds: np.floor(seconds / size) * size)


@cause("s", 3e-5, 3e-4)
def polling_jitter(campaign: Campaign, size: float, random: np.random.Generator) -> None:
    """A busy computer polls the pulse and sees its end late."""
    late = random.exponential(size, len(campaign))
    campaign.pulse.append(lambda seconds: seconds + late)


@cause("1", 0.5, 2.0, "distances")
def amplitude_walk(campaign: Campaign, size: float, random: np.random.Generator) -> None:
    """A comparator has one threshold at all times: a weaker echo crosses it cycles later. 1: an HC-SR04's."""
    own = campaign.sensor
    campaign.sensor = own.but(
        ideal=False,
        threshold=size * own.comparator.threshold,
        raised=0.0,
        blanking=1.6e-3,  # the own burst has sunk below half of the usual threshold then
        noise=min(size, 1.0) * own.noise,  # or it alone would cross a low threshold
    )


@cause("Hz/K", 40.0, 120.0, "weather")
def resonance_drift(campaign: Campaign, size: float, random: np.random.Generator) -> None:
    """The transducers' resonance leaves the frequency of the burst when it is cold or hot."""
    own = campaign.sensor
    chain = {"transmitter": own.transmitter, "receiver": own.receiver}
    drifting = {name: replace(one, drift=one.drift - size) for name, one in chain.items()}
    campaign.sensor = own.but(ideal=False, **drifting)


@cause("1", 0.1, 0.4, "time")
def supply_voltage(campaign: Campaign, size: float, random: np.random.Generator) -> None:
    """The battery empties, so the burst weakens while the threshold stays; the supply is logged."""
    part = (campaign.seconds - campaign.seconds[0]) / np.ptp(campaign.seconds)
    campaign.around.supply -= size * part
    campaign.sensor = campaign.sensor.but(ideal=False, supply_gain=2.0)
    campaign.shown.add("supply_V")


@cause("m", -1e-2, 1e-2, "time")
def drift(campaign: Campaign, size: float, random: np.random.Generator) -> None:
    """The mount creeps away from the target; with a negative size toward it."""
    campaign.distance += size * (campaign.seconds - campaign.seconds[0]) / np.ptp(campaign.seconds)


@cause("m", -1e-2, 1e-2, "time")
def step_change(campaign: Campaign, size: float, random: np.random.Generator) -> None:
    """The sensor is knocked once, away from the target; with a negative size toward it."""
    first, last = campaign.seconds[[0, -1]]
    campaign.distance += size * (campaign.seconds > first + random.uniform(0.25, 0.75) * (last - first))


@cause("s", 1.6e-3, 2.6e-3, "reference", "distances")
def blanking_distance(campaign: Campaign, size: float, random: np.random.Generator) -> None:
    """The receiver listens late: nearer targets are told by a later echo, or not at all."""
    campaign.sensor = campaign.sensor.but(ideal=False, blanking=size)


@cause("1", 0.1, 0.3, "distances")
def cycle_slip(campaign: Campaign, size: float, random: np.random.Generator) -> None:
    """The echo's amplitude flickers, so the comparator takes another cycle now and then."""
    campaign.sensor = campaign.sensor.but(ideal=False)
    campaign.turbulence = replace(campaign.turbulence, log_amplitude=size)
