"""Numbers of several tables: of a pool, and of a fleet."""

from dataclasses import dataclass

from echocal.diagnose.settings.threshold import threshold

__all__ = ["FleetSettings", "PoolingSettings"]


@dataclass(frozen=True, kw_only=True)
class PoolingSettings:
    """Numbers of a pool of several tables."""

    between: tuple[float, ...] = threshold(
        (0.0, 0.03, 0.1, 0.2, 0.4, 0.8),
        "prior sd",
        "standard deviations between tables that are tried, all equally probable; 0 is one size for all; "
        "chosen by hand: from one size to sizes almost as different as those of unrelated devices",
    )
    speaks: float = threshold(
        1.0,
        "log odds",
        "a table whose log Bayes factor is at least this supports a cause; at most minus this, it "
        "contradicts the cause; chosen by hand: odds of 2.7 to 1",
    )
    fewest_tables: int = threshold(
        2,
        "tables",
        "that must support a cause before the pool names it; argument: one table shows no recurrence",
    )


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
