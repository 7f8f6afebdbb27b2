"""Whether a device rounds its readings to a step, or cuts them off."""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import product
from math import log

import numpy as np
from numpy.typing import NDArray

from echocal.diagnose.preprocess.rounding import undithered
from echocal.diagnose.preprocess.view import View, least_absolute
from echocal.diagnose.settings.threshold import threshold

__all__ = ["Truncation", "cut_off"]

Column = NDArray[np.float64]

_ENOUGH = 4000  # rows that are enough
_INSIDE = 4.0  # robust standard deviations from a smooth error: the others are outliers
_USUAL = 20.0  # degC


@dataclass(frozen=True)
class Truncation:
    """What else shifts the readings of a device that cuts them off, or does not."""

    fewest: float = threshold(5, "1", "rows that a mean needs; judgement")
    cut: float = threshold(0.5, "1", "probability, before the data, that a device cuts off: integer division")
    certain: float = threshold(0.9, "1", "probability from which on it does, as a cause that is named")
    zero: float = threshold(
        1e-3, "m", "standard deviation of the zeros of tape and mount: a division of a ruler"
    )
    shifted: float = threshold(0.1, "1", "probability of a delay or a zero error beyond that; judgement")
    shift: float = threshold(5e-3, "m", "standard deviation of it, as of zero_error")
    scaled: float = threshold(0.5, "1", "probability that the device converts with a wrong speed; judgement")
    scale: float = threshold(0.03, "1", "standard deviation of that speed's error: 333 to 351 m/s are in use")
    per_kelvin: float = threshold(
        2e-3, "1/K", "the same of the change with the temperature: 0.6/343, rounded up"
    )


def cut_off(view: View, step: float, own: Truncation) -> bool:
    """Whether readings are cut off at whole steps, so that they are half a step short on average.

    The likelihood of either is averaged over what else may shift a reading: a zero error, and a wrong speed
    of sound, whose error is proportional to the distance and may change with the temperature.
    """
    if view.reference is None:
        return False
    rows = np.flatnonzero(view.good)
    rows = rows[:: max(1, len(rows) // _ENOUGH)]
    if len(rows) < own.fewest:
        return False
    distance, temperature = view.reference[rows], view.temperature
    error = view.indication[rows] - distance
    columns = [np.ones_like(distance), own.scale * distance]
    if temperature is not None and np.isfinite(warm := temperature[rows] - _USUAL).all() and np.ptp(warm):
        columns += [(own.per_kelvin * warm) ** power * distance for power in (1, 2)]
    one, *scale = columns
    smooth = np.array(columns if np.ptp(distance) or len(columns) > 2 else [one])
    left = error - least_absolute(smooth, error) @ smooth
    scatter = max(1.4826 * float(np.median(np.abs(left))), 0.25 * step)
    inside = np.abs(left) < _INSIDE * max(scatter, step / 2)
    weight = _weight(view.indication[rows], distance, scatter, step)[inside]
    likely = {True: -np.inf, False: -np.inf}
    shifts = ((1 - own.shifted, [own.zero * one]), (own.shifted, [own.zero * one, own.shift * one]))
    scales = ((1 - own.scaled, []), (own.scaled, scale))
    for cut, (p, shift), (q, wrong) in product((True, False), shifts, scales):
        residual = error + (0.5 * step if cut else 0.0)
        evidence = log(p * q) + _log_evidence(residual[inside], [c[inside] for c in shift + wrong], weight)
        likely[cut] = float(np.logaddexp(likely[cut], evidence))
    odds = log(own.cut / (1 - own.cut)) + likely[True] - likely[False]
    return odds > log(own.certain / (1 - own.certain))


def _weight(reading: Column, distance: Column, scatter: float, step: float) -> Column:
    """One over the variance of each row, so that rows that share an error of rounding count as one of them.

    docs/method.md, Eq. 28b.
    """
    station = np.unique(distance, return_inverse=True)[1]
    count = np.bincount(station)
    mean = np.bincount(station, reading) / count
    several = int((count[count > 1] - 1).sum())
    within = float(np.sum((reading - mean[station]) ** 2)) / several if several else np.inf
    shared = float(undithered(np.array([within]), step / 12**0.5)[0]) if several else 0.0
    own = max(scatter**2 - shared, 1e-2 * step**2)
    return np.asarray(1.0 / (own + count[station] * shared))


def _log_evidence(residual: Column, columns: Sequence[Column], weight: Column) -> float:
    """Log likelihood of a residual, averaged over the sizes of columns of one prior standard deviation."""
    basis = np.array(columns)
    along = basis @ (weight * residual)
    among = (weight * basis) @ basis.T + np.eye(len(basis))
    fitted = float(along @ np.linalg.solve(among, along))
    return 0.5 * (fitted - float(weight @ residual**2) - float(np.linalg.slogdet(among)[1]))
