"""Noise that grows with the distance: far rows count less in the comparison of causes."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from echocal.diagnose.findings.finding import Finding
from echocal.diagnose.inference.case import Case
from echocal.diagnose.inference.noise import Noise, growing_noises
from echocal.diagnose.inference.posterior import Inference, infer
from echocal.diagnose.noises import registry
from echocal.diagnose.noises.common.findings import noise_findings
from echocal.diagnose.noises.common.posterior import NoisePosterior, Traced, sampled
from echocal.diagnose.settings.threshold import PROBABLE

__all__ = ["NOISE_GROWTH", "growth_of", "with_growing_noise"]

NOISE_GROWTH = "noise_growth"


def with_growing_noise(
    case: Case, inference: Inference, shares: NoisePosterior
) -> tuple[Case, Inference] | None:
    """Compare the hypotheses once more, with noise that grows with the distance among the noise models.

    Under a common variance, the far rows count too much: a cause may only follow them.

    Parameters
    ----------
    case : Case
    inference : Inference
        Hypotheses under the other noises.
    shares : NoisePosterior
        The noises beside them.

    Returns
    -------
    tuple of Case and Inference, or None
        None if such noise is not more probable than not.
    """
    if not case.at_distances or shares.probability(NOISE_GROWTH) < PROBABLE:
        return None
    if _without_memory(case.noises).any():
        return case, inference
    case = case.with_correlations(growing_noises(case.settings.noise_models))
    return case, infer(case)


def growth_of(case: Case, inference: Inference) -> Finding | None:
    """Find noise that grows with the distance by the probability of its models.

    docs/method/noises.md, Eq. 26.

    Parameters
    ----------
    case : Case
    inference : Inference
        Hypotheses under the noises of the case.

    Returns
    -------
    Finding or None
        None if such noise is not among the models, or not more probable than not.
    """
    settings, own = case.settings.noises, _without_memory(case.noises)
    noise = next((one for one in registry.fitted() if one.facts.id == NOISE_GROWTH), None)
    if noise is None or not own.any():
        return None
    probability = _probability(case, inference, settings.prior(noise.facts))
    if probability < PROBABLE:
        return None
    top, white = inference.fits[0], next(one for one in case.noises if not one.rho and not one.growth)
    fitted = noise.fit(Traced.of(case, sampled(case.row_folds, settings)).left_by(top, white), settings)
    if fitted is None:
        return None
    found = NoisePosterior(inference.fits, likelihoods={(): {NOISE_GROWTH: fitted}})
    (finding,) = noise_findings({(NOISE_GROWTH,): probability}, found, inference.reduced, probability)
    return finding


def _without_memory(noises: Sequence[Noise]) -> NDArray[np.bool_]:
    return np.array([bool(noise.growth) and not noise.rho for noise in noises])


def _probability(case: Case, inference: Inference, prior: float) -> float:
    """Give the probability of such noise: that of its models, with the prior of the cause."""
    log = np.array([fit.log_posterior for fit in inference.fits])
    weight = np.exp(log - log.max())
    own = _without_memory(inference.reduced.noises)
    share = float(weight @ np.array([fit.noise for fit in inference.fits])[:, own].sum(axis=1) / weight.sum())
    assumed = float(np.array([noise.prior for noise in case.noises])[_without_memory(case.noises)].sum())
    with_it, without = share / assumed * prior, (1.0 - share) / (1.0 - assumed) * (1.0 - prior)
    return with_it / (with_it + without)
