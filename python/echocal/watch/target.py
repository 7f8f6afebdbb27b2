"""Which of several sensors on one target has moved: the one that is farthest from where it usually is.

A row counts at most three standard deviations in a test, so a sensor that moved by eight and another that is
compared with it, which seems to move by four, are told equally soon. Their distances from the median of all
sensors are not bounded, and tell them apart.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np

__all__ = ["Target"]

_KEPT = 128
"""Rows of a target that are kept; judgement: a change is mostly told within fewer."""

_USUAL = 128
"""Rows that say where a sensor usually is; judgement."""


@dataclass
class Target:
    """The sensors of one target, and where each is beside the median of all.

    Attributes
    ----------
    latest : dict of str to (time, distance)
        Of each sensor, its last row [s, m].
    paths : dict of str to list of (row, time, deviation, usual, weight)
        Of each sensor: the number of the row among those of the target, its time [s], its distance from the
        median of all [m], the mean of this before the row, and how many rows this mean is of.
    rows : int
        Rows of all sensors.
    """

    latest: dict[str, list[float]] = field(default_factory=dict)
    paths: dict[str, list[list[float]]] = field(default_factory=dict)
    rows: int = 0

    def add(self, sensor: str, time: float, distance: float, within: float) -> float:
        """Take one row in, and return the median of the other sensors; NaN where none has a fresh row.

        Parameters
        ----------
        within : float
            Age at which a row is not fresh any more [s].
        """
        fresh = {
            id_: value
            for id_, (when, value) in self.latest.items()
            if id_ != sensor and 0.0 <= time - when <= within
        }
        self.rows += 1
        if len(fresh) > 1:
            middle = float(np.median([*fresh.values(), distance]))
            for id_, value in {**fresh, sensor: distance}.items():
                self._step(id_, time, value - middle)
        self.latest[sensor] = [time, distance]
        return float(np.median(list(fresh.values()))) if fresh else float("nan")

    def _step(self, sensor: str, time: float, deviation: float) -> None:
        path = self.paths.setdefault(sensor, [])
        usual, weight = deviation, 1.0
        if path:
            _, _, before, mean, weight = path[-1]
            usual, weight = mean + (before - mean) / weight, min(weight + 1.0, float(_USUAL))
        path.append([float(self.rows), time, deviation, usual, weight])

    def moved_most(self, since: float, row: int) -> str | None:
        """The sensor that is farthest from where it was before a time; None if there are not three.

        Parameters
        ----------
        since : float
            Time of the first row that counts [s].
        row : int
            Number of the last row that counts.
        """
        moved = {}
        for sensor, path in self.paths.items():
            own = [step for step in path if step[0] <= row][-_KEPT:]
            after = [step for step in own if step[1] >= since] or own[-1:]
            if after:
                moved[sensor] = abs(float(np.mean([step[2] for step in after])) - after[0][3])
        return max(moved, key=lambda sensor: moved[sensor]) if moved else None

    def forget(self) -> None:
        """Keep the last rows only; called when no earlier row is asked for any more."""
        for path in self.paths.values():
            del path[:-_KEPT]

    def to_dict(self) -> dict[str, Any]:
        """As plain data, exactly."""
        return {"latest": self.latest, "paths": self.paths, "rows": self.rows}

    @classmethod
    def restored(cls, kept: Mapping[str, Any]) -> "Target":
        """Continue where `to_dict` was called."""
        return cls(dict(kept["latest"]), dict(kept["paths"]), kept["rows"])
