"""Methods that time an echo: a function each, and a line of `ESTIMATORS`."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray
from scipy.special import erfc, ndtr

from echocal.waveforms.baseband import Baseband, Plan
from echocal.waveforms.detection import Detection, detect, envelope_peak

FRACTION = 0.5
"""Part of the maximum at which the rise is timed: there the envelope of an echo is about steepest."""

DEFAULT_NOISES = 6.0
"""Default threshold, in standard deviations of the noise behind the band-pass: noise alone rises above it
40,000 * exp(-18) = 6e-4 times a second (Rice 1944, doi:10.1002/j.1538-7305.1944.tb00874.x)."""

_PER_CYCLE = 16
"""Samples per cycle among which crests are looked for; a parabola then gives their height."""

_CYCLES = np.arange(-3, 4)
"""Cycles that are compared."""

Real = NDArray[np.float64]


@dataclass(frozen=True)
class Request:
    """What is the same for all captures."""

    plan: Plan
    """Template, band and filters."""
    reference: Detection
    """The template alone, without noise."""
    reference_time: float
    """Origin of the template in `reference` [s]."""
    threshold: Real | None = None
    """Threshold of the comparator [unit of the waveform], shape (n,); None takes it from the noise."""

    @classmethod
    def of(cls, plan: Plan) -> "Request":
        """Return the request for a plan."""
        before = round(4.0 * plan.reach * plan.sample_rate)
        capture = np.concatenate([np.zeros(before), plan.template.samples, np.zeros(before)])
        alone = detect(replace(plan, samples=len(capture)), capture[None], np.ones(1))
        return cls(plan, alone, before / plan.sample_rate)

    @property
    def period(self) -> float:
        """Period of the carrier [s]."""
        return 1.0 / self.plan.carrier

    def of_block(self, place: slice) -> "Request":
        """Return the request for a block of captures."""
        return self if self.threshold is None else replace(self, threshold=self.threshold[place])


@dataclass(frozen=True)
class Estimate:
    """Times of the echoes, from the start of the window."""

    # time, standard_uncertainty: [s]; the uncertainty for noise that is known; shape (n,)
    time: Real
    standard_uncertainty: Real
    cycle_ambiguity: Real  # probability that another cycle is the right one [1]
    missing: NDArray[np.bool_] | None = None  # where the method finds no echo although there is one


Estimator: TypeAlias = Callable[[Request, Detection], Estimate]
"""Times detected echoes."""


def weights_of(excess: Real, freedom: Real) -> Real:
    """Posterior weight of each cycle, which sum to 1 along the last axis.

    `excess`, shape (n, K), is the sum of squared residuals above that of the best cycle, by the variance of
    the noise; `freedom` has the degrees of freedom of that variance: with few, the likelihood is that of
    Student's t.
    """
    known = np.isinf(freedom)[:, None]
    many = np.where(known, 1.0, freedom[:, None])
    log = np.where(known, -0.5 * excess, -0.5 * many * np.log1p(excess / many))
    weights = np.exp(log)
    return np.asarray(weights / weights.sum(axis=-1, keepdims=True))


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


@dataclass(frozen=True)
class Rise:
    """Rises of envelopes."""

    time: Real  # time at which the envelope reaches the fraction of its maximum [s]; shape (n,)
    # peak_time, peak: time [s] and value of the maximum
    peak_time: Real
    peak: Real
    slope: Real  # slope at `time` [1/s]


def envelope(request: Request, found: Detection) -> Estimate:
    """Time echoes by the analytic signal behind the band-pass, less the delay of the template's own rise."""
    rise = rise_of(request, found)
    own = float(rise_of(request, request.reference).time[0])
    time = rise.time - (own - request.reference_time)
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


ESTIMATORS: dict[str, Estimator] = {
    "threshold": threshold,
    "envelope": envelope,
    "matched_filter": matched_filter,
    "phase": phase,
}
"""Estimator by method."""
