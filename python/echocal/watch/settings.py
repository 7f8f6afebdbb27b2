"""The numbers that decide when a change is told, each with its unit, meaning and source."""

from dataclasses import dataclass, fields
from typing import Any

from echocal.diagnose.settings.threshold import threshold
from echocal.errors import UsageError


@dataclass(frozen=True, kw_only=True)
class WatchSettings:
    """Numbers of the sequential test (docs/method/several-tables.md, section 11).

    Examples
    --------
    >>> from echocal.watch import WatchSettings
    >>> WatchSettings().learn
    500
    """

    false_alarms: float = threshold(
        0.1, "1/(sensor year)", "false alarms that the threshold is made for; chosen by hand"
    )
    certainty: float = threshold(
        0.9,
        "1",
        "probability that the rate of false alarms is not higher, for the noise is known from rows only; "
        "usual for a guaranteed rate (Gandy & Kvaloy 2013)",
    )
    learn: int = threshold(
        500,
        "rows",
        "with residual that the level, the sizes before a change and the noise are learned from; argument: "
        "the noise is then known to 3 %, which raises the threshold by 4 %",
    )
    level: float = threshold(
        5.0, "m", "standard deviation of the prior of the level; argument: the range of the sensors, so flat"
    )
    clip: float = threshold(
        3.0,
        "noise sd",
        "a row's residual counts at most this much; argument: one outlier adds at most 4.5 to a log "
        "likelihood ratio that needs about 15 (Huber 1964)",
    )
    onsets: int = threshold(
        8,
        "1",
        "onsets that are tried are at most 1/8 of their age apart; argument: an onset that is wrong by 1/16 "
        "of its age loses at most 1/16 of the information",
    )
    longest: int = threshold(
        16384, "rows", "greatest age of an onset that is tried; chosen by hand: it bounds the memory"
    )
    alias: float = threshold(
        0.995,
        "correlation",
        "causes with signatures so alike share one test; argument: the test of one then loses at most 1 % "
        "of the information about the other",
    )
    autocorrelations: tuple[float, ...] = threshold(
        (0.2, 0.4, 0.6, 0.7, 0.8, 0.85, 0.9, 0.925, 0.95, 0.965, 0.98, 0.99, 0.995),
        "1",
        "autocorrelations that the noise may have; as the diagnosis, with steps between",
    )
    moving: tuple[float, ...] = threshold(
        (0.0, 0.3, 0.5, 0.7, 0.8, 0.9, 0.95),
        "1",
        "white parts of the noise that are tried, where they are below the autocorrelation; as the "
        "diagnosis, with steps between",
    )
    white: float = threshold(0.5, "1", "prior probability of white noise; as the diagnosis")
    recent: int = threshold(
        64, "rows", "that a scale of recent rows remembers; chosen by hand: a doubled noise is seen after 35"
    )
    greater: float = threshold(
        1.35,
        "1",
        "ratio of the scale of recent rows over that of all, from which it counts; argument: 6 standard "
        "deviations of the former in white noise",
    )
    refused: float = threshold(
        0.01, "1", "probability that no rate is stated though the noise is of the model class; convention"
    )
    interval: float = threshold(0.95, "1", "probability of the interval of an onset; convention")
    gap: float = threshold(5.0, "usual intervals", "a longer wait begins a new series; as the diagnosis")
    confirm: int = threshold(
        3,
        "rows",
        "that go on from a leap of the clock before it is believed; chosen by hand: two wrong times in a "
        "row are rare, and a pause delays a test by two rows",
    )
    fewest: int = threshold(
        40, "rows", "after the onset before the diagnosis runs; chosen by hand: the diagnosis needs ten"
    )
    kept: int = threshold(1000, "rows", "that are kept of each sensor, for the diagnosis; chosen by hand")

    def __post_init__(self) -> None:
        if not self.false_alarms > 0.0:
            message = f"false alarms per sensor and year are {self.false_alarms!r}; give a number above 0"
            raise UsageError(message)
        if not 50 <= self.learn <= 100_000:
            raise UsageError(f"a sensor learns from {self.learn!r} rows; give 50 to 100000")

    @classmethod
    def listed(cls) -> list[tuple[str, Any, str, str]]:
        """Name, value, unit, and meaning with source, of all numbers."""
        return [(f.name, f.default, f.metadata["unit"], f.metadata["source"]) for f in fields(cls)]
