"""Whether noise grows with the distance, as warm cells that drift through the path make it."""

from collections.abc import Sequence

import numpy as np

from echocal.diagnose.inference.case import Case
from echocal.diagnose.inference.hypothesis import HypothesisFit, Stack
from echocal.diagnose.inference.innovation import log_likelihood
from echocal.diagnose.inference.noise import Convection, Noise, all_convections, growing_noises

__all__ = ["convections"]


def convections(case: Case, fits: Sequence[HypothesisFit], reduced: Stack) -> list[Convection]:
    """Find the convections that may be the noise beside the best hypothesis, or beside the least.

    Noise that grows with the distance but has no memory is among them: else convection would explain its
    growth.

    Parameters
    ----------
    case : Case
    fits : sequence of HypothesisFit
        Hypotheses under noise with the same autocorrelation at all distances, most probable first.
    reduced : Stack
        Products under this noise.

    Returns
    -------
    list of Convection
        Empty where all rows are at one distance or the noise is white.
    """
    settings = case.settings.noises
    if not case.at_distances or _autocorrelated(fits, reduced) < settings.autocorrelated:
        return []
    simplest = min(fits, key=lambda one: len(one.hypothesis.variants))
    found: set[Convection] = set()
    for one in {id(one): one for one in (fits[0], simplest)}.values():
        found |= _beside(case, one, reduced.likeliest(one)[0], settings.negligible_odds)
    return [one for one in _every(case) if one in found]


def _every(case: Case) -> tuple[Convection, ...]:
    settings = case.settings.noise_models
    return (*all_convections(settings), *growing_noises(settings))


def _autocorrelated(fits: Sequence[HypothesisFit], reduced: Stack) -> float:
    """Probability that the noise is autocorrelated."""
    log = np.array([one.log_posterior for one in fits])
    share = np.exp(log - log.max())
    correlated = np.array([noise.rho > 0.0 for noise in reduced.noises])
    part = np.array([one.noise[correlated].sum() for one in fits])
    return float(share @ part / share.sum())


def _beside(case: Case, one: HypothesisFit, usual: Noise, behind: float) -> set[Convection]:
    """Convections that are likely enough beside one hypothesis."""
    rows = np.flatnonzero(case.folds.fit[case.folds.blocks])
    left, order = case.left(one, rows), case.sums.order.at(rows)
    every = _every(case)
    noises = (Noise(0.0, each.rho, usual.station_ratio, 1.0, *each[1:]) for each in every)
    logs = [log_likelihood(left, order, noise) for noise in noises]
    least = max(log_likelihood(left, order, usual), *logs) - behind
    return {each for each, log in zip(every, logs, strict=True) if log > least}
