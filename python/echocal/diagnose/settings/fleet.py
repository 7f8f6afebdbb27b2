"""Numbers of a fleet."""

from dataclasses import dataclass

from echocal.diagnose.settings.threshold import threshold

__all__ = ["FleetSettings"]


@dataclass(frozen=True, kw_only=True)
class FleetSettings:
    """Numbers of a fleet: how common each cause is among sensors of a kind."""

    prior_sensors: float = threshold(
        1.0,
        "sensors",
        "that the prior of a cause's prevalence weighs as much as; argument: the least that keeps a "
        "prevalence from being exactly zero, and one sensor among many decides nothing",
    )
    false_discovery_rate: float = threshold(
        0.05,
        "of the names",
        "accepted part of false names, for the longest list of names that has no more; convention",
    )
    together: float = threshold(
        1e-3,
        "p-value",
        "below it, divided among all pairs, two causes come together more often than chance; argument: one "
        "false pair in a thousand fleets",
    )
