"""Evidence: how probable the data are under a hypothesis, all sizes of its causes averaged."""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import accumulate, pairwise
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from echocal import _core
from echocal.diagnose.candidates.variant import UNKNOWN, Variant
from echocal.diagnose.inference.noise import VARIANCE_FLOOR, Noise
from echocal.diagnose.inference.sums import Whitened

__all__ = ["Hypothesis", "HypothesisFit", "Stack", "fit_hypotheses", "fit_hypothesis"]

Matrix = NDArray[np.floating[Any]]


@dataclass(frozen=True)
class Hypothesis:
    """Causes that act together, one variant of each.

    Attributes
    ----------
    variants : tuple of Variant
        Empty: nothing is wrong.
    prior : float
        Probability before the data.
    """

    variants: tuple[Variant, ...]
    prior: float

    @cached_property
    def log_prior(self) -> float:
        """Logarithm of the probability before the data."""
        return math.log(self.prior) if self.prior > 0.0 else -math.inf

    @cached_property
    def causes(self) -> tuple[str, ...]:
        """Ids of its causes."""
        return tuple(variant.cause for variant in self.variants)

    @cached_property
    def ids(self) -> tuple[str, ...]:
        """The same, sorted: hypotheses with other forms of these causes have them, too."""
        return tuple(sorted(self.causes))

    @cached_property
    def effects(self) -> tuple[str, ...]:
        """Ids of its effects, sorted: of its causes, without an unexplained term."""
        return tuple(id_ for id_ in self.ids if id_ != UNKNOWN)

    @cached_property
    def columns(self) -> tuple[int, ...]:
        """Every column that it uses."""
        return tuple(column for variant in self.variants for column in variant.columns)

    @cached_property
    def key(self) -> tuple[tuple[object, ...], ...]:
        """What a fit depends on: the columns and the bounds of each variant."""
        return tuple((variant.offset, variant.free, variant.bounds) for variant in self.variants)

    @cached_property
    def placed(self) -> tuple[tuple[Variant, slice], ...]:
        """Each variant, and the positions of its coefficients among those of the hypothesis."""
        ends = list(accumulate((len(variant.free) for variant in self.variants), initial=0))
        places = (slice(first, last) for first, last in pairwise(ends))
        return tuple(zip(self.variants, places, strict=True))

    @cached_property
    def term(self) -> str:
        """Column that its unexplained term is a function of; empty if it has none."""
        return next((v.against for v in self.variants if v.against), "")


@dataclass(frozen=True)
class Stack:
    """The whitened products of every noise, one above the other.

    Attributes
    ----------
    products : ndarray, shape (noises, k, k)
        The last column is what the base simulation leaves unexplained.
    log_weight : ndarray, shape (noises,)
    degrees : int
        Rows less unknown levels.
    noises : tuple of Noise
    """

    products: NDArray[np.float64]
    log_weight: NDArray[np.float64]
    degrees: int
    noises: tuple[Noise, ...]

    @classmethod
    def of(cls, whitened: Sequence[Whitened], degrees: int) -> "Stack":
        """Stack the noises."""
        return cls(
            np.stack([w.products for w in whitened]),
            np.array([w.log_weight for w in whitened]),
            degrees,
            tuple(w.noise for w in whitened),
        )

    def each(self) -> Iterator["Stack"]:
        """Each noise by itself."""
        for at, noise in enumerate(self.noises):
            own = slice(at, at + 1)
            yield Stack(self.products[own], self.log_weight[own], self.degrees, (noise,))

    def only(self, noises: NDArray[np.bool_]) -> "Stack":
        """Keep some noises."""
        if noises.all():
            return self
        kept = tuple(noise for noise, keep in zip(self.noises, noises, strict=True) if keep)
        return Stack(self.products[noises], self.log_weight[noises], self.degrees, kept)

    def likeliest(self, fit: "HypothesisFit") -> tuple[Noise, Matrix]:
        """The most probable noise under a hypothesis, and its products."""
        index = int(fit.noise.argmax())
        return self.noises[index], self.products[index]


class HypothesisFit(NamedTuple):
    """A hypothesis after the data: docs/method.md, Eq. 16 and 17.

    A named tuple, because a search makes thousands of them.

    Attributes
    ----------
    hypothesis : Hypothesis
    log_evidence : float
        Without the hypothesis's prior, with an arbitrary constant common to all.
    mean : ndarray, shape (p,)
        Coefficients of the free columns, in prior standard deviations.
    covariance : ndarray, shape (p, p)
    noise : ndarray, shape (noises,)
        Probability of each noise under this hypothesis.
    variance : float
        Variance of the innovations [m^2].
    """

    hypothesis: Hypothesis
    log_evidence: float
    mean: Matrix
    covariance: Matrix
    noise: Matrix
    variance: float

    @classmethod
    def of(cls, hypothesis: Hypothesis, fit: _core.HypothesisFit) -> "HypothesisFit":
        """What the core found out about a hypothesis."""
        return cls(hypothesis, fit.log_evidence, fit.mean, fit.covariance, fit.noise, fit.variance)

    def raised(self, by: float) -> "HypothesisFit":
        """The same with more log evidence."""
        return HypothesisFit(
            self.hypothesis, self.log_evidence + by, self.mean, self.covariance, self.noise, self.variance
        )

    @property
    def log_posterior(self) -> float:
        """Up to the constant that normalizes: docs/method.md, Eq. 18."""
        return self.log_evidence + self.hypothesis.log_prior


def fit_hypothesis(hypothesis: Hypothesis, stack: Stack, *, one_width: bool = False) -> HypothesisFit:
    """Average the likelihood over noises, sizes and the unknown variance of the noise.

    The coefficients have normal priors, in a mixture of three widths, cut off at their bounds;
    the variance has Jeffreys's prior. The coefficients' prior is scaled by the variance over its
    least-squares estimate; with that both integrals are exact, but for the cut at bounds
    (docs/method.md, Eq. 11 to 16).

    Parameters
    ----------
    hypothesis : Hypothesis
    stack : Stack
    one_width : bool
        Take the widest prior alone: of many causes at once, where a mixture would take long.

    Returns
    -------
    HypothesisFit

    References
    ----------
    .. [1] MacKay, D. J. C. (1992). Bayesian interpolation. Neural Computation 4, 415-447.
       https://doi.org/10.1162/neco.1992.4.3.415
    """
    return fit_hypotheses([hypothesis], stack, one_width=one_width)[0]


def fit_hypotheses(
    hypotheses: Sequence[Hypothesis], stack: Stack, *, one_width: bool = False
) -> list[HypothesisFit]:
    """Fit several hypotheses, each by itself, on several threads."""
    forms = [[variant.form for variant in hypothesis.variants] for hypothesis in hypotheses]
    given = stack.products, stack.log_weight, stack.degrees, VARIANCE_FLOOR**2
    found = _core.fit_hypotheses(*given, forms, one_width)
    return [HypothesisFit.of(hypothesis, fit) for hypothesis, fit in zip(hypotheses, found, strict=True)]
