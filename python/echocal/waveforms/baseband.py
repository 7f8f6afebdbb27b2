"""Captures as complex envelopes around the carrier: two filters, sampled as densely as their band needs.

An echo is narrow-band: 8 cycles through two resonances need 2 kHz of the 500 kHz that a capture at 1 MHz has.
So the inverse Fourier transform takes only the bins around the carrier, and gives the complex envelope b with
``filtered(t) = Re[b(t) exp(2 pi i f t)]`` at a tenth of the sample rate or less. Between its samples b is
interpolated by a polynomial, and the carrier is exact, so that no estimate depends on the sampling.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from scipy.fft import fft, ifft, irfft, next_fast_len

from echocal.waveforms.template import Template

Real = NDArray[np.float64]
Complex = NDArray[np.complex128]

_LEFT_OUT = 1e-5
"""Share of a template's energy that may lie outside of the band."""

_EDGE = 0.25
"""Part of the band, at each end, in which the matched filter fades out: a hard end would ring."""

_DENSITY = 2.5
"""Samples of the envelope per inverse bandwidth; with six points of interpolation the error of a phase is
below 1e-4 rad, 0.4 ns at 40 kHz (`test_echo_times.py` measures it)."""

_ALIKE = 0.5
"""Correlation up to which cycles are compared: a cycle below it is not taken for the right one where an echo
stands out of the noise at all."""

_WIDTHS = 4.0
"""Standard deviations after which the Gaussian band-pass ends."""

_NODES = np.arange(-2, 4)
"""Grid points of the interpolation, around the left neighbor."""

_FWHM = 2.0 * np.sqrt(np.log(2.0))
"""Full width at half of the power, in standard deviations of a Gaussian amplitude."""


def reach_of(bandwidth: float) -> float:
    """Time [s] by which a band-pass spreads a sample, to each side."""
    return float(_WIDTHS * _FWHM / (2.0 * np.pi * bandwidth))


@dataclass(frozen=True)
class Filter:
    """A filter of the captures in the band."""

    gain: Complex  # response at each bin of the band; shape (B,)
    noise_gain: float  # standard deviation of what is filtered, for white noise of 1
    bandwidth: float  # bandwidth of the noise [Hz]: independent complex samples per second
    spread: float  # standard deviation of the angular frequency of the noise [rad/s]

    @classmethod
    def of(cls, gain: Complex, spacing: float, count: int) -> "Filter":
        """Return the filter of a response at bins of a spacing [Hz], of `count` samples."""
        power = np.abs(gain) ** 2
        noise_gain = np.sqrt(2.0 / count * power.sum())
        bandwidth = spacing * power.sum() ** 2 / (power**2).sum()
        weights = power / power.sum()
        bins = np.arange(len(power))
        spread = 2.0 * np.pi * spacing * np.sqrt(weights @ (bins - weights @ bins) ** 2)
        return cls(gain, float(noise_gain), float(bandwidth), float(spread))


