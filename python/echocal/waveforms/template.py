"""The shape of an echo, which the estimators look for: a burst through two resonances, or a given one."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.fft import rfft
from scipy.signal import hilbert, residue

from echocal.errors import UsageError

CARRIER = 40e3
"""Center frequency of the transducers of an HC-SR04 [Hz]; its data sheet says 40 kHz."""

CYCLES = 8
"""Cycles that an HC-SR04 sends; its data sheet says 8."""

QUALITY_FACTOR = 20.0
"""Quality factor of each transducer [1]: a judgement. One resonance with 2.0 kHz at -6 dB, as the data sheet
of the Pro-Wave 400PT120 states, has sqrt(3) * 40 / 2.0 = 35; those of a module are taken as broader."""

_DECAYS = 8.0
"""Time constants of the resonances after the burst at which the model ends: 3e-3 of its peak are left."""

_SILENT = 1e-12
"""Energy, relative to that of full scale in every sample, below which a template has no shape."""


@dataclass(frozen=True)
class Template:
    """An echo without noise; its first sample is the origin of the echo time."""

    samples: NDArray[np.float64]  # the echo [unit of the waveform]; shape (L,)
    sample_rate: float  # samples per second [Hz]

    @property
    def duration(self) -> float:
        """Duration [s]."""
        return len(self.samples) / self.sample_rate

    @property
    def amplitude(self) -> float:
        """Maximum of the envelope [unit of the waveform]."""
        return envelope_maximum(self.samples)

    def spectrum(self, count: int) -> NDArray[np.complex128]:
        """One-sided spectrum, padded with zeros to `count` samples."""
        return np.asarray(rfft(self.samples, count))

    def duration_of(self, share: float) -> float:
        """Time [s] from the origin in which a share of the energy has come."""
        energy = np.cumsum(self.samples**2)
        return float(np.searchsorted(energy, share * energy[-1]) + 1) / self.sample_rate


def model_burst(
    sample_rate: float,
    *,
    carrier: float = CARRIER,
    cycles: int = CYCLES,
    quality_factor: float = QUALITY_FACTOR,
) -> NDArray[np.float64]:
    """Return an echo whose envelope has the maximum 1: a sine burst through two equal resonances.

    Each resonance, transmitter and receiver, is a band-pass of second order, the usual model of a narrow-band
    transducer: ``H(s) = (s w/Q) / (s^2 + s w/Q + w^2)``.
    The solution is exact: partial fractions, no steps of time.

    Parameters
    ----------
    sample_rate : float
        Samples per second [Hz].
    carrier : float
        Frequency of the burst and center of both resonances [Hz].
    cycles : int
        Cycles of the burst, a whole number.
    quality_factor : float
        Quality factor of each resonance [1], above 0.5.

    Returns
    -------
    ndarray, shape (L,)
        From the start of the burst to the end of the decay.

    Examples
    --------
    >>> from echocal.waveforms import model_burst
    >>> burst = model_burst(1e6)
    >>> len(burst), round(float(abs(burst).max()), 3)
    (1474, 0.999)
    """
    phase_end = 2.0 * np.pi * cycles
    step = 2.0 * np.pi * carrier / sample_rate
    count = _length(sample_rate, carrier, cycles, quality_factor)
    phase = np.asarray(step * np.arange(count), dtype=np.float64)
    response = _driven(phase, quality_factor) - _driven(phase - phase_end, quality_factor)
    return np.asarray(response / envelope_maximum(response))


def _length(sample_rate: float, carrier: float, cycles: int, quality_factor: float) -> int:
    """Samples of the model burst."""
    decay = 2.0 * quality_factor  # time constant in radians of the carrier
    return int((2.0 * np.pi * cycles + _DECAYS * decay) / (2.0 * np.pi * carrier / sample_rate)) + 1


def envelope_maximum(samples: NDArray[np.float64]) -> float:
    """Maximum of the envelope of an echo, by its analytic signal."""
    return float(np.abs(hilbert(samples, 2 * len(samples))).max())


def _driven(phase: NDArray[np.float64], quality_factor: float) -> NDArray[np.float64]:
    """Response to a sine that begins at phase 0; time in radians of the carrier."""
    resonance = np.array([1.0, 1.0 / quality_factor, 1.0])
    above = np.array([1.0 / quality_factor**2, 0.0, 0.0])
    below = np.polymul(np.polymul(resonance, resonance), [1.0, 0.0, 1.0])
    weights, poles, _ = residue(above, below)
    after = np.maximum(phase, 0.0)
    total, power = np.zeros(len(phase), complex), 0
    for place, (weight, pole) in enumerate(zip(weights, poles, strict=True)):
        # residue lists equal poles one after another, with rising powers
        repeated = place > 0 and abs(pole - poles[place - 1]) < 1e-6
        power = power + 1 if repeated else 0
        total += weight * after**power * np.exp(pole * after)
    return np.where(phase > 0.0, total.real, 0.0)


def template_of(given: ArrayLike | None, sample_rate: float, carrier: float, count: int) -> Template:
    """Return the given template, or the model burst.

    Raises `UsageError` if the template is no echo, or longer than a capture. It has the sample rate of the
    waveform [Hz], and `count` samples are those of a capture.
    """
    if given is None:  # its length is known before it is computed: at a wrong rate it would fill the memory
        way = "give longer captures, or template= with a shorter echo"
        _refuse_length("the model burst", _length(sample_rate, carrier, CYCLES, QUALITY_FACTOR), count, way)
        return Template(model_burst(sample_rate, carrier=carrier), sample_rate)
    samples = _checked(given)
    _refuse_length("template", len(samples), count, "cut the template to the echo")
    return Template(samples, sample_rate)


def _refuse_length(name: str, length: int, count: int, way: str) -> None:
    if length >= count:
        raise UsageError(
            f"{name} has {length} samples, and a capture (from start to stop) only {count}: too short; {way}"
        )


def _checked(given: ArrayLike) -> NDArray[np.float64]:
    try:
        values = np.asarray(given)
    except ValueError:  # lists of unequal lengths
        values = np.asarray(None)
    if values.dtype.kind not in "fiu":
        told = repr(given) if isinstance(given, str) else f"of the type {values.dtype}"
        raise UsageError(f'template is {told}; give samples, "mean" or None')
    samples = values.astype(np.float64)
    if samples.ndim != 1 or len(samples) < 4:
        raise UsageError(f"template has the shape {samples.shape}; give one echo of at least 4 samples")
    if not np.isfinite(samples).all():
        raise UsageError(
            f"template has {int((~np.isfinite(samples)).sum())} samples that are not finite; give numbers"
        )
    if np.sum((samples - samples.mean()) ** 2) <= _SILENT * np.sum(samples**2) or not samples.any():
        raise UsageError("template is constant; give an echo")
    return samples
