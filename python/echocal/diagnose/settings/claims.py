"""When a cause is claimed, when it is named, and when it is not."""

from dataclasses import dataclass

from echocal.diagnose.settings.threshold import number

__all__ = ["ClaimSettings"]


@dataclass(frozen=True, kw_only=True)
class ClaimSettings:
    """Numbers of the decision rule."""

    claim_below: float = number(
        0.6,
        "P(no effect)",
        "below it some effect is claimed, though each one may be unlikely",
        "tuned on development cases of the benchmark: false alarms against power, each at its target",
    )
    claim_below_of_few: float = number(
        0.44,
        "P(no effect)",
        "the same, of too few rows to tell autocorrelated noise",
        "the prior of no cause: the data must speak for an effect; measured on 539 nulls of design a",
    )
    few_rows: int = number(100, "rows", "fewer do not tell autocorrelated noise", "chosen by hand")
    claim_below_amid_noise: float = number(
        0.25,
        "P(no effect)",
        "the same, where the noise is autocorrelated or the stations err",
        "measured on 750 fresh nulls: half the false alarms at the same power",
    )
    noisy_from: float = number(
        0.5, "probability", "of such noise, from which on it is there", "more probable than not"
    )
    named: float = number(
        0.9, "probability", "of one class, from which on it is named", "the interface's promise"
    )
    credible: float = number(0.95, "probability", "that the credible set holds", "convention")
    separable: float = number(
        1.0, "expected log odds", "below it two causes are of one class", "chosen by hand"
    )
    plausible_size: float = number(
        9.0,
        "prior sd",
        "a cause that imitates another with a larger size is separable from it by that size",
        "three standard deviations of the widest prior",
    )
    nearly: float = number(
        1 / 3,
        "of the largest probability",
        "sets of causes above it: the one that most devices can compensate is taken",
        "chosen by hand: odds that nobody acts on",
    )
    modeled_from: float = number(
        0.5, "probability", "a claim enters the model; if none does, all do", "more probable than not"
    )
    mentioned_from: float = number(0.05, "probability", "another cause is mentioned", "chosen by hand")
    unexplained_from: float = number(
        0.5, "probability", "a smooth function without a cause is reported", "more probable than not"
    )
    blurred: float = number(
        3.0,
        "times",
        "a cause whose size is that much less certain beside such a function is sized without it",
        "chosen by hand",
    )
    unsteady: float = number(
        1e-4,
        "p-value",
        "sizes that differ so much between parts of the table are not one size",
        "chosen by hand",
    )
    unsteady_beside_term: float = number(
        1e-2,
        "p-value",
        "the same, beside a smooth function without a cause",
        "tuned on the benchmark's unknown effects",
    )
    steadiness_runs: int = number(
        5, "runs", "of rows, besides the stations, that are compared", "as the folds"
    )
    steadiness_rows: int = number(2, "rows", "less levels, that a part needs", "a size and a variance")
    tension: float = number(
        3.0, "standard uncertainties", "between a size and theory's that a note tells", "chosen by hand"
    )
    agrees: float = number(2.0, "standard uncertainties", "within which a size is theory's", "convention")
    reported_from: float = number(
        0.5, "probability", "a noise or a fault is reported", "more probable than not"
    )
    listed_from: float = number(1e-6, "probability", "a set of causes is listed", "below one in a million")
