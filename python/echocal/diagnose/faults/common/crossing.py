"""Where two columns cross: whether they were exchanged there, or just have the same number."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from echocal.diagnose.preprocess.quantization_grid import find_grid
from echocal.diagnose.settings.threshold import threshold

__all__ = ["Crossing", "at_crossing", "crossings", "refined"]

Column = NDArray[np.float64]

_WINDOWS = (30, 15, 8)  # rows on each side: the slope of the middle one, and whether it bends
_MARGIN = 8  # rows beside a seam whose steps do not count, as the seam may be some rows off
_BIAS = 0.1  # of an autocorrelation in 30 rows with a line taken off
_MOST_ALIKE = 0.95
_NEAR = 60  # rows around a change of roughness in which the seam is looked for


@dataclass(frozen=True)
class Crossing:
    """Numbers that decide where the levels of two columns say nothing."""

    roughness: float = threshold(
        8.0, "1", "largest log likelihood of a change of roughness: that of air changes too; judgement"
    )
    slope: float = threshold(12.0, "1", "largest log likelihood of a difference of slopes; judgement")
    step: float = threshold(
        20.0, "1", "log Bayes factor of steps of the values that are exchanged, or that stay; judgement"
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
    steps = _steps(columns, row, settings)
    rough = 0.0 if steps else min(roughness, settings.roughness)  # steps of the values are no roughness
    return rough + steps + _slopes(columns, row, settings) + _ranges(columns, row, settings)


def crossings(columns: tuple[Column, Column], most: int) -> list[int]:
    """Rows at which one column becomes larger than the other: the first of each group of them."""
    at = np.flatnonzero(np.diff(columns[0] > columns[1])) + 1
    if not len(at):
        return []
    apart = at[np.append(True, np.diff(at) > _WINDOWS[0])]
    return [int(row) for row in apart[:: -(-len(apart) // most)]]


def refined(columns: tuple[Column, Column], row: int) -> int:
    """The row near a change of roughness from which on each column's steps are best those of the other."""
    first, last = max(row - _NEAR, 1), min(row + _NEAR, len(columns[0]) - 1)
    before = [float(np.abs(np.diff(column[:row])).mean()) + 1e-9 for column in columns]
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
    slope, variance = np.empty((2, 2)), np.empty((2, 2))
    for which, column in enumerate(columns):
        slope[which] = [
            -(back := _local(column[row - widest : row][::-1]))[0],
            (on := _local(column[row:]))[0],
        ]
        variance[which] = back[1], on[1]

    def misfit(other: int) -> float:
        pairs = [(which, (which + other) % 2) for which in (0, 1)]
        parts = [(slope[a, 0] - slope[b, 1]) ** 2 / (variance[a, 0] + variance[b, 1]) for a, b in pairs]
        return float(sum(parts))

    return float(np.clip(0.5 * (misfit(0) - misfit(1)), -settings.slope, settings.slope))


def _local(values: Column) -> tuple[float, float]:
    """Slope of the rows from a seam on, and its variance: that of the noise, and that of a bend."""
    fits = [np.polynomial.Polynomial.fit(np.arange(n), values[:n], 1).convert() for n in _WINDOWS]
    slopes = [float(fit.coef[1]) if len(fit.coef) > 1 else 0.0 for fit in fits]
    left = values[: _WINDOWS[0]] - fits[0](np.arange(_WINDOWS[0]))
    alike = float(left[1:] @ left[:-1]) / max(float(left @ left), 1e-12)
    alike = min(max(alike + _BIAS, 0.0), _MOST_ALIKE)
    noise = float(left.var()) * (1 + alike) / (1 - alike) + 1e-12
    far, here, near = (12 * noise / n**3 for n in _WINDOWS)
    bends = ((slopes[1] - slopes[0], far), (slopes[1] - slopes[2], near))
    return slopes[1], here + sum(max(bend**2 - here - own, 0.0) for bend, own in bends)


def _steps(columns: tuple[Column, Column], row: int, settings: Crossing) -> float:
    """Whether the numbers of one column have the step of the other from the row on."""

    def parts(column: Column) -> tuple[Column, Column]:
        return column[: max(row - _MARGIN, 0)], column[row + _MARGIN :]

    found = [
        [0.0 if grid is None else grid.step for grid in map(find_grid, parts(column))] for column in columns
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
