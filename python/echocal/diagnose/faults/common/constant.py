"""Values that a device repeats, with some jitter: how probable they are as one constant."""

import numpy as np
from numpy.typing import NDArray
from scipy.special import gammaln

from echocal.diagnose.settings.faults import Constant

__all__ = ["finest", "log_choices", "log_constant"]

Column = NDArray[np.float64]

_JITTERS = 24  # standard deviations tried: neighbors differ by a third


def finest(values: Column, step: float) -> float:
    """Least relative standard deviation of values that are written in steps."""
    return max(step / 12**0.5 / float(np.median(np.abs(values))), 1e-6)


def log_choices(count: int, among: int) -> float:
    """Log of how many rows it may have been, among some, and of which ones.

    docs/method/faults.md, Eq. 31b.
    """
    return float(np.log(among + 1) + gammaln(among + 1) - gammaln(count + 1) - gammaln(among - count + 1))


def log_constant(
    values: Column, least: float, own: Constant, around: tuple[float, float] | None = None
) -> float:
    """Log density of the logarithms of values around one, which has any value.

    docs/method/faults.md, Eq. 31b.

    Parameters
    ----------
    values : ndarray, shape (k,)
        Positive.
    least : float
        Least relative standard deviation.
    own : Constant
    around : (float, float), optional
        Usual relative standard deviation, and the standard deviation of its logarithm. Default: half of
        the constants have the least one, the others any up to `own.jitter`.
    """
    logs = np.log(values)
    center = _mode(logs, least)
    if around is None:
        jitter = np.geomspace(least, max(own.jitter, 2 * least), _JITTERS)
        prior = np.full(_JITTERS, 0.5 / _JITTERS)
        prior[0] += 0.5
    else:
        usual, spread = around
        jitter = np.hypot(least, usual * np.exp(spread * np.linspace(-2.5, 2.5, _JITTERS)))
        prior = np.exp(-0.5 * np.linspace(-2.5, 2.5, _JITTERS) ** 2)
        prior /= prior.sum()
    unit = (logs - center)[:, None] / jitter
    normal = np.exp(-0.5 * unit**2) / (jitter * np.sqrt(2 * np.pi))
    rows = np.log((1 - own.wild) * normal + own.wild / own.range).sum(axis=0)
    level = np.log(jitter * np.sqrt(2 * np.pi / len(logs)))  # over every level
    return float(np.logaddexp.reduce(np.log(prior) + rows + level))


def _mode(logs: Column, least: float) -> float:
    """The most frequent value; where none repeats, the median."""
    rounded, counts = np.unique(np.round(logs / least), return_counts=True)
    return float(rounded[counts.argmax()] * least if counts.max() > 1 else np.median(logs))
