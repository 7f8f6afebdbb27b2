"""Ruler values for the plateaus of a raw log: the rows in which the target stayed where it was placed."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from echocal.diagnose.preprocess.level_steps import level_steps
from echocal.diagnose.preprocess.outliers import robust
from echocal.diagnose.preprocess.reference import refuse_distance
from echocal.diagnose.settings.rows import RowSettings
from echocal.errors import DataError, UsageError
from echocal.keywords import keyword
from echocal.observations import Observations

__all__ = ["BETWEEN", "placed", "plateaus"]

Column = NDArray[np.float64]

BETWEEN = "between placements"
"""Why a row is left out."""

_SPEED = 343.0  # m/s: levels are only compared with each other
_FAR = 6.0  # robust sd of the readings at a plateau, beyond which a row is not at it
_LEAST = 3e-3  # m: what is nearer is the same place; a hand moves a target by more


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


def placed(observations: Observations, distances: Sequence[float], settings: RowSettings) -> Observations:
    """Give each plateau of a log the distance that the user read from a ruler, in the order of the log.

    Rows between two plateaus become unusable.

    Raises
    ------
    UsageError
        If the table has reference distances already, or a distance is none.
    DataError
        If the log has another number of plateaus, or they are not in this order.
    """
    for distance in distances:
        refuse_distance(distance)
    if observations.reference_distance is not None:
        column = observations.source_names.get("reference_distance", "reference_distance")
        message = (
            f"{keyword('placements')} gives a log its reference distances, and column '{column}' has some: "
            f"{keyword('columns', {column: 'ignore'})}, or leave the option out"
        )
        raise UsageError(message)
    found = plateaus(observations, settings)
    listed = "; ".join(map(str, found)) or "none"
    if len(found) != len(distances):
        message = (
            f"{keyword('placements')} lists {len(distances)} distances, and the log has {len(found)} "
            f"plateaus of at least {settings.fewest} rows: {listed}. Give one distance for each, in their order; rows "
            f"of no placement are left out with {keyword('since')} and {keyword('until')}"
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


def plateaus(observations: Observations, settings: RowSettings) -> list[Plateau]:
    """The rows between two steps of the level in which the target rested, in the order of the log."""
    reading = observations.reading
    whole = 0.5 * _SPEED * observations.echo_time if reading is None else reading
    rows = np.flatnonzero(observations.usable & np.isfinite(whole))
    elapsed, temperature = (
        None if (own := observations.conditions.get(name)) is None else own[rows]
        for name in ("elapsed_time", "temperature")
    )
    steps = level_steps(whole[rows], elapsed, temperature, settings)
    found: list[Plateau] = []
    for part in np.split(rows, steps):
        if len(part) < settings.fewest:
            continue
        level, scatter = robust(whole[part])
        near = part[np.abs(whole[part] - level) <= max(_FAR * scatter, _LEAST)]
        if len(near) < settings.fewest or _moves(whole[near], scatter):
            continue
        before = found[-1] if found else None
        if before and abs(before.level - level) <= max(_FAR * scatter, _LEAST):
            found[-1] = Plateau(np.append(before.rows, near), float(np.median(whole[[*before.rows, *near]])))
        else:
            found.append(Plateau(near, float(level)))
    return found


def _moves(values: Column, scatter: float) -> bool:
    """Whether the readings go from one end to the other: a target on its way, cut into steps."""
    third = len(values) // 3
    change = abs(float(np.median(values[-third:]) - np.median(values[:third])))
    steps = np.abs(np.diff(values))
    return change > max(scatter, _LEAST) and change > 3.0 * float(np.median(steps))