@dataclass(frozen=True)
class Plan:
    """Band, filters and sampling for captures of one length."""

    template: Template
    # carrier, bandwidth: center and full width at half of the power of the band-pass [Hz]
    carrier: float
    bandwidth: float
    samples: int  # samples of a capture

    @property
    def sample_rate(self) -> float:
        """Samples of a capture per second [Hz]."""
        return self.template.sample_rate

    @property
    def duration(self) -> float:
        """Duration of a capture [s]."""
        return self.samples / self.sample_rate

    @property
    def reach(self) -> float:
        """Time [s] by which the band-pass spreads a sample, to each side."""
        return reach_of(self.bandwidth)

    @cached_property
    def count(self) -> int:
        """Samples with the zeros behind, into which the filters may reach."""
        behind = len(self.template.samples) + 2 * int(self.reach * self.sample_rate)
        return int(next_fast_len(self.samples + behind, real=True))

    @property
    def spacing(self) -> float:
        """Distance of the bins [Hz]."""
        return self.sample_rate / self.count

    @cached_property
    def band(self) -> slice:
        """Bins of the band: what the template and the band-pass need."""
        width = max(self._template_width(), _WIDTHS * self.bandwidth / _FWHM)
        low = max(int((self.carrier - width) / self.spacing), 1)
        high = min(int((self.carrier + width) / self.spacing) + 1, (self.count - 1) // 2)
        return slice(low, high + 1)

    def _template_width(self) -> float:
        power = np.abs(self.template.spectrum(self.count)[1:-1]) ** 2
        offset = np.abs(self.spacing * np.arange(1, len(power) + 1) - self.carrier)
        order = np.argsort(offset)
        energy = np.cumsum(power[order])
        needed = offset[order][np.searchsorted(energy, (1.0 - _LEFT_OUT) * energy[-1])]
        return float(needed / (1.0 - _EDGE))

    @property
    def frequencies(self) -> Real:
        """Frequency of each bin of the band [Hz]."""
        return self.spacing * np.arange(self.band.start, self.band.stop)

    @property
    def center(self) -> int:
        """Bin whose frequency the envelopes have left."""
        return round(self.carrier / self.spacing)

    @cached_property
    def matched(self) -> Filter:
        """The matched filter, of noise gain 1."""
        places = np.linspace(-1.0, 1.0, self.band.stop - self.band.start)
        fade = np.clip((1.0 - np.abs(places)) / _EDGE, 0.0, 1.0)
        gain = np.conj(self.template.spectrum(self.count)[self.band]) * np.sin(0.5 * np.pi * fade) ** 2
        return Filter.of(
            gain / Filter.of(gain, self.spacing, self.count).noise_gain, self.spacing, self.count
        )

    @cached_property
    def band_pass(self) -> Filter:
        """A Gaussian band-pass without delay, of gain 1 at the carrier."""
        away = (self.frequencies - self.carrier) / self.bandwidth * _FWHM
        return Filter.of(np.exp(-0.5 * away**2).astype(complex), self.spacing, self.count)

    @cached_property
    def angular_rms(self) -> float:
        """RMS angular frequency of the template [rad/s]."""
        power = np.abs(self.matched.gain) ** 2
        return float(2.0 * np.pi * np.sqrt((power * self.frequencies**2).sum() / power.sum()))

    @cached_property
    def alike_cycles(self) -> int:
        """Cycles by which the template can move, to each side, and still be much like itself."""
        power = np.abs(self.matched.gain) ** 2
        lags = np.arange(int(self.template.duration * self.carrier) + 1) / self.carrier
        turned = np.exp(2j * np.pi * (self.frequencies - self.carrier) * lags[:, None]) @ power
        return max(int((np.abs(turned) > _ALIKE * power.sum()).sum()) - 1, 2)

    @cached_property
    def length(self) -> int:
        """Samples of an envelope."""
        return next_fast_len(int(_DENSITY * (self.band.stop - self.band.start)))

    def envelope(self, spectrum: Complex, filtered: Filter) -> "Baseband":
        """Return the complex envelope of filtered captures.

        The spectrum, shape (n, B), has the bins of the band.
        """
        bins = np.zeros((len(spectrum), self.length), complex)
        place = (np.arange(self.band.start, self.band.stop) - self.center) % self.length
        bins[:, place] = spectrum * filtered.gain
        values = ifft(bins, axis=-1, overwrite_x=True)
        values *= 2.0 * self.length / self.count
        rate = self.length * self.spacing
        return Baseband(values, rate, self.center * self.spacing)


@dataclass(frozen=True)
class Baseband:
    """Complex envelopes of captures, as functions of the time."""

    values: Complex  # periodic samples from time 0 on; shape (n, M)
    rate: float  # samples per second [Hz]
    frequency: float  # carrier that was left out [Hz]

    def at(self, time: Real) -> tuple[Complex, Complex]:
        """Return the envelope and its derivative [1/s] at times [s] of each capture, shape (n, ...)."""
        place = time * self.rate
        left = np.floor(np.where(np.isfinite(place), place, 0.0))  # no time, no value: the weights are NaN
        weights, slopes = _lagrange(place - left)
        rows = np.arange(len(time)).reshape(-1, *(1,) * time.ndim)
        index = (left.astype(int)[..., None] + _NODES) % self.values.shape[-1]
        points = self.values[rows, index]
        return (points * weights).sum(axis=-1), (points * slopes).sum(axis=-1) * self.rate

    def carried(self, time: Real) -> tuple[Complex, Complex]:
        """Return the analytic signal, whose real part is the filtered capture, and its derivative [1/s]."""
        value, slope = self.at(time)
        angular = 2.0 * np.pi * self.frequency
        turn = np.exp(1j * angular * time)
        return value * turn, (slope + 1j * angular * value) * turn

    def resampled(self, rate: float) -> tuple[Real, float]:
        """Return the filtered captures at a rate of at least `rate` [Hz], and the rate."""
        length = self.values.shape[-1]
        spacing = self.rate / length
        count = next_fast_len(int(rate / spacing) + 1, real=True)
        bins = np.zeros((len(self.values), count // 2 + 1), complex)
        place = np.fft.fftfreq(length, 1.0 / length).astype(int) + round(self.frequency / spacing)
        inside = (place > 0) & (place < bins.shape[-1])
        bins[:, place[inside]] = fft(self.values, axis=-1)[:, inside]
        return irfft(bins, count, axis=-1) * (0.5 * count / length), count * spacing

    def crest(self, time: Real) -> tuple[Real, Real]:
        """Return time [s] and value of the nearest maximum of the filtered captures."""
        angular = 2.0 * np.pi * self.frequency
        value, _ = self.carried(time)
        time = time - np.angle(value) / angular
        for _ in range(2):  # Newton's steps: a maximum of Re z, where Re z'' = -w^2 Re z
            value, slope = self.carried(time)
            time = (
                time
                + np.clip(slope.real / (angular * np.maximum(np.abs(value), 1e-300)), -1.0, 1.0) / angular
            )
        return time, self.carried(time)[0].real


def _polynomials() -> Real:
    """Coefficients, by rising power, of the polynomials that are 1 at one node and 0 at the others."""
    found = np.linalg.inv(np.vander(_NODES.astype(float), increasing=True))
    return np.asarray(found)


_COEFFICIENTS = _polynomials()
_POWERS = np.arange(len(_NODES))


def _lagrange(part: Real) -> tuple[Real, Real]:
    """Weights of the six points, and of the derivative, at a part of the grid's step."""
    powers = part[..., None] ** _POWERS
    return powers @ _COEFFICIENTS, powers[..., :-1] @ (_POWERS[1:, None] * _COEFFICIENTS[1:])
