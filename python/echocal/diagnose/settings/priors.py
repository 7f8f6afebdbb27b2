"""Prior probabilities."""

import math
from dataclasses import dataclass

from echocal.diagnose.settings.threshold import threshold

__all__ = ["WIDEST", "WIDTHS", "PriorSettings", "TermSettings"]

WIDTHS = (1 / 3, 1.0, 3.0)
"""Widths of the prior of a size [prior standard deviations], as in `rust/infer`: docs/method.md, Eq. 6."""

WIDEST = WIDTHS[-1]
"""The widest of them."""


@dataclass(frozen=True, kw_only=True)
class PriorSettings:
    """Priors of sets of causes and of laws. The prior of a size is in the facts of its cause."""

    no_cause: float = threshold(0.44, "probability", "no cause; chosen by hand")
    one_cause: float = threshold(
        0.45, "probability", "one cause, divided evenly among all causes that compete; chosen by hand"
    )
    two_causes: float = threshold(
        0.1, "probability", "two causes, divided evenly among all pairs; tuned on one real record"
    )
    three_causes: float = threshold(
        0.01,
        "probability",
        "three causes; for each further cause, the prior falls by the same factor; chosen by hand",
    )
    unexplained_term: float = threshold(
        0.05,
        "probability",
        "an unexplained term beside any set of causes; tuned; small, because a cause is preferred",
    )
    tail_weight: float = threshold(
        0.1,
        "1",
        "weight of the wide prior of a size beside 1 for its usual prior; both are then divided by their "
        "sum; chosen by hand",
    )
    air_unknown: float = threshold(
        0.003,
        "of the speed",
        "standard deviation of the speed of sound where the temperature is the same in all rows; argument: "
        "1 K is 0.17 %, a humidity that nobody recorded up to 0.6 % at 30 degC",
    )
    law_uncertainty: float = threshold(
        300e-6 / 3**0.5,
        "of the reading",
        "standard uncertainty of the level and of the tilt of a law; Cramer 1993 states limits of 300 ppm; "
        "GUM 4.3.7 makes limits a standard deviation",
    )
    scale_uncertainty: float = threshold(
        4.3e-4,
        "of the reading",
        "standard uncertainty of all distances together, which is part of that of a size: the law 300 ppm, "
        "its dispersion at 40 kHz 250 ppm, a tape of class II 200 ppm, 2 degrees between beam and tape 610 "
        "ppm; GUM 4.3.7 makes each limit a standard deviation",
    )
    arrival_uncertainty: float = threshold(
        12.5e-6 / 3**0.5,
        "s",
        "the same of the moment of arrival: within half a period of 40 kHz it depends on how it is defined; "
        "GUM 4.3.7",
    )
    law_middle: float = threshold(
        15.0,
        "degC",
        "temperature at which a law's tilt is zero; the tilt is one standard deviation at 0 and 30 degC; "
        "middle of the range of Cramer's limits",
    )
    usual_multiple: float = threshold(
        WIDEST,
        "prior sd",
        "a cause that does not show at so many prior standard deviations does not compete; the widest of "
        "the three prior widths",
    )
    fewest_snr: float = threshold(
        0.5, "snr sqrt(n)", "with a smaller signal-to-noise ratio, a cause does not show; chosen by hand"
    )

    @property
    def counts(self) -> list[float]:
        """Priors of zero, one, two and three causes."""
        return [self.no_cause, self.one_cause, self.two_causes, self.three_causes]

    def of_counts(self, most: int) -> list[float]:
        """Priors of zero to so many causes; each after the third is as rare as the third after the second."""
        rarer = self.three_causes / self.two_causes
        return [*self.counts, *(self.three_causes * rarer**n for n in range(1, most - 2))][: most + 1]

    def log_of_set(self, count: int, competing: int) -> float:
        """Log prior of one set of so many causes: docs/method.md, Eq. 7 and 8, without forms and terms."""
        if count > competing:
            return -math.inf
        return math.log(self.of_counts(count)[count]) - math.log(math.comb(competing, count))

    def log_of_presence(self, count: int, competing: int) -> float:
        """Log prior that so many causes are among those of a table, whatever else is."""
        sets = (p * math.comb(j, count) for j, p in enumerate(self.of_counts(competing)))
        return math.log(sum(sets)) - math.log(math.comb(competing, count))


@dataclass(frozen=True, kw_only=True)
class TermSettings:
    """Unexplained terms: smooth functions without a cause that compete with the causes."""

    size: float = threshold(
        3e-3,
        "m",
        "prior standard deviation of the constant, of degree 1 and of the first harmonic; divided by k for "
        "degree or harmonic k; twice the noise of an HC-SR04, 1.5 mm; the division by k is chosen by hand",
    )
    degrees: tuple[int, ...] = threshold(
        (4, 16), "1", "degrees of the polynomials against a column; tuned on the benchmark's unknown effects"
    )
    range: tuple[float, float] = threshold(
        (0.005, 0.995), "quantiles", "range of a column for which a term is made; chosen by hand"
    )
