"""Rows that a noise with a mean puts off, which an effect would take up."""

from collections.abc import Collection
from dataclasses import dataclass, replace

import numpy as np

from echocal.diagnose.findings.finding import Finding
from echocal.diagnose.inference.case import Case
from echocal.diagnose.inference.posterior import Inference
from echocal.diagnose.noises.common.findings import noise_findings
from echocal.diagnose.noises.common.kinds import FittedNoise
from echocal.diagnose.noises.common.posterior import NoisePosterior, Traced
from echocal.diagnose.noises.common.without import without
from echocal.diagnose.settings.threshold import PROBABLE

__all__ = ["RowsOff", "without_rows_off"]

_ROUNDS = 2  # the second one beside the causes that are probable after the first


@dataclass(frozen=True)
class RowsOff:
    """A noise whose expected errors of rows are subtracted, and the hypotheses on what is left."""

    finding: Finding
    case: Case
    inference: Inference
    noise: FittedNoise


def without_rows_off(
    case: Case, inference: Inference, shares: NoisePosterior, tried: Collection[FittedNoise]
) -> RowsOff | None:
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
    RowsOff or None
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
        return RowsOff(finding, other, inference, noise)
    return None
