"""A template from the captures themselves: their mean, each moved by its delay, weighted by its strength."""

import numpy as np
from numpy.typing import NDArray

from echocal.errors import UsageError
from echocal.waveforms.baseband import Plan
from echocal.waveforms.captures import Captures
from echocal.waveforms.detection import detect
from echocal.waveforms.estimators import Request
from echocal.waveforms.estimators.matched_filter import matched_filter
from echocal.waveforms.template import Template, template_of

__all__ = ["averaged"]

_LEAST = 10
"""Captures with an echo that a mean needs: of n, the template has 1/n of their noise."""

_ROUNDS = 3
"""Times that captures are aligned with the mean so far; the first time, with the model burst."""


def averaged(captures: Captures, carrier: float, bandwidth: float) -> Template:
    """Return the mean echo of captures, from the origin of the model burst on.

    Raises
    ------
    UsageError
        If too few captures have an echo.
    """
    template = template_of(None, captures.sample_rate, carrier, captures.count)
    for _ in range(_ROUNDS):
        template = _aligned(captures, Plan(template, carrier, bandwidth, captures.count))
    return template


def _aligned(captures: Captures, plan: Plan) -> Template:
    """Fit the echo to all captures by least squares, at the times and strengths by the template so far."""
    request = Request.of(plan)
    angular = 2j * np.pi * plan.spacing * np.arange(plan.count // 2 + 1)
    total: NDArray[np.complex128] = np.zeros(len(angular), complex)
    norm, count = 0.0, 0
    for _, block, finite in captures.blocks():
        found = detect(plan, block, None)
        good = (found.status == 0) & finite
        time, strength = matched_filter(request, found).time[good], found.peak[good]
        weights = strength / found.noise[good] ** 2
        spectra = np.fft.rfft(block[good], plan.count)
        total += np.einsum("i,ij,ij->j", weights, spectra, np.exp(angular * time[:, None]))
        norm += float(weights @ strength)
        count += int(good.sum())
    if count < _LEAST:
        message = (
            f'template is "mean", and {count} captures have an echo before which there is enough noise; '
            f"give at least {_LEAST}, or an echo as template"
        )
        raise UsageError(message)
    mean = np.fft.irfft(total / norm, plan.count)[: len(plan.template.samples)]
    return Template(
        mean / np.sqrt(np.sum(mean**2)) * np.sqrt(np.sum(plan.template.samples**2)), plan.sample_rate
    )
