"""Evidence: how probable the data are under each hypothesis, all sizes of its causes averaged."""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import product
from typing import Any

import numpy as np
from numpy.typing import NDArray

from echocal.diagnose.candidates import Variant
from echocal.diagnose.noise import FINEST, Noise, Whitened

__all__ = ["Hypothesis", "Stack", "Weighed", "weigh"]

Matrix = NDArray[np.floating[Any]]

_SIZES = (1 / 3, 1.0, 3.0)  # mixture of prior scales: nobody knows a magnitude well


_ROUNDING = 1e-12  # part of a sum of squares that arithmetic leaves behind
_FAR = 15.0  # prior standard deviations; bounds beyond are as good as none


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

    @property
    def causes(self) -> tuple[str, ...]:
        """Ids of its causes."""
        return tuple(variant.cause for variant in self.variants)

    @property
    def shape(self) -> str:
        """Column that a shape without a cause is a function of; empty if it has none."""
        return next((v.against for v in self.variants if v.against), "")

    @property
    def offsets(self) -> list[int]:
        """Columns with coefficient one."""
        return [v.offset for v in self.variants if v.offset is not None]

    @property
    def free(self) -> list[int]:
        """Columns whose coefficient is found."""
        return [i for v in self.variants for i in v.free]


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

    products: Matrix
    log_weight: Matrix
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

    def only(self, noises: NDArray[np.bool_]) -> "Stack":
        """Keep some noises."""
        kept = tuple(noise for noise, keep in zip(self.noises, noises, strict=True) if keep)
        return Stack(self.products[noises], self.log_weight[noises], self.degrees, kept)

    def likeliest(self, weighed: "Weighed") -> tuple[Noise, Matrix]:
        """The most probable noise under a hypothesis, and its products."""
        index = int(weighed.noise.argmax())
        return self.noises[index], self.products[index]

    def plain(self) -> "Stack":
        """The first noise alone: rows that owe each other nothing."""
        return self.only(np.arange(len(self.noises)) == 0)

    def rest(self, offsets: Sequence[int], free: Sequence[int]) -> tuple[Matrix, Matrix, Matrix]:
        """Products of what is left after the fixed columns: with itself, with free columns, of these."""
        combination = np.zeros(self.products.shape[-1])
        combination[-1] = 1.0
        np.subtract.at(combination, list(offsets), 1.0)
        along = self.products @ combination
        chosen = list(free)
        return along @ combination, along[:, chosen], self.products[:, chosen][:, :, chosen]


