"""What changes by itself from one reading to the next: turbulence, slow air."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.signal import lfilter

Column = NDArray[np.float64]


def remembering(seconds: Column, time_constant: float, random: np.random.Generator) -> Column:
    """Draw a stationary process of unit variance whose autocorrelation is `exp(-dt / time_constant)`.

    `seconds`, shape (n,), may stand still, and the process with it.
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


@dataclass(frozen=True)
class Turbulence:
    """Warm cells that drift through the path: travel time and amplitude fluctuate.

    Over a way that is short beside the cells the delays add up, so their standard deviation grows with the
    way; over a long one with its square root (Chernov 1960, Wave Propagation in a Random Medium;
    measured by Andreeva & Durgin 2005, doi:10.1080/17455030500284170). That of the logarithm of the
    amplitude grows with its power 11/12 (Tatarskii 1971, The Effects of the Turbulent Atmosphere on Wave
    Propagation).

    Notes
    -----
    The variance of the logarithm of a spherical wave's amplitude is `0.124 C k^(7/6) L^(11/6)` with
    `C = CT^2 / (4 T^2) + (22 / 12) Cv^2 / c^2` (Tatarskii 1971; Ostashev & Wilson 2015, Acoustics in Moving
    Inhomogeneous Media). For a way of 2 m at 40 kHz this is a standard deviation of 0.004 with
    `CT^2 = 0.001 K^2 m^(-2/3)` and `Cv^2 = 0.001 m^(4/3) s^(-2)`, which are assumed for a room, and of 0.03
    with fifty times as much, assumed for the open by day. The standard deviation of the way and both time
    constants are assumptions.
    """

    way: float = 0.15e-3
    """Standard deviation of the distance, of a target one meter away [m]."""
    log_amplitude: float = 0.004
    # time_constant, flicker: how long a cell delays the sound, and how long it focuses it [s]
    """The same of the logarithm of the amplitude."""
    time_constant: float = 2.0
    flicker: float = 0.3
    cell: float = 1.0
    """How far the temperatures of two points know of each other [m]; assumed to be about the height above the
    ground."""

    def draw(
        self, seconds: Column, distance: Column, path: NDArray[np.int64], random: np.random.Generator
    ) -> tuple[Column, Column]:
        """Draw for each reading what is added to the distance [m], and the factor of the amplitude.

        `path`, shape (n,), numbers the paths: what blows through one tells nothing of the next.
        """
        apart = seconds + 1e9 * path  # a new path is as long ago as anything
        far = np.maximum(distance, 0.0)
        way = self.way * np.sqrt(self._variance(far) / self._variance(np.ones(1)))
        louder = self.log_amplitude * far ** (11 / 12) * remembering(apart, self.flicker, random)
        return way * remembering(apart, self.time_constant, random), np.exp(louder)

    def _variance(self, distance: Column) -> Column:
        """Of the sum over a way whose points are correlated by exp(-distance / cell), up to a factor."""
        cells = distance / self.cell
        return np.asarray(cells + np.expm1(-cells))


# The scatter of the way is set by hand: in a room it is below what the timer tells; in the open, with slow
# air, it is 1.5 mm at 2 m, between the 0.6 mm of a night and the 2.4 mm of full sun on a mast (an SR50's
# readings ten minutes apart). It does not follow the sun. The amplitudes are those of `Turbulence`.
INDOORS = Turbulence(way=0.1e-3)
OUTDOORS = Turbulence(way=0.8e-3, log_amplitude=0.03)
