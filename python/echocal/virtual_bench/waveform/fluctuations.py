"""What changes by itself from one reading to the next: turbulence, slow air, waves of a first-order process."""

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.signal import lfilter

__all__ = ["Turbulence", "remembering"]

Column = NDArray[np.float64]


def remembering(seconds: Column, time_constant: float, random: np.random.Generator) -> Column:
    """Draw a stationary process of unit variance whose autocorrelation is `exp(-dt / time_constant)`.

    Parameters
    ----------
    seconds : ndarray, shape (n,)
        Time of each value [s]; it may stand still, and the process with it.
    time_constant : float
        [s].
    random : numpy.random.Generator

    Returns
    -------
    ndarray, shape (n,)
    """
    shocks = random.normal(size=len(seconds))
    if len(seconds) < 2:
        return shocks
    keep = np.exp(-np.abs(np.diff(seconds)) / time_constant)
    shocks[1:] *= np.sqrt(1 - keep**2)
    if np.ptp(keep) < 1e-12:
        return np.asarray(lfilter([1.0], [1.0, -keep[0]], shocks))
    value, values = 0.0, []
    for factor, shock in zip([0.0, *keep.tolist()], shocks.tolist(), strict=True):
        value = factor * value + shock
        values.append(value)
    return np.array(values)


class Turbulence:
    """Warm cells that drift through the path: travel time and amplitude fluctuate for seconds.

    Cells that know nothing of each other add their variances, so the standard deviation grows with the
    square root of the path (Andreeva & Durgin 2005, doi:10.1080/17455030500284170).
    """

    def __init__(self, way: float = 0.15e-3, log_amplitude: float = 0.05, time_constant: float = 2.0) -> None:
        """Take the sizes at a target one meter away.

        Parameters
        ----------
        way : float
            Standard deviation of the distance [m].
        log_amplitude : float
            Of the logarithm of the amplitude.
        time_constant : float
            How long a cell stays [s].
        """
        self.way, self.log_amplitude, self.time_constant = way, log_amplitude, time_constant

    def draw(
        self, seconds: Column, distance: Column, path: NDArray[np.int64], random: np.random.Generator
    ) -> tuple[Column, Column]:
        """Draw for each reading what is added to the distance [m], and the factor of the amplitude.

        `path`, shape (n,), numbers the paths: what blows through one tells nothing of the next.
        """
        apart = seconds + 1e9 * path  # a new path is as long ago as anything
        root = np.sqrt(np.maximum(distance, 0.0))
        way = self.way * root * remembering(apart, self.time_constant, random)
        louder = self.log_amplitude * root * remembering(apart, self.time_constant, random)
        return way, np.exp(louder)


def walk(
    seconds: Column, center: ArrayLike, spread: float, time_constant: float, random: np.random.Generator
) -> Column:
    """Draw a quantity that wanders slowly about its center."""
    return np.asarray(np.asarray(center) + spread * remembering(seconds, time_constant, random))
