"""Readings and references that differ by a known factor."""

from dataclasses import dataclass

import numpy as np

from echocal.diagnose.preprocess.view import View
from echocal.diagnose.settings.faults import SharedFactor

__all__ = ["Factor", "factor_of", "log_free", "log_usual"]


@dataclass(frozen=True)
class Factor:
    """A factor between readings and references that most rows share."""

    value: float
    ratio: float
    log_bayes: float


def factor_of(view: View, factors: tuple[float, ...], limits: SharedFactor) -> Factor | None:
    """The factor that turns readings into references, if one of these does.

    Rows out of physical range take part: a wrong unit is what puts them there.
    """
    if view.reference is None:
        return None
    low, high = view.ratios
    beyond = 1.0001 * float(np.exp(limits.near))
    if all(low > factor * beyond or high < factor / beyond for factor in factors):
        return None  # no row is near any of them
    with np.errstate(all="ignore"):
        log_ratio = np.log(view.indication / view.reference)
    log_ratio = log_ratio[np.isfinite(log_ratio) & view.measured]
    if len(log_ratio) == 0:
        return None
    center = float(np.median(log_ratio))
    nearest = min(factors, key=lambda factor: abs(center - np.log(factor)))
    known = log_usual(center - float(np.log(nearest)), limits)
    shared = float(np.mean(np.abs(log_ratio - np.log(nearest)) < limits.near))
    if known < log_free(center) or shared < limits.most:
        return None  # any factor at all is as probable
    return Factor(nearest, float(np.exp(center)), known - log_usual(center, limits))


def log_usual(off: float, limits: SharedFactor, uncertainty: float = 0.0) -> float:
    """Log density of a log ratio that laws, thermometers and clocks leave."""
    width = np.hypot(limits.spread, uncertainty)
    return float(-0.5 * (off / width) ** 2 - np.log(width * np.sqrt(2 * np.pi)))


def log_free(log_ratio: float) -> float:
    """Log density of the log of a factor of which nothing is known, but that it is from 1/10 to 10."""
    widest = float(np.log(10.0))
    return -float(np.log(2 * widest)) if abs(log_ratio) <= widest else -np.inf
