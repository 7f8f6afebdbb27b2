"""Numbers of the smooth correction, and of the check that a large error is not called nothing."""

from dataclasses import dataclass

from echocal.diagnose.settings.threshold import threshold

__all__ = ["SmoothSettings"]


@dataclass(frozen=True, kw_only=True)
class SmoothSettings:
    """Numbers of the smooth correction."""

    gain_from: float = threshold(
        3.0,
        "log likelihood",
        "a column takes part if it raises that of the rows left out by so much; odds of 20",
    )
    standard_errors: float = threshold(
        1.0,
        "standard errors",
        "of this rise, from its scatter over the parts left out: so many are subtracted from it first; rule "
        "of one standard error: Hastie, Tibshirani, Friedman, Elements of Statistical Learning, 7.10",
    )
    far: float = threshold(
        0.5,
        "of the mean square",
        "the floor is far below the error if the columns can remove more than this part; chosen by hand: "
        "more than half of the error is no noise",
    )
    far_from_chance: float = threshold(
        1e-5,
        "p-value",
        "and if chance removes as much with less than this probability; chosen by hand: the noise models "
        "are a grid, and with the nearest one p-values are too small",
    )
