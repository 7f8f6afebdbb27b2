"""How exactly an echo can be timed: Cramer-Rao bound, and Ziv-Zakai bound with the ambiguity of cycles."""

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.integrate import trapezoid
from scipy.special import ndtr

from echocal.waveforms.captures import positive

_PER_PERIOD, _POINTS, _NEAR = 40, 400, 1e-8
"""Points of the integral in each period of the carrier; below a tenth of it; where they begin, in periods."""


def cramer_rao_bound(echo: ArrayLike, sample_rate: float, noise: float) -> float:
    """Return the least standard deviation [s] of an unbiased estimate of a time, if the cycle is known.

    The variance is at least ``noise^2 / sum((ds/dt)^2)`` for a known echo s in white noise. It is the same
    where the amplitude is estimated as well: an echo of finite length is orthogonal to its derivative.

    Parameters
    ----------
    echo : array_like, shape (L,)
        The echo without noise.
    sample_rate : float
        Samples per second [Hz].
    noise : float
        Standard deviation of the noise [unit of the echo].

    Returns
    -------
    float
        Standard deviation [s].

    References
    ----------
    Kay 1993, Fundamentals of Statistical Signal Processing: Estimation Theory, section 3.5
    and example 3.13.
    Quazi 1981, doi:10.1109/TASSP.1981.1163618.

    Examples
    --------
    >>> from echocal.waveforms import cramer_rao_bound, model_burst
    >>> round(1e9 * cramer_rao_bound(model_burst(1e6), 1e6, noise=0.1), 1)      # ns
    32.1
    """
    spectrum, angular, count = _spectrum(echo, sample_rate)
    slope = 2.0 / count * np.sum(angular**2 * np.abs(spectrum) ** 2)
    return float(positive("noise", noise, "unit of the echo") / np.sqrt(slope))


def ziv_zakai_bound(echo: ArrayLike, sample_rate: float, noise: float, interval: float) -> float:
    """Return the least RMS error [s] of any estimate of an echo's time within an interval.

    Where noise makes cycles of the carrier look alike, no estimate reaches the Cramer-Rao bound, which takes
    the cycle for known. This bound follows from the error of telling two times apart (Ziv and Zakai 1969),
    with the valleys between the cycles filled (Bell et al. 1997).

    Parameters
    ----------
    echo : array_like, shape (L,)
        The echo without noise.
    sample_rate : float
        Samples per second [Hz].
    noise : float
        Standard deviation of the noise [unit of the echo].
    interval : float
        Length of the interval [s] in which the echo is known to be, each time as probable as the other.

    Returns
    -------
    float
        RMS error [s].

    References
    ----------
    Ziv and Zakai 1969, doi:10.1109/TIT.1969.1054301. Bell, Steinberg, Ephraim and Van Trees 1997,
    doi:10.1109/18.556118.

    Examples
    --------
    >>> from echocal.waveforms import model_burst, ziv_zakai_bound
    >>> round(1e6 * ziv_zakai_bound(model_burst(1e6), 1e6, noise=1.0, interval=1e-3), 1)   # us
    14.2
    """
    longest = positive("interval", interval, "s")
    spectrum, angular, count = _spectrum(echo, sample_rate)
    power = np.abs(spectrum) ** 2
    energy_ratio = 2.0 * power.sum() / count / positive("noise", noise, "unit of the echo") ** 2
    period = 2.0 * np.pi * power.sum() / (power @ angular)
    apart = np.concatenate(
        [
            np.geomspace(_NEAR * period, 0.1 * period, _POINTS, endpoint=False),
            np.arange(0.1 * period, longest, period / _PER_PERIOD),
        ]
    )
    unlike = 2.0 * np.sin(0.5 * apart[:, None] * angular) ** 2 @ (power / power.sum())
    confused = (1.0 - apart / longest) * ndtr(-np.sqrt(0.5 * energy_ratio * unlike))
    filled = np.maximum.accumulate(confused[::-1])[::-1]
    return float(np.sqrt(trapezoid(apart * filled, apart)))


def _spectrum(echo: ArrayLike, sample_rate: float) -> tuple[NDArray[np.complex128], NDArray[np.float64], int]:
    samples = np.asarray(echo, dtype=np.float64)
    count = 2 * len(samples)
    spacing = positive("sample_rate", sample_rate, "Hz") / count
    angular = np.asarray(2.0 * np.pi * spacing * np.arange(count // 2 + 1))
    return np.fft.rfft(samples, count), angular, count
