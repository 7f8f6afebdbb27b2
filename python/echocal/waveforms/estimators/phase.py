"""Phase: the phase of the carrier at the maximum of the echo, in the cycle that the envelope points to."""

import numpy as np

from echocal.waveforms.detection import Detection
from echocal.waveforms.estimators.common import Estimate, Request, weights_of
from echocal.waveforms.estimators.envelope import rise_of, spread_of

__all__ = ["phase"]

_CYCLES = np.arange(-3, 4)
"""Cycles that are compared."""


def phase(request: Request, found: Detection) -> Estimate:
    """Time echoes by the phase at the maximum of the envelope, against that of the template.

    The rise of the envelope gives the time to some cycles, the phase then to a part of a cycle. The
    probability of each cycle is that of its distance from the rise, which is normal.
    """
    rise = rise_of(request, found)
    reference = rise_of(request, request.reference)
    origin = request.reference_time
    at_peak = float(reference.peak_time[0]) - origin
    template_phase = np.angle(request.reference.passed.carried(reference.peak_time)[0])[0]
    coarse = rise.time - float(reference.time[0]) + origin
    time = _refined(request, found, coarse, at_peak, float(template_phase))
    _, slope = found.passed.carried(time + at_peak)
    noise = found.noise * request.plan.band_pass.noise_gain
    rough = spread_of(request, found, rise)
    with np.errstate(invalid="ignore", divide="ignore"):
        uncertainty = noise / np.abs(slope)
        away = (time - coarse)[:, None] + _CYCLES * request.period
        excess = (away**2 - (time - coarse)[:, None] ** 2) / rough[:, None] ** 2
    weights = weights_of(excess, found.freedom)
    return Estimate(time, uncertainty, 1.0 - weights[:, len(_CYCLES) // 2])


def _refined(
    request: Request, found: Detection, coarse: np.ndarray, at_peak: float, template_phase: float
) -> np.ndarray:
    angular = 2.0 * np.pi * request.plan.carrier
    time = coarse
    for step in range(4):
        value = found.passed.carried(time + at_peak)[0] * np.exp(-1j * template_phase)
        shift = np.angle(value) / angular
        time = time - shift if step == 0 else time - np.clip(shift, -0.25 / angular, 0.25 / angular)
    return np.asarray(time)
