"""What a noise adds to placements or to single rows, which an effect would take up."""

from collections.abc import Collection
from dataclasses import replace

import numpy as np

from echocal.diagnose.findings.finding import Finding
from echocal.diagnose.inference.case import Case
from echocal.diagnose.inference.posterior import Inference
from echocal.diagnose.noises import registry
from echocal.diagnose.noises.common.findings import noise_findings
from echocal.diagnose.noises.common.kinds import FittedNoise, Offsets
from echocal.diagnose.noises.common.posterior import NoisePosterior, Traced
from echocal.diagnose.noises.common.without import without
from echocal.diagnose.settings.threshold import PROBABLE

__all__ = ["without_offsets", "without_rows_off"]

_ROUNDS = 2  # the second one beside the causes that are probable after the first


def without_offsets(case: Case, inference: Inference) -> tuple[Case, Inference, list[Finding]]:
    """Subtract the offsets of placements that a noise explains from the residuals."""
    findings = []
    for noise in registry.offsets():
        found = noise.find(case, inference)
        if found is not None and found.finding.probability >= PROBABLE:
            case, inference = found.case, found.inference
            findings.append(found.finding)
    return case, inference, findings


def without_rows_off(
    case: Case, inference: Inference, shares: NoisePosterior, tried: Collection[FittedNoise]
) -> tuple[Offsets, FittedNoise] | None:
    """Subtract what a noise with a mean adds to each row from the residuals: docs/method/noises.md, Eq. 18c.

    Parameters
    ----------
    case : Case
    inference : Inference
        Hypotheses on the residuals as they are.
    shares : NoisePosterior
        The noises beside them.
    tried : collection of FittedNoise
        Noises that compete.

    Returns
    -------
    tuple of Offsets and FittedNoise, or None
        None if no such noise is more probable than not, or if its error in each row is not known.
    """
    if case.table.members is not None:  # their means are without the periods that rows missed
        return None
    for noise in tried:
        probability = shares.probability(noise.facts.id)
        if noise.offsets is None or probability < PROBABLE:
            continue
        ids = (noise.facts.id,)
        (finding,) = noise_findings({ids: probability}, shares, inference.reduced, probability)
        rows, off = np.arange(len(case.table)), np.zeros(len(case.table))
        other, best = case, shares.fits[0]
        for _ in range(_ROUNDS):
            trace = Traced.of(other, rows).left_by(best, inference.reduced.likeliest(best)[0])
            found = noise.offsets(replace(trace, left=trace.left + off), case.settings.noises)
            if found is None:
                return None
            off = found
            other, inference = without(case, off, dict.fromkeys(noise.in_steps, trace.segment))
            best = inference.fits[0]
        return Offsets(finding, other, inference), noise
    return None
