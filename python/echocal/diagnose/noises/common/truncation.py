"""Whether a device rounds its readings to a step, or cuts them off."""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import product
from math import log, pi, sqrt

import numpy as np
from numpy.typing import NDArray

from echocal.diagnose.preprocess.view import View, least_absolute
from echocal.diagnose.settings.threshold import threshold
from echocal.observations.quantiles import MAD_TO_SD
from echocal.registry import find_effect

__all__ = ["Truncation", "cut_off"]

Column = NDArray[np.float64]

_ENOUGH = 400  # rows that are enough
_INSIDE = 4.0  # robust standard deviations from a smooth error: the others are outliers
_USUAL = 20.0  # degC
_NOISE = (0.05, 0.07, 0.1, 0.14, 0.2, 0.28, 0.4, 0.56, 0.8)  # standard deviations that are tried [steps]
_NEWTON = 20  # most steps; the likelihood has one maximum (Burridge 1981)


@dataclass(frozen=True)
class Truncation:
    """What else shifts the readings of a device, whether it cuts them off or not."""

    fewest: float = threshold(5, "1", "rows that a mean needs; judgement")
    cut: float = threshold(0.5, "1", "probability, before the data, that a device cuts off: integer division")
    certain: float = threshold(0.9, "1", "probability from which on it does, as of a cause that is named")
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
    of sound, one of those in use or any other.
    """
    if view.reference is None or step <= 2 * own.zero:  # half a step may be the zero of the tape
        return False
    rows = np.flatnonzero(view.good)
    rows = rows[:: max(1, len(rows) // _ENOUGH)]
    if len(rows) < own.fewest:
        return False
    distance, error = view.reference[rows], (view.indication - view.reference)[rows]
    one, scale = np.ones_like(distance), [own.scale * distance]
    temperature = view.temperature
    if temperature is not None and np.isfinite(warm := temperature[rows] - _USUAL).all() and np.ptp(warm):
        scale += [(own.per_kelvin * warm) ** power * distance for power in (1, 2)]
    smooth = np.array([one, *scale] if np.ptp(distance) or len(scale) > 1 else [one])
    left = np.abs(error - least_absolute(smooth, error) @ smooth)
    inside = left <= _INSIDE * max(MAD_TO_SD * float(np.median(left)), 0.5 * step)
    zeros = ((1 - own.shifted, [own.zero * one]), (own.shifted, [own.shift * one]))
    speeds = [(1 - own.scaled, error, []), (0.5 * own.scaled, error, scale)]
    used = _at_speeds_in_use(view, rows)
    speeds += [(0.5 * own.scaled / len(used), view.indication[rows] - reading, []) for reading in used]
    odds = log(own.cut / (1 - own.cut))
    for sign, middle in ((1, 0.5 * step), (-1, 0.0)):
        evidence = [
            log(p * q) + _log_evidence((off + middle)[inside], np.array([*zero, *wrong])[:, inside], step)
            for (p, zero), (q, off, wrong) in product(zeros, speeds)
        ]
        odds += sign * float(np.logaddexp.reduce(evidence))
    return odds > log(own.certain / (1 - own.certain))


def _at_speeds_in_use(view: View, rows: NDArray[np.int64]) -> list[Column]:
    """Readings of devices that convert with one of the fixed speeds in use [m]."""
    effect, base = find_effect("fixed_speed"), view.base
    stated = view.observations.reading_speed != base.reading_speed
    if stated or base.device_speed is not None or not base.allows(effect):
        return []
    assert view.reference is not None
    conditions = {name: column[rows] for name, column in view.observations.conditions.items()}
    known = {p.name: p.known for p in effect.parameters}["speed"]
    models = (base.model({"fixed_speed": {"weight": 1.0, "speed": speed}}) for speed in known)
    return [model.indicate(view.reference[rows], **conditions) for model in models]


def _log_evidence(middle: Column, columns: Column, step: float) -> float:
    """Log probability that errors are within half a step of where they are said to be.

    Averaged over the sizes of columns, each of one prior standard deviation, by Laplace's method, and over
    the standard deviation of the noise.
    """
    found = [_laplace(middle / step, columns / step, noise) for noise in _NOISE]
    return float(np.logaddexp.reduce(found))


def _laplace(middle: Column, columns: Column, noise: float) -> float:
    """The same at one standard deviation of the noise; everything in steps."""
    unit = np.eye(len(columns))
    spread = noise**2 + 1 / 12
    size = np.linalg.solve(columns @ columns.T / spread + unit, columns @ middle / spread)
    best, slope, bend = _interval(middle - size @ columns, noise)
    height = best.sum() - 0.5 * size @ size
    for _ in range(_NEWTON):
        among = (bend * columns) @ columns.T + unit
        change = np.linalg.solve(among, columns @ slope - size)
        if 0.5 * change @ among @ change < 1e-3:
            break
        for part in (1.0, 0.25, 0.0625):
            tried = size + part * change
            best, slope, bend = _interval(middle - tried @ columns, noise)
            if best.sum() - 0.5 * tried @ tried > height:
                break
        else:
            break
        size, height = tried, best.sum() - 0.5 * tried @ tried
    among = (bend * columns) @ columns.T + unit
    return float(height - 0.5 * np.linalg.slogdet(among)[1])


def _interval(off: Column, noise: float) -> Sequence[Column]:
    """Log probability of an interval of one step around a value, its slope and its curvature."""
    from scipy.special import ndtr  # takes long to import

    low, high = (np.abs(off) - 0.5) / noise, (np.abs(off) + 0.5) / noise
    inside = np.maximum(ndtr(-low) - ndtr(-high), 1e-300)
    at_low, at_high = (np.exp(-0.5 * z**2) / sqrt(2 * pi) / inside for z in (low, high))
    slope = (at_low - at_high) / noise
    bend = slope**2 - (low * at_low - high * at_high) / noise**2
    return np.log(inside), np.sign(off) * slope, np.maximum(bend, 0.0)
