"""Threshold: the first time at which the carrier rises above a level, as a comparator does."""

import numpy as np
from scipy.special import ndtr

from echocal.waveforms.baseband import Plan
from echocal.waveforms.detection import Detection
from echocal.waveforms.estimators.common import Estimate, Real, Request

__all__ = ["DEFAULT_NOISES", "threshold"]

DEFAULT_NOISES = 6.0
"""Default threshold, in standard deviations of the noise behind the band-pass: noise alone rises above it
40,000 * exp(-18) = 6e-4 times a second (Rice 1944, doi:10.1002/j.1538-7305.1944.tb00874.x)."""

_PER_CYCLE = 16
"""Samples per cycle among which crests are looked for; a parabola then gives their height."""


def threshold(request: Request, found: Detection) -> Estimate:
    """Time echoes as a comparator behind the band-pass does, which has no template.

    The time is that of the crossing itself. It depends on the amplitude: a weaker echo crosses later in the
    same cycle, and then a cycle later (time walk). The ambiguity is the probability that, without noise, this
    crest would not reach the level, the one before it would, or that noise alone crossed it (Rice 1944).
    """
    noise = found.noise * request.plan.band_pass.noise_gain
    level = np.broadcast_to(
        DEFAULT_NOISES * noise if request.threshold is None else request.threshold, noise.shape
    )
    near, missing = _first_crest(request.plan, found, level)
    crest, height = found.passed.crest(near)
    _, height_before = found.passed.crest(crest - request.period)
    angular = 2.0 * np.pi * request.plan.carrier
    time = _rise_before(found, crest, height, level, angular)
    slope = found.passed.carried(time)[1].real
    with np.errstate(invalid="ignore", divide="ignore"):
        # near a crest the flank bends: within its noise the level is passed at sqrt(2 noise / height) / w
        uncertainty = noise / np.sqrt(slope**2 + angular**2 * np.abs(height) * noise)
        too_high, too_low = ndtr((level - height) / noise), ndtr((height_before - level) / noise)
        alone = np.exp(-np.maximum(time, 0.0) * request.plan.carrier * np.exp(-0.5 * (level / noise) ** 2))
    return Estimate(time, uncertainty, np.asarray(1.0 - (1.0 - too_high) * (1.0 - too_low) * alone), missing)


def _first_crest(plan: Plan, found: Detection, level: Real) -> tuple[Real, np.ndarray]:
    """Time [s] of the first crest that reaches the level, and where there is none."""
    signal, rate = found.passed.resampled(_PER_CYCLE * plan.carrier)
    signal = signal[:, : int(plan.samples / plan.sample_rate * rate) + 1]
    left, middle, right = signal[:, :-2], signal[:, 1:-1], signal[:, 2:]
    bend = 2.0 * middle - left - right
    crest = (middle >= left) & (middle > right)
    top = middle + np.where(crest, (right - left) ** 2 / (8.0 * np.where(crest, bend, 1.0)), 0.0)
    reaches = crest & (top >= level[:, None])
    return (reaches.argmax(axis=-1) + 1) / rate, np.asarray(~reaches.any(axis=-1))


def _rise_before(found: Detection, crest: Real, height: Real, level: Real, angular: float) -> Real:
    """Time at which the flank before a crest passes the level [s]: Newton's steps, kept on the flank."""
    with np.errstate(invalid="ignore", divide="ignore"):
        time = crest - np.arccos(np.clip(level / height, -1.0, 1.0)) / angular
    for _ in range(4):
        value, slope = found.passed.carried(time)
        with np.errstate(invalid="ignore", divide="ignore"):
            step = np.where(slope.real > 0.0, (level - value.real) / slope.real, 0.0)
        time = np.clip(time + step, crest - np.pi / angular, crest)
    return np.asarray(time)
