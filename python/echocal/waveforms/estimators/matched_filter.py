"""Matched filter: the delay at which the template fits best, among all crests of the correlation."""

import numpy as np

from echocal.waveforms.detection import Detection
from echocal.waveforms.estimators.common import Estimate, Request, weights_of

__all__ = ["matched_filter"]


def matched_filter(request: Request, found: Detection) -> Estimate:
    """Time echoes by the largest crest of the correlation with the template.

    In white noise, with an amplitude that is not known, this is the maximum of the likelihood, and its error
    reaches the Cramer-Rao bound where the cycle is right (Kay 1993, section 7.10). The log-likelihood of a
    crest of height R is R^2 / 2 s^2. With a flat prior of time and amplitude, its share is the probability of
    its cycle.
    """
    most = request.plan.alike_cycles
    cycles = np.arange(-most, most + 1) * request.period
    first, _ = found.matched.crest(found.time)
    times, heights = found.matched.crest(first[:, None] + cycles)
    heights = np.maximum(heights, 0.0)
    best = heights.argmax(axis=-1)
    rows = np.arange(len(best))
    height = heights[rows, best]
    with np.errstate(invalid="ignore", divide="ignore"):
        excess = (height[:, None] ** 2 - heights**2) / found.noise[:, None] ** 2
        weights = weights_of(excess, found.freedom)
        uncertainty = found.noise / (height * request.plan.angular_rms)
    return Estimate(times[rows, best], uncertainty, 1.0 - weights[rows, best])
