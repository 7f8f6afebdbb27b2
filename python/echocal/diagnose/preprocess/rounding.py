"""The error of rounding that the rows of a placement share."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

__all__ = ["Rounding", "shared_rounding"]

Column = NDArray[np.float64]
Labels = NDArray[np.int64]

_HARMONICS = np.arange(1, 51)  # of the error of rounding; the others have a hundredth of its variance


@dataclass(frozen=True, eq=False)
class Rounding:
    """Placements, and the variance of the error of rounding that does not average out over their rows.

    Attributes
    ----------
    placement : ndarray of int, shape (n,)
        Of each row of the table: rows of one station at one distance.
    variance : ndarray, shape (placements,)
        [m^2].
    each : float
        Standard deviation of the error of rounding of one row [m].
    """

    placement: Labels
    variance: Column
    each: float


def shared_rounding(
    recorded: Mapping[str, Column],
    indication: Column,
    rms: Mapping[str, float],
    placement: Sequence[NDArray[Any]],
) -> Rounding:
    """Variance of the rounding that the rows of each placement share: docs/method.md, Eq. 28b.

    Parameters
    ----------
    recorded : mapping of str to ndarray, shape (n,)
        Readings or echo times that have a step.
    indication : ndarray, shape (n,)
        The same with the base's speed of sound [m].
    rms : mapping of str to float
        Standard deviation of the error of rounding of each [m].
    placement : sequence of ndarray, shape (n,)
        Rows that agree in all of these are of one placement.
    """
    codes = np.zeros(len(indication), dtype=np.int64)
    for column in placement:
        own = np.unique(column, return_inverse=True)[1].reshape(-1)
        codes = np.unique(codes * (int(own.max()) + 1) + own, return_inverse=True)[1].reshape(-1)
    count = np.bincount(codes)
    variance = np.zeros(len(count))
    for name, values in recorded.items():
        meters = values * float(np.median(indication / values))
        mean = np.bincount(codes, meters) / count
        scatter = np.bincount(codes, (meters - mean[codes]) ** 2) / np.maximum(count - 1, 1)
        variance += _undithered(scatter, rms[name])
    return Rounding(codes, variance, float(np.hypot.reduce([rms[name] for name in recorded])))


def _undithered(scatter: Column, rms: float) -> Column:
    """Variance of the mean error of rounding where readings scatter: docs/method.md, Eq. 28b."""
    before = np.maximum(scatter - rms**2, 0.0)[:, None]  # Sheppard's correction: without the rounding
    step = 12**0.5 * rms
    each = 0.5 * (step / (np.pi * _HARMONICS)) ** 2
    return np.asarray((each * np.exp(-before * (2 * np.pi * _HARMONICS / step) ** 2)).sum(axis=1))
