"""What the corrected distance of each row is compared with."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, field

from echocal.watch.clock import Waiting
from echocal.watch.reference import Reference
from echocal.watch.rows import in_range
from echocal.watch.sensor import Done
from echocal.watch.state import State
from echocal.watch.target import Target

__all__ = ["Comparison"]


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
