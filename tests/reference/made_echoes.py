"""Echoes at any time, without the code that is tested: a burst through two resonances by SciPy's lsim."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import CubicSpline
from scipy.signal import hilbert, lsim

__all__ = ["Echo", "captures"]

CARRIER, CYCLES, STEPS = 40e3, 8, 16e6  # Hz, of the burst, steps of the solution per second
LASTS = 2.5e-3  # s: exp(-pi f t / Q) is 2e-6 then at a quality of 20, times the growth of equal poles


class Echo:
    """An echo of peak 1 of its envelope, as a function of the time since its burst began.

    Parameters
    ----------
    quality, center : sequence of float
        Of each resonance: quality factor [1], center frequency [Hz].
    """

    def __init__(
        self, quality: Sequence[float] = (20.0, 20.0), center: Sequence[float] = (CARRIER, CARRIER)
    ) -> None:
        time = np.arange(int(LASTS * STEPS)) / STEPS
        signal = np.sin(2.0 * np.pi * CARRIER * time) * (time < CYCLES / CARRIER)
        for q, f in zip(quality, center, strict=True):
            w = 2.0 * np.pi * f
            signal = lsim(([w / q, 0.0], [1.0, w / q, w * w]), signal, time)[1]
        self.peak = float(np.abs(hilbert(signal)).max())
        self._last = float(time[-1])
        self._spline = CubicSpline(time, signal / self.peak)

    def __call__(self, time: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the echo at times [s]; 0 before and long after."""
        inside = (time >= 0.0) & (time <= self._last)
        return np.where(inside, self._spline(np.clip(time, 0.0, self._last)), 0.0)

    def samples(self, sample_rate: float) -> NDArray[np.float64]:
        """Return its samples, from its begin on."""
        return self(np.arange(int(self._last * sample_rate)) / sample_rate)


def captures(
    echo: Echo, delays: NDArray[np.float64], sample_rate: float, count: int, amplitude: object = 1.0
) -> NDArray[np.float64]:
    """Return captures without noise, shape (n, count): an echo of an amplitude at each delay [s]."""
    time = np.arange(count) / sample_rate - delays[:, None]
    return np.broadcast_to(np.asarray(amplitude, float), delays.shape)[:, None] * echo(time)
