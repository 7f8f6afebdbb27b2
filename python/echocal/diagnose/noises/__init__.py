"""Noises: causes that change the distribution of readings.

One file a noise. Steps are read off the columns themselves, before anything is weighed.
"""

from collections.abc import Iterator

from echocal.diagnose.findings.facts import CauseFacts
from echocal.diagnose.findings.finding import Finding
from echocal.diagnose.noises import (
    correlated_noise,
    cycle_slip,
    noise_growth,
    polling_jitter,
    reading_quantization,
    reference_error,
    temperature_quantization,
    timer_quantization,
)
from echocal.diagnose.preprocess.quantization_grid import HARMLESS, NEGLIGIBLE
from echocal.diagnose.preprocess.view import View

__all__ = ["find_steps", "noises"]

_STEPS = (reading_quantization, timer_quantization, temperature_quantization)


def noises() -> tuple[CauseFacts, ...]:
    """Return what is known about causes that change the distribution of readings.

    Examples
    --------
    >>> import echocal
    >>> "timer_quantization" in [noise.id for noise in echocal.noises()]
    True
    """
    others = (cycle_slip, noise_growth, polling_jitter, correlated_noise, reference_error)
    return tuple(module.FACTS for module in (*_STEPS, *others))


def find_steps(view: View) -> tuple[list[Finding], list[str], View]:
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
    found, harmless = [], []
    for finding in _looked_for(view):
        if finding.share < HARMLESS or finding.rms < NEGLIGIBLE:
            harmless.append(f"{finding.because}: harmless")
            continue
        found.append(finding)
        if finding.repaired is not None:
            view = view.after(finding.repaired)
    return found, harmless, view


def _looked_for(view: View) -> Iterator[Finding]:
    for module in _STEPS:
        finding = module.detect(view)
        if finding is not None and finding.probability > 0.5:
            yield finding
