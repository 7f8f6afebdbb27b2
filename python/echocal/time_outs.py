"""What a ranger gives where no echo came: no pulse, or one of the length of its time-out."""

import numpy as np
from numpy.typing import ArrayLike, NDArray

__all__ = ["HC_SR04", "LONGEST_US", "is_echo"]

HC_SR04 = 38e-3
"""Length of ECHO without an echo [s]: HC-SR04 data sheet, ElecFreaks 2011; modules of others give none."""

# That of an SRF04 is "about 36 ms" (technical documentation of its maker). Those of copies are longer or, on
# forum.arduino.cc 613370, shorter; some never end (forum.arduino.cc 55119).
LONGEST_US = 35_000.0
"""Longest echo time by default [us]: a round number, 2.8 % below the shorter time-out of 36 ms."""

_SLOWEST = 300.0  # m/s: sound in dry air at -49 degC


def is_echo(echo_time: ArrayLike, distance: float = 0.0) -> NDArray[np.bool_]:
    """Whether a pulse is an echo, rather than a time-out or no pulse.

    Parameters
    ----------
    echo_time : array_like, shape (n,)
        Lengths of pulses [s]: NaN, 0 or a negative number where none came.
    distance : float
        Of the target, where it is known [m]. An echo may take as long as from there: some rangers reach
        beyond the 6 m of `LONGEST_US`.

    Examples
    --------
    >>> from echocal.time_outs import is_echo
    >>> is_echo([11.66e-3, 38e-3, 0.0, -1e-6]).tolist()
    [True, False, False, False]
    >>> is_echo([38e-3], distance=6.5).tolist()
    [True]
    """
    times = np.asarray(echo_time, dtype=np.float64)
    longest = max(LONGEST_US * 1e-6, 2 * distance / _SLOWEST)
    return np.asarray((times > 0.0) & (times <= longest), dtype=np.bool_)
