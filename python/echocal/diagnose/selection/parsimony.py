"""A cause counts as present only as far as the data can show it.

The prior of a size includes sizes that are too small for these data to show. With such a size, a
set explains the rows as well as the set without the cause. Its probability says nothing about the
data, and it would fill the credible set with negligible causes. Therefore the part of the prior at
which a cause stays below the noise, beside the other causes of its set, counts as its absence.
"""

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from echocal.diagnose.candidates.variant import UNKNOWN
from echocal.diagnose.inference.hypothesis import HypothesisFit
from echocal.diagnose.inference.posterior import set_prior
from echocal.diagnose.settings import PriorSettings

__all__ = ["Ids", "shown"]

Ids = tuple[str, ...]

_WIDTHS = (1 / 3, 1.0, 3.0)  # of the prior, in a mixture: rust/infer/src/solve/prior_widths.rs
_USUAL = sum(width**2 for width in _WIDTHS) / len(_WIDTHS)  # variance of the mixture
_VISIBLE = 1.0  # signal over noise, summed over rows


def shown(
    fits: Sequence[HypothesisFit], probability: NDArray[np.float64], causes: int, priors: PriorSettings
) -> dict[Ids, float]:
    """Probability of each set of causes that show.

    Parameters
    ----------
    fits : sequence of HypothesisFit
        Most probable first.
    probability : ndarray
        Of each of `fits`; sums to one.
    causes : int
        Number of causes that compete.
    priors : PriorSettings

    Returns
    -------
    dict of tuple of str to float
        By sorted ids, most probable first; sums to one.
    """
    best: dict[Ids, HypothesisFit] = {}
    sets: dict[Ids, float] = {}
    for one, p in zip(fits, probability, strict=True):
        ids = one.hypothesis.ids
        best.setdefault(ids, one)
        sets[ids] = sets.get(ids, 0.0) + float(p)
    before = dict(sets)
    for ids in sorted(sets, key=len, reverse=True):
        moved = {}
        for cause, part in hidden(best[ids]).items():
            fewer = tuple(id_ for id_ in ids if id_ != cause)
            if fewer in before:
                odds = set_prior(ids, causes, priors) / set_prior(fewer, causes, priors)
                moved[fewer] = part * odds * before[fewer]
        scale = min(1.0, before[ids] / max(sum(moved.values()), 1e-300))
        for fewer, p in moved.items():
            sets[ids] -= scale * p
            sets[fewer] += scale * p
    total = sum(max(p, 0.0) for p in sets.values())
    ordered = sorted(((ids, max(p, 0.0) / total) for ids, p in sets.items()), key=lambda item: -item[1])
    return dict(ordered)


def hidden(fit: HypothesisFit) -> dict[str, float]:
    """Part of the prior of each cause at which it does not show beside the others of its set."""
    parts: dict[str, float] = {}
    variance = fit.covariance.diagonal().tolist()
    for variant, place in fit.hypothesis.placed:
        if variant.cause != UNKNOWN and variant.offset is None and variant.free:
            information = 1 / max(min(variance[place]), 1e-300) - 1 / _USUAL
            signal = math.sqrt(max(information, 0.0))  # of one prior standard deviation
            reach = (_VISIBLE / max(signal * width, 1e-12) for width in _WIDTHS)
            parts[variant.cause] = sum(math.erf(limit / math.sqrt(2)) for limit in reach) / len(_WIDTHS)
    return parts
