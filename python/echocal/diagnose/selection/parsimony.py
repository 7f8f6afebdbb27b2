"""A cause counts as present only as far as the data can show it: docs/method.md, Eq. 20 to 22.

The prior of a size includes sizes that are too small for these data to show. With such a size, a
set explains the rows as well as the set without the cause. Its probability says nothing about the
data, and it would fill the credible set with negligible causes. Therefore the part of the prior at
which a cause stays below the noise, beside the other causes of its set, counts as its absence.
"""

from collections.abc import Iterator, Sequence
from math import erf, exp, sqrt

import numpy as np
from numpy.typing import NDArray

from echocal.diagnose.candidates.variant import UNKNOWN
from echocal.diagnose.inference.hypothesis import HypothesisFit
from echocal.diagnose.settings import PriorSettings
from echocal.diagnose.settings.priors import WIDTHS

__all__ = ["Ids", "probabilities"]

Ids = tuple[str, ...]

_VISIBLE = 1.0  # signal over noise, summed over rows, below which a cause does not show


def probabilities(
    fits: Sequence[HypothesisFit], causes: int, priors: PriorSettings
) -> tuple[NDArray[np.float64], dict[Ids, float]]:
    """Compute the probability of each hypothesis, and of each set of causes that are informative.

    Parameters
    ----------
    fits : sequence of HypothesisFit
        Most probable first.
    causes : int
        Number of causes that compete.
    priors : PriorSettings

    Returns
    -------
    ndarray
        Probability of each of `fits`; the sum is one.
    dict of tuple of str to float
        Probability of each set by its sorted ids, most probable first; the sum is one.
    """
    log = np.array([fit.log_posterior for fit in fits])
    share = np.exp(log - log.max())
    share /= share.sum()
    before: dict[Ids, float] = {}
    best: dict[Ids, HypothesisFit] = {}
    for fit, p in zip(fits, share.tolist(), strict=True):
        before[fit.hypothesis.ids] = before.get(fit.hypothesis.ids, 0.0) + p
        best.setdefault(fit.hypothesis.ids, fit)
    after = dict(before)
    for ids in sorted(before, key=len, reverse=True):
        known = len(best[ids].hypothesis.effects)
        moves = {}
        for cause, part in _uninformative(best[ids]):
            fewer = tuple(id_ for id_ in ids if id_ != cause)
            if fewer in before:
                odds = exp(priors.log_of_set(known, causes) - priors.log_of_set(known - 1, causes))
                moves[fewer] = part * odds * before[fewer]
        scale = min(before[ids] / max(sum(moves.values()), 1e-300), 1.0)
        for fewer, p in moves.items():
            after[ids] -= scale * p
            after[fewer] += scale * p
    total = sum(max(p, 0.0) for p in after.values())
    ordered = sorted(after.items(), key=lambda each: -each[1])
    return share, {ids: max(p, 0.0) / total for ids, p in ordered}


def _uninformative(fit: HypothesisFit) -> Iterator[tuple[str, float]]:
    """Each cause and the part of its prior at which it would not show beside the others: Eq. 21.

    A cause with a fixed column has no such part.
    """
    usual, variances = sum(width**2 for width in WIDTHS) / len(WIDTHS), fit.covariance.diagonal()
    for variant, place in fit.hypothesis.placed:
        if variant.cause != UNKNOWN and variant.offset is None and variant.free:
            signal = sqrt(max(1.0 / max(variances[place].min(), 1e-300) - 1.0 / usual, 0.0))
            limits = (_VISIBLE / max(signal * width, 1e-12) for width in WIDTHS)
            yield variant.cause, sum(erf(limit / sqrt(2.0)) for limit in limits) / len(WIDTHS)
