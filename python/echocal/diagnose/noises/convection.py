"""Whether noise remembers more the farther the target is, as of warm cells that drift through the path."""

from collections.abc import Sequence

import numpy as np

from echocal.diagnose.inference.case import Case
from echocal.diagnose.inference.hypothesis import Stack, Weighed
from echocal.diagnose.inference.innovation import log_likelihood
from echocal.diagnose.inference.noise import CONVECTIONS, Convection, Noise

__all__ = ["convections"]

_REMEMBERS = 0.1  # probability of memory from which on its form matters
_BEHIND = 7.0  # log likelihood behind the likeliest memory, from which on a convection is none


def convections(case: Case, weighed: Sequence[Weighed], carried: Stack) -> list[Convection]:
    """Find the convections that may be the noise beside the best hypothesis, or beside the least.

    Parameters
    ----------
    case : Case
    weighed : sequence of Weighed
        Hypotheses under noise that remembers alike at all distances, most probable first.
    carried : Stack
        Its noises.

    Returns
    -------
    list of Convection
        Of `CONVECTIONS`; empty where all rows are at one distance or none remembers.
    """
    if not case.at_distances or _memory(weighed, carried) < _REMEMBERS:
        return []
    simplest = min(weighed, key=lambda one: len(one.hypothesis.variants))
    found: set[Convection] = set()
    for one in {id(one): one for one in (weighed[0], simplest)}.values():
        found |= _beside(case, one, carried.likeliest(one)[0])
    return [one for one in CONVECTIONS if one in found]


def _memory(weighed: Sequence[Weighed], carried: Stack) -> float:
    """Probability that noise remembers."""
    log = np.array([one.log_posterior for one in weighed])
    share = np.exp(log - log.max())
    remembers = np.array([noise.rho > 0.0 for noise in carried.noises])
    part = np.array([one.noise[remembers].sum() for one in weighed])
    return float(share @ part / share.sum())


def _beside(case: Case, one: Weighed, usual: Noise) -> set[Convection]:
    """Convections that are likely enough beside one hypothesis."""
    rows = np.flatnonzero(case.folds.fit[case.folds.blocks])
    left, order = case.left(one, rows), case.sums.order.at(rows)
    noises = (Noise(0.0, each.rho, usual.stand_ratio, 1.0, each.growth) for each in CONVECTIONS)
    logs = [log_likelihood(left, order, noise) for noise in noises]
    least = max(log_likelihood(left, order, usual), *logs) - _BEHIND
    return {each for each, log in zip(CONVECTIONS, logs, strict=True) if log > least}
