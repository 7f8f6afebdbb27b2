"""Numbers of a pool of several tables."""

from dataclasses import dataclass

from echocal.diagnose.settings.threshold import threshold

__all__ = ["PoolingSettings"]


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
