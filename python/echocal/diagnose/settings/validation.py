"""How held-out rows judge a claim, and how the gain is measured."""

from dataclasses import dataclass

from echocal.diagnose.settings.threshold import number

__all__ = ["ValidationSettings"]


@dataclass(frozen=True, kw_only=True)
class ValidationSettings:
    """Numbers of the held-out rows."""

    informative_share: float = number(
        0.1,
        "of the cause's rms signal",
        "held-out rows in which a cause changes less cannot judge it",
        "chosen by hand",
    )
    pieces: int = number(40, "pieces", "of contiguous held-out rows that are resampled", "chosen by hand")
    resamples: int = number(2000, "draws", "of those pieces", "chosen by hand")
    interval: float = number(0.95, "probability", "of the interval of the gain", "convention")
    reachable: float = number(
        0.02,
        "of the mean square before",
        "where less can be reached, no part of it is told",
        "chosen by hand",
    )
    shifted_inner: tuple[float, float] = number(
        (0.2, 0.8),
        "quantiles",
        "of a column, that a model is fitted to when it is judged outside",
        "chosen by hand",
    )
    shifted_values: int = number(5, "distinct values", "a column of fewer has no middle", "chosen by hand")
