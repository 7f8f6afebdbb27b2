"""Noises of the posterior as findings: parameters, and a sentence that a person can check."""

from collections.abc import Collection, Mapping

import numpy as np

from echocal.diagnose.findings.finding import Finding
from echocal.diagnose.findings.parts import Parameter
from echocal.diagnose.inference.hypothesis import Stack
from echocal.diagnose.noises import registry
from echocal.diagnose.noises.common.kinds import NoiseEntry, NuisanceNoise
from echocal.diagnose.noises.common.posterior import NoisePosterior

__all__ = ["noise_findings"]


def noise_findings(
    sets: Mapping[tuple[str, ...], float],
    shares: NoisePosterior,
    reduced: Stack,
    least: float,
    known: Collection[str] = (),
) -> list[Finding]:
    """Findings on the fitted and the nuisance noises.

    Parameters
    ----------
    sets : mapping of tuple of str to float
        Posterior probability of each set of causes.
    shares : NoisePosterior
    reduced : Stack
        Products under the noise models that some hypothesis makes probable.
    least : float
        Probability from which on a noise is reported.
    known : collection of str
        Noises that are found already.
    """
    findings = []
    noises: tuple[NoiseEntry, ...] = (*registry.fitted(), *registry.nuisances())
    for noise in noises:
        probability = sum(p for ids, p in sets.items() if noise.facts.id in ids)
        if probability >= least and noise.facts.id not in known:
            findings.append(_finding(noise, probability, shares, reduced))
    return findings


def _finding(noise: NoiseEntry, probability: float, shares: NoisePosterior, reduced: Stack) -> Finding:
    facts, share = noise.facts, 1.0
    rivals: tuple[str, ...] = ()
    if isinstance(noise, NuisanceNoise):
        top = shares.fits[0]
        values = noise.parameters(reduced.noises, top.noise, top.variance)
        rivals, note = noise.rivals(values, reduced.degrees)
        because = noise.because(values) + note
    else:
        fit = shares.fit_of(facts.id)
        assert fit is not None, f"{facts.id} is probable and was fitted beside no set"
        values, because, share = fit.parameters, fit.because, float(fit.matters)
    units = {quantity.name: quantity.unit for quantity in facts.parameters}
    parameters = tuple(Parameter(name, v, u, units[name]) for name, (v, u) in values.items())
    odds = np.log(probability) - np.log(max(1 - probability, 1e-15))
    log_bayes = float(odds - np.log(facts.prior) + np.log1p(-facts.prior))
    return Finding(facts, log_bayes, because, parameters, share=share, rivals=rivals)
