"""The threshold of the sequential test from the wanted rate of false alarms."""

import math
from functools import cache

import numpy as np
from scipy.integrate import quad
from scipy.optimize import brentq
from scipy.special import ndtr, ndtri

from echocal.arrays import Column

_NODES = 201  # values of the unknown scale


def slack(ratios: Column, weights: Column, rows: float, probability: float) -> float:
    """Ratio of true noise over assumed noise that is not exceeded, with a probability (Eq. 54).

    `ratios`, shape (k,), are standard deviations of slow sums, each possible noise over the assumed one,
    with posterior weights; the scale was learned from so many rows.

    Examples
    --------
    >>> import numpy as np
    >>> from echocal.watch.threshold import slack
    >>> round(slack(np.ones(1), np.ones(1), 500.0, 0.9), 3)
    1.041
    """
    levels = (np.arange(_NODES) + 0.5) / _NODES
    scales = np.exp(ndtri(levels) / math.sqrt(2.0 * rows))
    every = np.outer(ratios, scales).ravel()
    shares = np.repeat(weights / weights.sum() / _NODES, _NODES)
    order = np.argsort(every)
    place = int(np.searchsorted(np.cumsum(shares[order]), probability))
    return max(1.0, float(every[order][min(place, len(order) - 1)]))


def overshoot(x: float) -> float:
    """Siegmund's function nu: how much less often a random walk crosses than a Brownian motion.

    2 x^-2 exp(-2 sum Phi(-x sqrt(n) / 2) / n) (Siegmund 1985, chapter 4); below 0.3, where the sum is long,
    exp(-0.5826 x) (there, chapter 10), which differs by less than 0.001.
    """
    if x < 0.3:
        return math.exp(-0.5826 * x)
    n = np.arange(1.0, 60.0 * 8.0 / x**2 + 2.0)
    return float(2.0 / x**2 * math.exp(-2.0 * float((ndtr(-0.5 * x * np.sqrt(n)) / n).sum())))


@cache
def _field() -> float:
    """Integral of x nu(x)^2 over positive x: crossings over all pairs of onset and present row."""
    return float(quad(lambda x: x * overshoot(x) ** 2, 0.0, 60.0, limit=200)[0])


def false_alarm_rate(height: float, directions: int) -> float:
    """False alarms per row at a threshold, the noise being known (docs/method/several-tables.md, Eq. 53).

    `height` is the threshold b of the standardized sum; the log likelihood ratio is b^2/2. The rates of the
    signatures add up, which bounds the rate from above.

    Examples
    --------
    >>> from echocal.watch.threshold import false_alarm_rate
    >>> round(1 / false_alarm_rate(4.0, 1))
    2175
    """
    return directions * height * math.exp(-0.5 * height**2) / math.sqrt(2.0 * math.pi) * _field()


def threshold(rate: float, directions: int) -> float:
    """Threshold b that has a rate of false alarms per row, the noise being known."""

    def excess(height: float) -> float:
        return math.log(false_alarm_rate(height, directions)) - math.log(rate)

    return float(brentq(excess, 1.0, 30.0)) if excess(1.0) > 0.0 else 1.0


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
