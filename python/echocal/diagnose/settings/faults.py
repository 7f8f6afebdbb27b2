"""Numbers that several faults share, and those of single faults."""

from dataclasses import dataclass, field

from echocal.diagnose.settings.causes import CauseSettings
from echocal.diagnose.settings.threshold import threshold

__all__ = ["Constant", "FarRows", "FaultSettings", "Outliers", "SharedFactor"]


@dataclass(frozen=True)
class FarRows:
    """When a row is farther off than noise or air can explain."""

    deviations: float = threshold(
        12.0,
        "1",
        "robust standard deviations; Student's t with 3 degrees rarely reaches them in 1,000 rows; judgement",
    )
    part: float = threshold(
        0.015,
        "1",
        "part of the reading; a temperature error of 8 K changes it by 1.4 % (0.6 m/s per K of 343 m/s)",
    )


@dataclass(frozen=True)
class Outliers:
    """Outliers on one side: crosstalk and multipath."""

    usual: float = threshold(0.02, "1", "part of the rows of a table with such a fault; judgement")
    most: float = threshold(0.3, "1", "largest part of the rows that such a fault affects; judgement")
    odd: float = threshold(
        0.03,
        "1",
        "part of the tables with rows that are far off for a reason outside the catalogue; judgement",
    )
    anywhere: float = threshold(
        0.75,
        "1",
        "part of the echoes over another way that come from anywhere on it, rather than from any order of "
        "magnitude, as odd rows do; judgement",
    )
    alone: float = threshold(
        4.0,
        "1",
        "one table in so many with such a fault has one such row; with odd rows, one in two; of k rows, the "
        "first are as 1 / k, the others as 1 / k (k + 1); judgement",
    )
    tail: float = threshold(
        0.5,
        "1",
        "of that limit: rows between the two, on both sides, say how heavy the tails are; judgement",
    )
    moved_rows: float = threshold(50, "1", "rows on each side of a moment when the sensor moved; judgement")
    moved_distances: float = threshold(10, "1", "fewest distances of these rows; judgement")
    moved_distances_per_row: float = threshold(
        0.2, "1", "the same per row, as all echoes of one target may be misread; judgement"
    )
    moved_tail: float = threshold(
        0.01, "1", "part of the outliers at each end that may be isolated; judgement"
    )
    moved_as_far: float = threshold(
        0.5,
        "1",
        "least deviation of the rows between outliers, over the median deviation of the outliers; judgement",
    )


@dataclass(frozen=True)
class Constant:
    """A constant that a device reports again and again."""

    jitter: float = threshold(
        5e-3, "1", "largest relative standard deviation: tens of us in pulses of some 10 ms; judgement"
    )
    among: float = threshold(
        0.05,
        "1",
        "prior of a constant that is not longer than every good reading, over that of others; judgement",
    )
    wild: float = threshold(0.05, "1", "part of the rows beside it that are there by chance; judgement")
    window: float = threshold(
        0.01, "1", "of the logarithm, in which the rows of one value lie: twice the largest jitter"
    )
    of_echoes: float = threshold(
        1.5,
        "1",
        "standard deviation of the log scatter of one thing's echoes: they vary four times as much or less",
    )
    range: float = threshold(8.0, "1", "of the logarithm, in which a value may lie anywhere: exp(8) is 3,000")


@dataclass(frozen=True)
class SharedFactor:
    """A factor between readings and references that most rows share."""

    spread: float = threshold(
        0.03, "1", "standard deviation of the log ratio from laws, thermometers and clocks"
    )
    near: float = threshold(0.15, "1", "difference of the log ratio beyond which a factor is no explanation")
    most: float = threshold(0.6, "1", "smallest part of the rows with the factor; judgement")


@dataclass(frozen=True)
class FaultSettings(CauseSettings):
    """All numbers that decide about faults."""

    listed: float = threshold(1e-3, "1", "probability from which on the posterior includes a fault")
    cap: float = threshold(60.0, "1", "largest log Bayes factor; larger odds have no practical meaning")
    far: FarRows = field(default_factory=FarRows)
    outliers: Outliers = field(default_factory=Outliers)
    constant: Constant = field(default_factory=Constant)
    factor: SharedFactor = field(default_factory=SharedFactor)
