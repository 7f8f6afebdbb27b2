"""Steps of an unknown level: when they occur, and how large they are."""

from dataclasses import dataclass

import numpy as np

from echocal.diagnose.preprocess.table import Table
from echocal.observations import Observations

__all__ = ["LevelStep", "steps_of"]

_WINDOW = 13  # rows on each side; the medians of both sides give the size
_SURE = 0.995  # a larger probability is not told


@dataclass(frozen=True)
class LevelStep:
    """A step of the level.

    Attributes
    ----------
    row : int
        First row of the new segment, counted from 1 as in messages.
    time : str or None
        Its time, ISO 8601 in UTC.
    size_m : float
        New level less old [m].
    probability : float
        That the level steps here, beside the causes.
    """

    row: int
    time: str | None
    size_m: float
    probability: float = 1.0

    def __str__(self) -> str:
        when = "" if self.time is None else f", {self.time[:16].replace('T', ' ')}"
        sure = "" if self.probability > _SURE else f", probability {self.probability:.2f}"
        return f"row {self.row}{when}: {1e3 * self.size_m:+.1f} mm{sure}"


def steps_of(table: Table, observations: Observations) -> tuple[LevelStep, ...]:
    """Describe the steps that were found in a table."""
    steps = []
    for row in table.steps.tolist():
        at = int(table.places(np.array([row]))[0])
        before = table.indication[max(0, at - _WINDOW) : at]
        after = table.indication[at : at + _WINDOW]
        time = None if observations.time is None else str(observations.time[row].astype("datetime64[s]"))
        size = float(np.median(after) - np.median(before))
        steps.append(LevelStep(row + 1, time, size, table.step_probability.get(row, 1.0)))
    return tuple(steps)
