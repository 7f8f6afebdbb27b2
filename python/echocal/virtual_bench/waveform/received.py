"""The voltage before the comparator: echoes over all paths, the burst on the board, and noise."""

from dataclasses import dataclass, replace
from typing import Self

import numpy as np
from numpy.typing import NDArray
from scipy.signal import lfilter

from echocal.virtual_bench.waveform.burst import BurstResponse
from echocal.virtual_bench.waveform.sensor import Sensor

__all__ = ["Noise", "Received", "noise_rate"]

Column = NDArray[np.float64]
Phasor = NDArray[np.complex128]

_SETTLING = 12  # steps, until filtered noise has forgotten its beginning
_OVER = 6e-3  # s, after which a burst has died away: exp(-pi f t / Q) is 1e-16 at 40 kHz and a quality of 20


def noise_rate(sensor: Sensor) -> float:
    """Return the rate [1/s] of the two poles that shape the noise: the last stage of the amplifier, twice."""
    stage = sensor.amplifier[-1]
    return float(np.pi * sensor.frequency / stage.quality)


@dataclass(frozen=True)
class Noise:
    """Band-limited noise on a grid of half periods, straight lines between.

    Attributes
    ----------
    start : ndarray, shape (n,)
        Time of the first value since the burst began [s].
    step : float
        [s].
    values : ndarray of complex, shape (n, k)
        Envelope beside the carrier.
    """

    start: Column
    step: float
    values: Phasor

    @classmethod
    def draw(cls, sensor: Sensor, start: Column, cycles: int, random: np.random.Generator) -> Self:
        """Draw noise from a time on, for so many periods."""
        step = 0.5 / sensor.frequency
        keep = np.exp(-noise_rate(sensor) * step)
        shape = (2, len(start), 2 * cycles + 1 + _SETTLING)
        white = random.normal(size=shape)
        colored = lfilter([1.0], [1.0, -2 * keep, keep * keep], white)[..., _SETTLING:]
        colored *= sensor.noise * np.sqrt((1 - keep**2) ** 3 / (1 + keep**2))
        return cls(start, step, colored[0] + 1j * colored[1])

    def at(self, rows: NDArray[np.int64]) -> Self:
        """Return that of some rows."""
        return replace(self, start=self.start[rows], values=self.values[rows])

    def envelope(self, elapsed: Column) -> Phasor:
        """Interpolate at times since the burst began, shape (n, ...)."""
        shape = (slice(None), *(None,) * (elapsed.ndim - 1))
        place = np.clip((elapsed - self.start[shape]) / self.step, 0.0, self.values.shape[1] - 1.000001)
        left = place.astype(np.int64)
        part, rows = place - left, np.arange(len(elapsed))[shape]
        return np.asarray(self.values[rows, left] * (1 - part) + self.values[rows, left + 1] * part)


@dataclass(frozen=True)
class Received:
    """All that arrives after a burst: `Re[phasor(t) exp(2 pi i f t)]`.

    Attributes
    ----------
    response : BurstResponse
        The burst behind all resonances.
    delays : ndarray, shape (n, p)
        Of the paths [s]; infinite where a reading has fewer.
    sizes : ndarray of complex, shape (n, p)
        Of their echoes.
    noise : Noise or None
    """

    response: BurstResponse
    delays: Column
    sizes: Phasor
    noise: Noise | None = None

    def at(self, rows: NDArray[np.int64]) -> Self:
        """Return that of some rows."""
        noise = None if self.noise is None else self.noise.at(rows)
        return replace(
            self,
            response=self.response.at(rows),
            delays=self.delays[rows],
            sizes=self.sizes[rows],
            noise=noise,
        )

    def phasor(self, elapsed: Column) -> Phasor:
        """Compute the envelope beside the carrier at times since the burst began, shape (n, ...)."""
        omega = 2 * np.pi * self.response.frequency
        shape = (slice(None), *(None,) * (elapsed.ndim - 1))
        total = np.zeros(elapsed.shape, dtype=complex)
        for path in range(self.delays.shape[1]):
            since = elapsed - self.delays[:, path][shape]
            inside = (since > 0) & (since < _OVER)
            heard = np.flatnonzero(inside.any(axis=tuple(range(1, since.ndim))))
            if len(heard) == 0:
                continue
            some = slice(None) if len(heard) == len(since) else heard
            size = self.sizes[some, path] * np.exp(-1j * omega * self.delays[some, path])
            response = self.response if isinstance(some, slice) else self.response.at(heard)
            total[some] += size[shape] * response.envelope(since[some])
        return total if self.noise is None else total + self.noise.envelope(elapsed)

    def voltage(self, elapsed: Column) -> Column:
        """Compute the voltage at times since the burst began, shape (n, ...)."""
        turning = np.exp(2j * np.pi * self.response.frequency * elapsed)
        return np.asarray((self.phasor(elapsed) * turning).real)
