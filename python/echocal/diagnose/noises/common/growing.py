"""Noise that grows with the distance: far rows count less in the comparison of causes."""

from dataclasses import dataclass

import numpy as np

from echocal.diagnose.findings.finding import Finding
from echocal.diagnose.inference.case import Case
from echocal.diagnose.inference.noise import growing_noises
from echocal.diagnose.inference.posterior import Inference, infer
from echocal.diagnose.noises import registry
from echocal.diagnose.noises.common.findings import noise_findings
from echocal.diagnose.noises.common.posterior import NoisePosterior

__all__ = ["NOISE_GROWTH", "Growing", "with_growing_noise"]

NOISE_GROWTH = "noise_growth"


@dataclass(frozen=True)
class Growing:
    """Hypotheses beside noise that may grow with the distance.

    Attributes
    ----------
    case : Case
    inference : Inference
    finding : Finding or None
        None if other noise, as convection, explains the growth.
    """

    case: Case
    inference: Inference
    finding: Finding | None


def with_growing_noise(case: Case, inference: Inference, shares: NoisePosterior) -> Growing | None:
    """Compare the hypotheses once more, with noise that grows with the distance among the noise models.

    Under a common variance, the far rows count too much: a cause may only follow them. The probability of
    the noise is then that of these models, with its prior as a cause: docs/method.md, Eq. 26.

    Parameters
    ----------
    case : Case
    inference : Inference
        Hypotheses under the other noises.
    shares : NoisePosterior
        The noises beside them.

    Returns
    -------
    Growing or None
        None if such noise is not more probable than not.
    """
    settings = case.settings.noises
    if not case.at_distances or shares.probability(NOISE_GROWTH) < settings.subtracted:
        return None
    case = case.with_correlations(growing_noises(case.settings.noise_models))
    prior = sum(noise.prior for noise in case.noises if noise.growth and not noise.rho)
    inference = infer(case)
    log = np.array([fit.log_posterior for fit in inference.fits])
    weight = np.exp(log - log.max())
    own = np.array([bool(noise.growth) and not noise.rho for noise in inference.reduced.noises])
    share = float(weight @ np.array([fit.noise for fit in inference.fits])[:, own].sum(axis=1) / weight.sum())
    (facts,) = (noise.facts for noise in registry.fitted() if noise.facts.id == NOISE_GROWTH)
    before = settings.prior(facts)
    with_it, without = share / prior * before, (1.0 - share) / (1.0 - prior) * (1.0 - before)
    probability = with_it / (with_it + without)
    if probability < settings.subtracted:
        return Growing(case, inference, None)
    (finding,) = noise_findings({(NOISE_GROWTH,): probability}, shares, inference.reduced, probability)
    return Growing(case, inference, finding)