@dataclass(frozen=True)
class Weighed:
    """A hypothesis after the data.

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

    @property
    def log_posterior(self) -> float:
        """Up to the constant that normalizes."""
        return self.log_evidence + float(np.log(self.hypothesis.prior))


def weigh(hypothesis: Hypothesis, stack: Stack, *, one_size: bool = False) -> Weighed:
    """Average the likelihood over noises, sizes and the unknown variance of the noise.

    The coefficients have normal priors, in a mixture of three widths, cut off at their bounds;
    the variance has Jeffreys's prior, and within the coefficients' prior it stands at its
    estimate (a Laplace approximation).

    Parameters
    ----------
    hypothesis : Hypothesis
    stack : Stack
    one_size : bool
        Take the widest prior alone, for a quick look.

    Returns
    -------
    Weighed

    References
    ----------
    .. [1] MacKay, D. J. C. (1992). Bayesian interpolation. Neural Computation 4, 415-447.
       https://doi.org/10.1162/neco.1992.4.3.415
    """
    square, along, among = stack.rest(hypothesis.offsets, hypothesis.free)
    finest = stack.degrees * FINEST**2
    square = np.maximum(square, finest)
    half = 0.5 * stack.degrees
    if not hypothesis.free:
        score = stack.log_weight - half * np.log(square)
        noise = np.exp(score - np.logaddexp.reduce(score, axis=None))
        empty = np.empty(0)
        variance = float(noise @ square / stack.degrees)
        return Weighed(
            hypothesis, float(np.logaddexp.reduce(score, axis=None)), empty, np.empty((0, 0)), noise, variance
        )
    least = _least_squares(square, along, among) / stack.degrees
    widths = _widths(hypothesis, _SIZES[-1:] if one_size else _SIZES)  # (c, p)
    lengths = np.einsum("hpp->hp", among)
    # data without noise would make any prior too wide for the arithmetic
    precision = np.maximum(least[:, None, None] / widths**2, _ROUNDING * lengths[:, None, :])
    system = among[:, None] + np.eye(len(hypothesis.free)) * precision[..., None, :]
    inverse = np.linalg.inv(system)
    mean = np.einsum("hcpq,hq->hcp", inverse, along)
    left = square[:, None] - np.einsum("hcp,hp->hc", mean, along)
    left = np.maximum(left, np.maximum(_ROUNDING * square, finest)[:, None])  # data without noise
    log_det = np.linalg.slogdet(system)[1] - np.log(precision).sum(axis=-1)
    variance = left / stack.degrees
    covariance = variance[..., None, None] * inverse
    score = stack.log_weight[:, None] - half * np.log(left) - 0.5 * log_det - np.log(len(widths))
    score = score + _within_bounds(hypothesis, mean, covariance, widths)
    return _summarize(hypothesis, score, mean, covariance, variance)


def _least_squares(square: Matrix, along: Matrix, among: Matrix) -> Matrix:
    """Sum of squares that the best coefficients leave, never less than rounding allows."""
    ridge = 1e-12 * np.eye(along.shape[1]) * np.trace(among, axis1=1, axis2=2)[:, None, None]
    best = np.linalg.solve(among + ridge + 1e-300, along[..., None])[..., 0]
    left: Matrix = np.maximum(square - np.einsum("hp,hp->h", best, along), _ROUNDING * square)
    return left


def _widths(hypothesis: Hypothesis, sizes: tuple[float, ...]) -> Matrix:
    """Prior standard deviations: every combination of sizes, one size per cause."""
    per_cause = [len(v.free) for v in hypothesis.variants if v.free]
    return np.array([np.repeat(s, per_cause) for s in product(sizes, repeat=len(per_cause))])


def _within_bounds(
    hypothesis: Hypothesis, mean: Matrix, covariance: Matrix, widths: Matrix
) -> Matrix | float:
    """Log of posterior over prior mass within the bounds, coefficient by coefficient."""
    bounds = np.array([b for v in hypothesis.variants for b in v.bounds])
    if np.abs(bounds).min() > _FAR:
        return 0.0
    from scipy.special import ndtr  # takes long to import

    # rounding may leave a variance below zero where columns are nearly the same
    sd = np.sqrt(np.maximum(np.einsum("hcpp->hcp", covariance), np.finfo(float).tiny))
    low, high = bounds.T
    inside = ndtr((high - mean) / sd) - ndtr((low - mean) / sd)
    before = ndtr(high / widths) - ndtr(low / widths)
    floor = np.finfo(float).tiny
    ratio: Matrix = np.log(np.maximum(inside, floor)) - np.log(before)
    total: Matrix = ratio.sum(axis=-1)
    return total


def _summarize(
    hypothesis: Hypothesis, score: Matrix, mean: Matrix, covariance: Matrix, variance: Matrix
) -> Weighed:
    """Average over noises and widths."""
    total = float(np.logaddexp.reduce(score, axis=None))
    share = np.exp(score - total)
    center = np.einsum("hc,hcp->p", share, mean)
    spread = mean - center
    second = np.einsum("hc,hcpq->pq", share, covariance + spread[..., :, None] * spread[..., None, :])
    return Weighed(hypothesis, total, center, second, share.sum(axis=1), float((share * variance).sum()))
