"""Where two columns cross: whether they were exchanged there, or just have the same number."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from echocal.diagnose.preprocess.quantization_grid import find_grid
from echocal.diagnose.settings.threshold import threshold
from echocal.observations.quantiles import median

__all__ = ["Crossing", "at_crossing", "refined"]

Column = NDArray[np.float64]

_WINDOWS = (30, 15, 8)  # rows on each side: the slope of the middle one, and whether it bends
_NEAR = 60  # rows around a change of roughness in which the seam is looked for


@dataclass(frozen=True)
class Crossing:
    """Numbers that decide where the levels of two columns say nothing."""

    roughness: float = threshold(
        8.0, "1", "largest log likelihood of a change of roughness: that of air changes too; judgement"
    )
    slope: float = threshold(12.0, "1", "largest log likelihood of a difference of slopes; judgement")
    step: float = threshold(
        12.0, "1", "log Bayes factor of steps of the values that are exchanged, or that stay; judgement"
    )
    range: float = threshold(
        8.0, "1", "log Bayes factor of temperatures that no air has, one way but not the other; judgement"
    )
    hottest: float = threshold(60.0, "degC", "of air: the record is 57 degC (WMO, 1913)")
    coldest: float = threshold(-60.0, "degC", "of air where people measure; judgement")
    part: float = threshold(0.02, "1", "part of the rows outside, for a range to say anything; judgement")


def at_crossing(columns: tuple[Column, Column], row: int, roughness: float, settings: Crossing) -> float:
    """Log Bayes factor of an exchange from `row` on, where temperature and humidity [%] cross.

    Levels go on either way there. The slopes go on in one way only, unless they are equal; the steps of
    the values, and the temperatures of air, may decide too.
    """
    evidence = min(roughness, settings.roughness) + _slopes(columns, row, settings)
    return evidence + _steps(columns, row, settings) + _ranges(columns, row, settings)


def refined(columns: tuple[Column, Column], row: int) -> int:
    """The row near a change of roughness from which on each column's steps are best those of the other."""
    first, last = max(row - _NEAR, 1), min(row + _NEAR, len(columns[0]) - 1)
    before = [median(np.abs(np.diff(column[:row]))) + 1e-9 for column in columns]
    own, other = np.zeros(last - first), np.zeros(last - first)
    across = np.zeros(last - first)
    for place, column in enumerate(columns):
        steps = np.abs(np.diff(column[first - 1 : last]))
        own += steps / before[place]
        other += steps / before[1 - place]
        across += np.abs(columns[1 - place][first:last] - column[first - 1 : last - 1]) / before[place]
    cost = np.cumsum(own) - own + across + (other.sum() - np.cumsum(other))
    return first + int(np.argmin(cost))


def _slopes(columns: tuple[Column, Column], row: int, settings: Crossing) -> float:
    widest = _WINDOWS[0]
    if not widest <= row <= len(columns[0]) - widest:
        return 0.0
    sides = (slice(row - widest, row), slice(row, row + widest))
    slope, variance = np.empty((2, 2)), np.empty((2, 2))
    for which, column in enumerate(columns):
        for side, rows in enumerate(sides):
            values = column[rows][:: 2 * side - 1]  # from the seam on
            far, here, near = ((2 * side - 1) * _slope(values[:n]) for n in _WINDOWS)
            step = 1.4826 * median(np.abs(np.diff(values) - (2 * side - 1) * here)) + 1e-6
            walk = 1.2 * step**2 / _WINDOWS[1]  # of a random walk, the worst case
            slope[which, side] = here
            variance[which, side] = walk + (here - far) ** 2 + (here - near) ** 2  # and of a bend

    def misfit(other: int) -> float:
        pairs = [(which, (which + other) % 2) for which in (0, 1)]
        parts = [(slope[a, 0] - slope[b, 1]) ** 2 / (variance[a, 0] + variance[b, 1]) for a, b in pairs]
        return float(sum(parts))

    return float(np.clip(0.5 * (misfit(0) - misfit(1)), -settings.slope, settings.slope))


def _slope(values: Column) -> float:
    return float(np.polyfit(np.arange(len(values)), values, 1)[0])


def _steps(columns: tuple[Column, Column], row: int, settings: Crossing) -> float:
    """Whether the numbers of one column have the step of the other from the row on."""
    found = [
        [0.0 if grid is None else grid.step for grid in map(find_grid, (column[:row], column[row:]))]
        for column in columns
    ]
    (warm, warm_after), (humid, humid_after) = found
    if np.isclose(warm, humid, rtol=0.1):
        return 0.0
    if np.allclose((warm, humid), (warm_after, humid_after), rtol=0.1):
        return -settings.step
    return settings.step if np.allclose((warm, humid), (humid_after, warm_after), rtol=0.1) else 0.0


def _ranges(columns: tuple[Column, Column], row: int, settings: Crossing) -> float:
    """Whether only one way has temperatures that air has."""
    before, after = ([column[rows] for column in columns] for rows in (slice(row), slice(row, None)))
    ways = [(before[first], after[second]) for first, second in ((0, 0), (0, 1), (1, 0))]
    odd = [float(np.mean(_odd(np.concatenate(way), settings))) for way in ways]
    stays, exchanged = odd[0], min(odd[1:])
    if max(stays, exchanged) < settings.part or min(stays, exchanged) > 0.0:
        return 0.0
    return settings.range if stays > exchanged else -settings.range


def _odd(celsius: Column, settings: Crossing) -> NDArray[np.bool_]:
    return np.asarray((celsius > settings.hottest) | (celsius < settings.coldest))
