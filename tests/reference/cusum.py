"""Page's cumulative sum for a known step: no test of a change is faster (docs/method/several-tables.md)."""

import math

from scipy.optimize import brentq


def cusum_run_length(shift: float, height: float, mean: float) -> float:
    """Mean rows to an alarm of Page's cumulative sum for a known step (Siegmund 1985, chapter 2).

    Parameters
    ----------
    shift : float
        Step that it is made for, in standard deviations of white noise.
    height : float
        Threshold of the log likelihood ratio.
    mean : float
        True mean in standard deviations: 0 before, `shift` after the change.
    """
    drift = mean - 0.5 * shift
    level = height / shift + 1.166
    power = -2.0 * drift * level
    if abs(power) < 1e-6:
        return level * level
    return (math.exp(power) - 1.0 - power) / (2.0 * drift * drift)


def cusum_threshold(run_length: float, shift: float) -> float:
    """Threshold of Page's cumulative sum with a mean number of rows between false alarms."""
    return float(brentq(lambda h: math.log(cusum_run_length(shift, h, 0.0) / run_length), 1e-6, 200.0))


def cusum_delay(run_length: float, shift: float) -> float:
    """Least worst mean delay [rows] of any test with that run length (Moustakides 1986; Eq. 56)."""
    return cusum_run_length(shift, cusum_threshold(run_length, shift), shift)
