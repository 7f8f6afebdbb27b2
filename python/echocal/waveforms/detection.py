"""The echo of each capture: where it is about, how strong, and how much noise there is before it."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.fft import rfft

from echocal.waveforms.baseband import Baseband, Plan
from echocal.waveforms.result import code

Real = NDArray[np.float64]

FALSE_ALARM = 1e-3
"""Probability that a capture of noise alone is taken for one with an echo: a judgement."""

_LEAST_FREEDOM = 4.0
"""Degrees of freedom of the noise before the echo that an uncertainty needs: with 2 it would be infinite."""

_NEEDED_SHARE = 0.9
"""Share of the energy of an echo that must come before the end of the window."""


@dataclass(frozen=True)
class Detection:
    """The strongest echo of each capture, and the noise before it."""

    # matched, passed: captures behind the matched filter and behind the band-pass
    matched: Baseband
    passed: Baseband
    time: Real  # maximum of the matched filter's envelope [s], from the start of the window; shape (n,)
    peak: Real  # value of that maximum
    noise: Real  # standard deviation of white noise as dense as that at the carrier
    freedom: Real  # degrees of freedom of `noise`; infinite where it is given
    status: NDArray[np.uint8]  # codes of `ECHO_STATUSES`

    @property
    def inflation(self) -> Real:
        """Factor of a standard uncertainty for noise that is estimated: JCGM 101:2008, 6.4.9.4."""
        with np.errstate(invalid="ignore", divide="ignore"):
            spread = np.sqrt(self.freedom / (self.freedom - 2.0))
        return np.where(np.isfinite(self.freedom), np.where(self.freedom > 2.0, spread, np.nan), 1.0)


def detect(plan: Plan, captures: Real, noise: Real | None) -> Detection:
    """Find the strongest echo of each capture.

    The captures, shape (n, N), have finite samples; without the standard deviation of white noise, shape
    (n,), it is estimated before the echo.
    """
    spectrum = rfft(captures, plan.count)[:, plan.band]
    matched, passed = plan.envelope(spectrum, plan.matched), plan.envelope(spectrum, plan.band_pass)
    last = plan.duration - plan.template.duration_of(_NEEDED_SHARE)
    time, peak, at_end = envelope_peak(matched, np.zeros(len(captures)), np.full(len(captures), last))
    looks = last * plan.matched.spread
    if noise is None:
        noise, freedom = _noise_within(plan, passed, np.zeros(len(time)), time)
        doubtful = freedom < _LEAST_FREEDOM
        after = _noise_within(plan, passed, time + plan.template.duration, np.full(len(time), plan.duration))
        stands_out = np.where(
            doubtful, _stands_out(peak, *after, looks), _stands_out(peak, noise, freedom, looks)
        )
    else:
        freedom = np.full(len(time), np.inf)
        doubtful = np.zeros(len(time), bool)
        stands_out = _stands_out(peak, noise, freedom, looks)
    status = np.select(
        [~stands_out, at_end, doubtful], [code("no_echo"), code("cut_off"), code("noise_unknown")], 0
    )
    return Detection(matched, passed, time, peak, noise, freedom, status.astype(np.uint8))


def envelope_peak(band: Baseband, begin: Real, end: Real) -> tuple[Real, Real, NDArray[np.bool_]]:
    """Return time [s] and value of the largest envelope between two times, and whether it is at an end."""
    grid = np.arange(band.values.shape[-1]) / band.rate
    power = band.values.real**2 + band.values.imag**2
    outside = (grid < begin[:, None]) | (grid > end[:, None])
    rows = np.arange(len(power))
    place = np.where(outside, -1.0, power).argmax(axis=-1)
    left, middle, right = (power[rows, (place + step) % len(grid)] for step in (-1, 0, 1))
    bend = left - 2.0 * middle + right
    with np.errstate(invalid="ignore", divide="ignore"):
        shift = np.where(bend < 0.0, 0.5 * (left - right) / bend, 0.0)
    at_end = (np.abs(shift) > 1.0) | ~(bend < 0.0)
    time = (place + np.clip(shift, -1.0, 1.0)) / band.rate
    return time, np.abs(band.at(time)[0]), at_end


def _noise_within(plan: Plan, passed: Baseband, begin: Real, end: Real) -> tuple[Real, Real]:
    """Noise between two times [s], from the power in the band, and its degrees of freedom."""
    grid = np.arange(passed.values.shape[-1]) / passed.rate
    within = (grid >= (begin + plan.reach)[:, None]) & (grid <= (end - plan.reach)[:, None])
    power = np.where(within, passed.values.real**2 + passed.values.imag**2, 0.0).sum(axis=-1)
    count = within.sum(axis=-1)
    independent = np.maximum(count / passed.rate * plan.band_pass.bandwidth, count > 0)
    with np.errstate(invalid="ignore", divide="ignore"):
        noise = np.sqrt(power / (2.0 * count)) / plan.band_pass.noise_gain
    return noise, 2.0 * independent


def _stands_out(peak: Real, noise: Real, freedom: Real, looks: float) -> NDArray[np.bool_]:
    """Whether the envelope of noise alone rises so high with a small probability only.

    Gaussian noise of RMS bandwidth b [rad/s] around the carrier has an envelope that rises above u standard
    deviations ``b u exp(-u^2 / 2) / sqrt(2 pi)`` times a second (Rice 1945, part III,
    doi:10.1002/j.1538-7305.1945.tb00453.x). With an estimated standard deviation the exponential becomes that
    of an F distribution with 2 and `freedom` degrees of freedom. `looks` is b times the time. Where no noise
    is known, the answer is yes for whatever is above 0.
    """
    with np.errstate(invalid="ignore", divide="ignore", over="ignore"):
        square = (peak / noise) ** 2
        tail = np.where(np.isinf(freedom), -0.5 * square, -0.5 * freedom * np.log1p(square / freedom))
        rare = tail + np.log1p(looks * np.sqrt(square / (2.0 * np.pi))) < np.log(FALSE_ALARM)
    return np.asarray(np.where(freedom > 0.0, rare, True) & (peak > 0.0))
