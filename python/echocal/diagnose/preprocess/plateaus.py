"""Ruler values for the plateaus of a raw log: the rows in which the target stayed where it was placed."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view
from numpy.typing import NDArray

from echocal.diagnose.preprocess.reference import refuse_distance
from echocal.errors import DataError, UsageError
from echocal.keywords import keyword
from echocal.observations import Observations
from echocal.observations.quantiles import MAD_TO_SD

__all__ = ["BETWEEN", "distances_of", "placed", "plateaus"]

Column = NDArray[np.float64]

BETWEEN = "between placements"
"""Why a row is left out."""

_SPEED = 343.0  # m/s: levels are only compared with each other
_WINDOW = 5  # rows
_FEWEST = 5  # rows of a plateau
_STOP = 0.25  # of the usual stay: a shorter one is a stop on the way
_FAR = 6.0  # standard deviations of the rows at a place
_OFF = 5.0  # robust sd of its plateau, beyond which a row is on its way
_LEAST = 5e-3  # m: what is nearer is the same place; a hand moves a target by more
_COARSE = 0.2  # of the steps from row to row that are none: the readings have a coarse grid


@dataclass(frozen=True)
class Plateau:
    """Rows in which the target stayed.

    Attributes
    ----------
    rows : ndarray of int
    level : float
        Median of their readings [m].
    """

    rows: NDArray[np.int64]
    level: float

    def __str__(self) -> str:
        return f"rows {self.rows[0] + 1} to {self.rows[-1] + 1} at {self.level:.3f} m"


def distances_of(given: Sequence[float] | str) -> list[float]:
    """Distances of placements [m], which may be a text with commas between them.

    Raises
    ------
    UsageError
        If the text is something else, or a distance is impossible.

    Examples
    --------
    >>> distances_of("0.5,1.2,2.5")
    [0.5, 1.2, 2.5]
    """
    try:
        distances = [float(word) for word in given.split(",")] if isinstance(given, str) else list(given)
    except ValueError:
        message = f"{keyword('placements', given)}: distances in m, with commas between them: 0.5,1.2,2.5"
        raise UsageError(message) from None
    for distance in distances:
        refuse_distance(distance)
    return distances


def placed(observations: Observations, distances: Sequence[float]) -> Observations:
    """Give each plateau of a log the distance that the user read from a ruler, in the order of the log.

    Rows between two plateaus become unusable.

    Raises
    ------
    UsageError
        If the table has reference distances already.
    DataError
        If the log has another number of plateaus, or they are not in this order.
    """
    if observations.reference_distance is not None:
        column = observations.source_names.get("reference_distance", "reference_distance")
        message = (
            f"{keyword('placements')} gives a log its reference distances, and column '{column}' has some: "
            f"{keyword('columns', {column: 'ignore'})}, or leave the option out"
        )
        raise UsageError(message)
    found = _stays(plateaus(observations), len(distances))
    listed = "; ".join(map(str, found)) or "none"
    if len(found) != len(distances):
        message = (
            f"{keyword('placements')} lists {len(distances)} distances, and the log has {len(found)} "
            f"plateaus of at least {_FEWEST} rows: {listed}. Give one distance for each, in their order; "
            f"rows of no placement are left out with {keyword('since')} and {keyword('until')}"
        )
        raise DataError(message)
    given = np.array(distances, dtype=np.float64)
    levels = np.array([one.level for one in found])
    by_ruler = np.argsort(given, kind="stable")
    wrong = np.flatnonzero((np.diff(levels[by_ruler]) < 0.0) & (np.diff(given[by_ruler]) > 0.0))
    if len(wrong):
        first, second = by_ruler[wrong[0]], by_ruler[wrong[0] + 1]
        message = (
            f"{keyword('placements')} says {given[first]:g} m for plateau {first + 1} and {given[second]:g} "
            f"m for plateau {second + 1}, and the readings say that the first is farther: {listed}. Give the "
            "distances in the order of the log"
        )
        raise DataError(message)
    reference, stand = np.full(len(observations), np.nan), np.full(len(observations), -1, dtype=np.int64)
    for number, one in enumerate(found):
        reference[one.rows], stand[one.rows] = given[number], number
    lost = observations.usable & np.isnan(reference)
    note = (
        f"placements by the plateaus of the log: "
        f"{'; '.join(f'{d:g} m, {one}' for d, one in zip(given, found, strict=True))}; {int(lost.sum())} "
        "rows are between them"
    )
    return replace(
        observations,
        reference_distance=reference,
        unusable=np.where(lost, BETWEEN, observations.unusable),
        labels={**observations.labels, "stand": stand},
        notes=(*observations.notes, note),
    )


def plateaus(observations: Observations) -> list[Plateau]:
    """The rows in which the target rested, in the order of the log.

    A row is at rest if the medians of five rows around it lie within a tolerance: six standard deviations of
    the steps from row to row, two steps of the readings, or 5 mm. Rows at rest that follow each other at one
    level are a plateau, with the rows around them at this level.
    """
    reading = observations.reading
    whole = 0.5 * _SPEED * observations.echo_time if reading is None else reading
    rows = np.flatnonzero(observations.usable & np.isfinite(whole))
    if len(rows) < _FEWEST:
        return []
    values = whole[rows]
    tolerance, least = _tolerances(values)
    smooth = _median_of(np.pad(values, _WINDOW // 2, mode="edge"))
    around = sliding_window_view(np.pad(smooth, _WINDOW // 2, mode="edge"), _WINDOW)
    rests = np.ptp(around, axis=1) <= tolerance
    runs = np.split(np.arange(len(rows)), np.flatnonzero(np.diff(rests.astype(np.int8))) + 1)
    found: list[NDArray[np.int64]] = []
    for run in (one for one in runs if rests[one[0]]):
        level = np.median(values[run])
        if found and abs(np.median(values[found[-1]]) - level) <= tolerance:
            found[-1] = np.append(found[-1], run)
        else:
            found.append(run)
    whole_ones = (_widened(run, values, tolerance, least) for run in found)
    kept = [run for run in whole_ones if len(run) >= _FEWEST]
    return [Plateau(rows[run], float(np.median(values[run]))) for run in kept]


def _stays(found: list[Plateau], count: int) -> list[Plateau]:
    """Plateaus without short stops on the way: less than a part of the usual stay at so many placements."""
    lengths = sorted((len(one.rows) for one in found), reverse=True)[:count]
    least = _STOP * float(np.median(lengths)) if lengths else 0.0
    return [one for one in found if len(one.rows) >= least]


def _median_of(values: Column) -> Column:
    return np.asarray(np.median(sliding_window_view(values, _WINDOW), axis=1))


def _tolerances(values: Column) -> tuple[float, float]:
    """How far rows at one place may be from each other, and at least, whatever they scatter [m]."""
    steps = np.abs(np.diff(values))
    scatter = MAD_TO_SD * float(np.median(steps)) / np.sqrt(2.0)
    coarse = steps[steps > 0.0] if float(np.mean(steps == 0.0)) > _COARSE else steps[:0]
    least = max(_LEAST, 2.0 * float(coarse.min()) if len(coarse) else 0.0)
    return max(_FAR * float(scatter), least), least


def _widened(run: NDArray[np.int64], values: Column, tolerance: float, least: float) -> NDArray[np.int64]:
    """Rows at a level, also those beside the ones at rest; without those that are far for this place."""
    near = np.abs(values - np.median(values[run])) <= tolerance
    first, last = int(run[0]), int(run[-1])
    while first > 0 and near[first - 1]:
        first -= 1
    while last + 1 < len(values) and near[last + 1]:
        last += 1
    inside = np.arange(first, last + 1)
    inside = inside[near[inside]]
    if not len(inside):
        return inside
    off = np.abs(values[inside] - np.median(values[inside]))
    return inside[off <= max(_OFF * MAD_TO_SD * float(np.median(off)), least)]
