"""Numbers of the search for faults that several faults share, and those of single faults."""

from dataclasses import dataclass, field

from echocal.diagnose.settings.causes import CauseSettings
from echocal.diagnose.settings.threshold import threshold

__all__ = ["FarRows", "FaultSettings", "Outliers", "SharedFactor"]


@dataclass(frozen=True)
class FarRows:
    """When a row is farther off than noise or air can explain."""

    deviations: float = threshold(
        12.0,
        "1",
        "robust standard deviations: far beyond Student's t with 3 degrees in 1,000 rows; judgement",
    )
    part: float = threshold(
        0.015, "1", "part of the reading: 8 K of wrong temperature make 1.4 % (0.6 m/s per K of 343 m/s)"
    )


@dataclass(frozen=True)
class Outliers:
    """Outliers on one side: crosstalk and multipath."""

    usual: float = threshold(0.02, "1", "part of the rows of a table with such a fault; judgement")
    most: float = threshold(0.3, "1", "part of the rows beyond which something else is wrong; judgement")
    moved_rows: float = threshold(50, "1", "rows on either side of a moment when the sensor moved; judgement")
    moved_distances: float = threshold(10, "1", "distances of these rows, at least; judgement")
    moved_distances_per_row: float = threshold(
        0.2, "1", "the same per row: all echoes from one target may be misread; judgement"
    )
    moved_tail: float = threshold(
        0.01, "1", "part of the outliers at either end that may stand alone; judgement"
    )
    moved_as_far: float = threshold(
        0.5, "1", "part of the outliers' median deviation that the rows among them deviate by; judgement"
    )


@dataclass(frozen=True)
class SharedFactor:
    """A factor between readings and references that most rows share."""

    spread: float = threshold(0.03, "1", "of the log ratio: what laws, thermometers and clocks do to it")
    near: float = threshold(0.15, "1", "of the log ratio, beyond which a factor is not the explanation")
    most: float = threshold(0.6, "1", "part of the rows that must share the factor; judgement")


@dataclass(frozen=True)
class FaultSettings(CauseSettings):
    """Every number that decides about faults.

    Attributes
    ----------
    accepted : float
    listed : float
    cap : float
    far : FarRows
    outliers : Outliers
    factor : SharedFactor
    """

    accepted: float = threshold(
        0.5, "1", "probability from which on a table is repaired: more likely than not"
    )
    listed: float = threshold(1e-3, "1", "probability from which on a fault has a place in the posterior")
    cap: float = threshold(60.0, "1", "largest log Bayes factor: beyond it an odds ratio says no more")
    far: FarRows = field(default_factory=FarRows)
    outliers: Outliers = field(default_factory=Outliers)
    factor: SharedFactor = field(default_factory=SharedFactor)
