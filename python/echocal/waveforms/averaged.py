"""A template from the captures themselves: their mean, each moved by its delay, weighted by its strength."""

import numpy as np
from numpy.typing import NDArray
from scipy.fft import irfft, rfft
from scipy.signal import hilbert

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
    """Return the mean echo of captures, from about where the model burst begins.

    Raises
    ------
    UsageError
        If too few captures have an echo.
    """
    template = template_of(None, captures.sample_rate, carrier, captures.count)
    template = _turned(captures, Plan(template, carrier, bandwidth, captures.count))
    for _ in range(_ROUNDS):
        template = _aligned(captures, Plan(template, carrier, bandwidth, captures.count))
    return template


def _turned(captures: Captures, plan: Plan) -> Template:
    """Turn the carrier of the template by a phase, so that it fits the captures where the envelopes fit.

    Otherwise a real echo of another phase, such as behind an amplifier that inverts, fits two cycles alike.
    """
    total = 0j
    for _, block, finite in captures.blocks():
        found = detect(plan, block, None)
        good = (found.status == 0) & finite
        value = found.matched.carried(found.time)[0][good]
        total += complex(np.sum(value * np.abs(value) / found.noise[good] ** 2))
    analytic = hilbert(plan.template.samples, 2 * len(plan.template.samples))
    turned = (analytic * np.exp(1j * np.angle(total))).real[: len(plan.template.samples)]
    return Template(turned, plan.sample_rate)


def _aligned(captures: Captures, plan: Plan) -> Template:
    """Fit the echo to all captures by least squares, at the times and strengths by the template so far."""
    request = Request.of(plan)
    angular = 2j * np.pi * plan.frequencies
    total: NDArray[np.complex128] = np.zeros(plan.count // 2 + 1, complex)
    norm, count = 0.0, 0
    for _, block, finite in captures.blocks():
        found = detect(plan, block, None)
        good = (found.status == 0) & finite
        time, strength = matched_filter(request, found).time[good], found.peak[good]
        weights = strength / found.noise[good] ** 2
        spectra = rfft(block[good], plan.count)[:, plan.band]
        total[plan.band] += np.einsum("i,ij,ij->j", weights, spectra, np.exp(angular * time[:, None]))
        norm += float(weights @ strength)
        count += int(good.sum())
    if count < _LEAST:
        message = (
            f'template is "mean", and {count} captures have an echo before which there is enough noise; '
            f"give at least {_LEAST}, or an echo as template"
        )
        raise UsageError(message)
    mean = irfft(total / norm, plan.count)[: len(plan.template.samples)]
    return Template(mean * np.linalg.norm(plan.template.samples) / np.linalg.norm(mean), plan.sample_rate)
