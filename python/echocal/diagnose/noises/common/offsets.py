"""Offsets of placements, which are found before causes are compared."""

from echocal.diagnose.findings.finding import Finding
from echocal.diagnose.inference.case import Case
from echocal.diagnose.inference.posterior import Inference
from echocal.diagnose.noises import registry
from echocal.diagnose.settings.threshold import PROBABLE

__all__ = ["without_offsets"]


def without_offsets(case: Case, inference: Inference) -> tuple[Case, Inference, list[Finding]]:
    """Subtract the offsets of placements that a noise explains from the residuals.

    Parameters
    ----------
    case : Case
    inference : Inference
        Hypotheses on the residuals as they are.
    """
    findings = []
    for noise in registry.offsets():
        found = noise.find(case, inference)
        if found is not None and found.finding.probability >= PROBABLE:
            case, inference = found.case, found.inference
            findings.append(found.finding)
    return case, inference, findings
