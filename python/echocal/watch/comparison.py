"""What the corrected distance of each row is compared with, and which of several sensors has moved.

Of several sensors on one target, it is the one that is farthest from where it usually is. A row counts at
most three standard deviations in a test, so a sensor that moved by eight and another that is compared with
it, which seems to move by four, are told equally soon. Their distances from the median of all sensors are
not bounded, and tell them apart.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from echocal.watch.clock import Waiting
from echocal.watch.reference import Reference
from echocal.watch.rows import in_range
from echocal.watch.sensor import Done
from echocal.watch.state import State

_KEPT = 128
"""Rows of a target that are kept; judgement: a change is mostly told within fewer."""

_USUAL = 128
"""Rows that say where a sensor usually is; judgement."""


@dataclass
class Target:
    """The sensors of one target, and where each is beside the median of all."""

    latest: dict[str, list[float]] = field(default_factory=dict)  # of each sensor, its last row [s, m]
    paths: dict[str, list[list[float]]] = field(default_factory=dict)
    """Of each sensor: the number of the row among those of the target, its time [s], its distance from the
    median of all [m], the mean of this before the row, and how many rows this mean is of."""
    rows: int = 0  # rows of all sensors

    def add(self, sensor: str, time: float, distance: float, within: float) -> float:
        """Take one row in, and return the median of the other sensors; NaN where none has a fresh row.

        `within` is the age at which a row is not fresh any more [s].
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

        The rows count from `since` [s] up to the one of number `row`.
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


@dataclass
class Comparison:
    """The reference of each row: stated, recorded, or the other sensors of its target."""

    reference: Reference
    state: State  # keeps the targets
    _targets: dict[str, Target] = field(default_factory=dict)

    def give(self, rows: Sequence[Done]) -> None:
        """Give rows, in their order, the reference distance [m]; NaN where there is none."""
        kind = self.reference.kind
        for row in rows:
            if row.sensor is None:
                continue
            if kind == "distance":
                row.reference = float(self.reference.reference_distance or 0.0)
            elif kind == "constant":
                row.reference = row.distance
            elif kind == "others":
                self._compare(row, row.sensor.id)
            elif row.entry.columns is not None:
                source = row.entry.columns.plan.assignments.get("reference_distance")
                if source is not None:
                    row.reference = in_range(row.entry.numbers.get(source.column, math.nan), source)

    def _compare(self, row: Done, id_: str) -> None:
        name = str(row.entry.row.get(str(self.reference.same_target), ""))
        if row.status or math.isnan(row.distance) or math.isnan(row.entry.time) or not name:
            return
        if name not in self._targets:
            kept = self.state.fact(f"target {name}")
            self._targets[name] = Target() if kept is None else Target.restored(kept)
        target = self._targets[name]
        row.reference = target.add(id_, row.entry.time, row.distance, self.reference.within)
        row.target = name, target.rows

    def farthest(self, row: Waiting, since: float) -> str | None:
        """The sensor of a target that has moved farthest until a row of one of them."""
        return None if row.target is None else self._targets[row.target[0]].moved_most(since, row.target[1])

    def keep(self, rows: Sequence[Done]) -> None:
        """Keep the targets of rows; no earlier row is asked for any more."""
        for name in dict.fromkeys(row.target[0] for row in rows if row.target is not None):
            self._targets[name].forget()
            self.state.set_fact(f"target {name}", self._targets[name].to_dict())
