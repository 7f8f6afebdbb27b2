"""The search for the steps of readings, echo times and temperatures."""

from collections.abc import Iterator
from dataclasses import replace

from echocal.diagnose.findings.finding import Finding
from echocal.diagnose.noises import registry
from echocal.diagnose.preprocess.view import View
from echocal.diagnose.settings.noises import NoiseSettings
from echocal.diagnose.settings.threshold import PROBABLE

__all__ = ["find_steps"]


def find_steps(view: View, settings: NoiseSettings) -> tuple[list[Finding], list[str], View]:
    """Find the steps of readings, echo times and temperatures.

    Returns
    -------
    list of Finding
        Steps that matter beside the noise.
    list of str
        A note on each step that does not.
    View
        The table with readings that were cut off in the middle of their steps.
    """
    settings.refuse_others([noise.facts.id for noise in registry.NOISES], "noise")
    found, harmless = [], []
    for finding in _candidates(view, settings):
        if finding.share < settings.harmless or finding.rms < settings.negligible:
            harmless.append(f"{finding.because}: harmless")
            continue
        found.append(finding)
        if finding.repaired is not None:
            view = view.after(finding.repaired)
    return found, harmless, view


def _candidates(view: View, settings: NoiseSettings) -> Iterator[Finding]:
    for noise in registry.quantizations():
        finding = noise.detect(view, settings)
        if finding is None:
            continue
        finding = replace(finding, facts=settings.facts(finding.facts))
        if finding.probability > PROBABLE:
            yield finding
