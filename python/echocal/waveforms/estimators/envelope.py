"""Envelope: the time at which the rising envelope reaches half of its maximum."""

from dataclasses import dataclass

import numpy as np
from scipy.special import erfc

from echocal.waveforms.baseband import Baseband
from echocal.waveforms.detection import Detection, envelope_peak
from echocal.waveforms.estimators.common import Estimate, Real, Request

__all__ = ["FRACTION", "Rise", "envelope", "rise_of"]

FRACTION = 0.5
"""Part of the maximum at which the rise is timed: there the envelope of an echo is about steepest."""


@dataclass(frozen=True)
class Rise:
    """Rises of envelopes.

    Attributes
    ----------
    time : ndarray, shape (n,)
        Time at which the envelope reaches the fraction of its maximum [s].
    peak_time, peak : ndarray
        Time [s] and value of the maximum.
    slope : ndarray
        Slope at `time` [1/s].
    """

    time: Real
    peak_time: Real
    peak: Real
    slope: Real


def envelope(request: Request, found: Detection) -> Estimate:
    """Time echoes by the analytic signal behind the band-pass, less the delay of the template's own rise."""
    rise = rise_of(request, found)
    time = rise.time - _delay(request)
    uncertainty = spread_of(request, found, rise)
    with np.errstate(invalid="ignore", divide="ignore"):
        ambiguity = erfc(0.5 * request.period / (np.sqrt(2.0) * uncertainty))
    return Estimate(time, uncertainty, np.asarray(ambiguity))


def spread_of(request: Request, found: Detection, rise: Rise) -> Real:
    """Return the standard uncertainty of the rise [s], from the noise there and that at the maximum.

    Both are of the part in phase with the echo. Behind the Gaussian band-pass the correlation of the noise
    over a time t is exp(-(s t)^2 / 4), s the standard deviation of the response in angular frequency.
    """
    plan = request.plan
    apart = (rise.peak_time - rise.time) * 2.0 / plan.reach  # reach is 4 / s
    together = np.exp(-(apart**2))
    noise = found.noise * plan.band_pass.noise_gain
    with np.errstate(invalid="ignore", divide="ignore"):
        return np.asarray(
            noise * np.sqrt(1.0 + FRACTION**2 - 2.0 * FRACTION * together) / np.maximum(rise.slope, 0.0)
        )


def _delay(request: Request) -> float:
    return float(rise_of(request, request.reference).time[0]) - request.reference_time


def rise_of(request: Request, found: Detection) -> Rise:
    """Return the rise before the maximum of each envelope near the detected echo."""
    band, reach = found.passed, request.plan.reach
    begin, end = found.time - reach, found.time + request.plan.template.duration_of(0.9) + reach
    peak_time, peak, _ = envelope_peak(band, begin, end)
    time = _crossing(band, peak_time, FRACTION * peak, request.plan.template.duration + 2.0 * reach)
    value, slope = band.at(time)
    with np.errstate(invalid="ignore", divide="ignore"):
        rising = (np.conj(value) * slope).real / np.abs(value)
    return Rise(time, peak_time, peak, rising)


def _crossing(band: Baseband, peak_time: Real, level: Real, longest: float) -> Real:
    """Last time before the maximum at which the envelope comes from below a level [s]."""
    steps = np.arange(1, int(longest * band.rate) + 2)
    last = np.floor(peak_time * band.rate).astype(int)
    index = (last[:, None] - steps + 1) % band.values.shape[-1]
    below = np.abs(band.values[np.arange(len(last))[:, None], index]) < level[:, None]
    left = (last + 1 - steps[below.argmax(axis=-1)]) / band.rate
    low, high = left, np.minimum(left + 1.0 / band.rate, peak_time)
    for _ in range(24):  # bisection, to 1e-12 s: the envelope need not rise evenly where there is noise
        middle = 0.5 * (low + high)
        under = np.abs(band.at(middle)[0]) < level
        low, high = np.where(under, middle, low), np.where(under, high, middle)
    return np.asarray(0.5 * (low + high))
