"""What is thought probable before the data."""

from dataclasses import dataclass

from echocal.diagnose.settings.threshold import number

__all__ = ["PriorSettings", "TermSettings"]


@dataclass(frozen=True, kw_only=True)
class PriorSettings:
    """Priors over sets of causes and over laws; the size of each cause has its own, in its facts."""

    no_cause: float = number(0.44, "probability", "no cause", "chosen by hand")
    one_cause: float = number(
        0.45, "probability", "one cause, shared evenly by all that compete", "chosen by hand"
    )
    two_causes: float = number(
        0.1, "probability", "two causes, shared evenly by all pairs", "tuned while looking at one real record"
    )
    three_causes: float = number(
        0.01, "probability", "three causes; each further one is as rare beside the last", "chosen by hand"
    )
    unexplained_term: float = number(
        0.05,
        "probability",
        "a smooth function without a cause, beside any set of causes",
        "tuned; the last resort",
    )
    tail_weight: float = number(
        0.1, "1", "weight of a size's wide prior beside its usual one", "chosen by hand"
    )
    law_uncertainty: float = number(
        300e-6 / 3**0.5,
        "of the reading",
        "standard deviation of the level and of the tilt of a law",
        "Cramer 1993 states limits of 300 ppm; GUM 4.3.7 makes limits a standard deviation",
    )
    law_middle: float = number(
        15.0,
        "degC",
        "temperature at which a law's tilt is zero; the tilt is one standard deviation at 0 and 30 degC",
        "middle of the range of Cramer's limits",
    )
    usual_multiple: float = number(
        3.0,
        "prior sd",
        "a cause that does not show at so many times its usual size does not compete",
        "the widest of the three prior widths",
    )
    fewest_snr: float = number(0.5, "snr sqrt(n)", "below it a cause does not show", "chosen by hand")

    @property
    def counts(self) -> list[float]:
        """Of no to three causes."""
        return [self.no_cause, self.one_cause, self.two_causes, self.three_causes]


@dataclass(frozen=True, kw_only=True)
class TermSettings:
    """Smooth functions without a cause that compete with the causes."""

    size: float = number(
        3e-3,
        "m",
        "prior standard deviation of the constant, of degree 1, of the first harmonic; degree k has a k-th",
        "twice the shot noise of an HC-SR04 of 1.5 mm; the k-th part is chosen by hand",
    )
    degrees: tuple[int, ...] = number(
        (4, 16),
        "1",
        "degrees of the polynomials against a column",
        "tuned on the benchmark's unknown effects",
    )
    values_per_degree: int = number(
        2,
        "distinct values",
        "a degree needs so many: freer, a term would be an error of each value",
        "argument",
    )
    fewest_values: int = number(6, "distinct values", "fewer show no smooth function", "chosen by hand")
    harmonics: int = number(2, "1", "multiples of the day", "chosen by hand")
    fewest_days: float = number(
        2.0, "d", "the hour of the day is tried where a table spans more", "chosen by hand"
    )
    range: tuple[float, float] = number(
        (0.005, 0.995), "quantiles", "values of a column that a term is made for", "chosen by hand"
    )
