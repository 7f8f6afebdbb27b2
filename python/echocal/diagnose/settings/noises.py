"""Numbers that several noises share, and those of single noises."""

from dataclasses import dataclass

from echocal.diagnose.settings.causes import CauseSettings
from echocal.diagnose.settings.threshold import threshold

__all__ = ["NoiseSettings"]


@dataclass(frozen=True)
class NoiseSettings(CauseSettings):
    """All numbers that decide about noises."""

    step_by_chance: float = threshold(
        0.05,
        "1",
        "probability, where the stations do not stand in a step of the readings, of errors that lie so close "
        "within it; below, the step is that of the tape; convention",
    )
    harmless: float = threshold(
        0.01, "1", "part of the noise's variance below which a quantization is a note, not a cause"
    )
    negligible: float = threshold(
        1.5e-4, "m", "standard deviation below which a quantization is negligible for users of such sensors"
    )
    sets: int = threshold(4, "1", "most probable sets of effects beside which noises are compared; judgement")
    negligible_odds: float = threshold(
        7.0,
        "log odds",
        "a set that is less probable by more, whatever the noise, has no share, and a convection or a set "
        "beside which steps of the level are weighed is pruned: 1 in 1,100",
    )
    worth: float = threshold(
        2.0,
        "1",
        "standard errors of a moment from which on a fit is tried; without such noise, 1 table in 40",
    )
    scattered_part: float = threshold(
        0.15,
        "1",
        "largest part of rows that scatter far more than the others; more are no exception; judgement",
    )
    scattered_apart: float = threshold(
        3.0, "1", "least standard deviation of such rows over that of the others; judgement"
    )
    scattered_gain: float = threshold(
        10.0,
        "1",
        "least gain in log likelihood over normal noise, less the cost of both parameters; judgement",
    )
    autocorrelated: float = threshold(
        0.1, "1", "probability of autocorrelation from which on convection is tried; judgement"
    )
    matters: float = threshold(
        0.05, "1", "part of the noise's variance from which on a noise counts for the verdict; judgement"
    )
    split: float = threshold(
        0.2,
        "1",
        "probability below which a nuisance noise is not listed in the sets; each set includes it anyway",
    )
