"""Steps of an unknown level, as a person wants them: when, and how large."""

from dataclasses import dataclass

import numpy as np

from echocal.diagnose.preprocess.scene import Table
from echocal.diagnose.results.result import Diagnosis
from echocal.observations import Observations

__all__ = ["LevelStep", "further_step", "steps_of"]

_WINDOW = 13  # rows on each side whose medians tell the size


@dataclass(frozen=True)
class LevelStep:
    """A jump of the level.

    Attributes
    ----------
    row : int
        First row of the new stretch; row 1 is the first, as in messages.
    time : str or None
        Its time, ISO 8601 in UTC.
    size_m : float
        New level less old [m].
    """

    row: int
    time: str | None
    size_m: float

    def __str__(self) -> str:
        when = "" if self.time is None else f", {self.time[:16].replace('T', ' ')}"
        return f"row {self.row}{when}: {1e3 * self.size_m:+.1f} mm"


def steps_of(table: Table, observations: Observations) -> tuple[LevelStep, ...]:
    """Describe the steps that were found in a table."""
    steps = []
    for row in table.steps.tolist():
        at = int(np.searchsorted(table.row, row))
        before = table.indication[max(0, at - _WINDOW) : at]
        after = table.indication[at : at + _WINDOW]
        time = None if observations.time is None else str(observations.time[row].astype("datetime64[s]"))
        steps.append(LevelStep(row + 1, time, float(np.median(after) - np.median(before))))
    return tuple(steps)


def further_step(table: Table, diagnosis: Diagnosis) -> int | None:
    """Source row at which an unknown level jumps, where the evidence names a step and stretches have none.

    A step of a level that nobody knows is no error of the sensor: the stretch ends there.
    """
    if table.reference is not None:
        return None
    found = (c for c in diagnosis.causes if c.id == "step_change" and c.in_model)
    cause = next(found, None)
    if cause is None:
        return None
    time = next(p.value for p in cause.parameters if p.name == "time")
    later = np.flatnonzero(table.conditions["elapsed_time"] > time)
    return None if not len(later) or table.row[later[0]] in table.steps else int(table.row[later[0]])
