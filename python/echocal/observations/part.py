"""A part of a table: what only the whole table can tell is counted, and decided when all parts are read."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np

from echocal.arrays import Column
from echocal.observations.checks import impossible
from echocal.observations.fields import fields
from echocal.observations.numbers import Damage
from echocal.observations.plan import Assignment

if TYPE_CHECKING:
    import pandas as pd


@dataclass
class Seen:
    """Counts of a column, from which follows whether its median is ordinary."""

    # rows, finite, possible: rows; those with a number; those of them whose number can be
    rows: int = 0
    finite: int = 0
    possible: int = 0
    # below, above: possible numbers below and above the usual range of the quantity
    below: int = 0
    above: int = 0
    damage: Damage = field(default_factory=Damage)  # texts that are no numbers

    def __iadd__(self, other: "Seen") -> "Seen":
        for name in vars(self):
            setattr(self, name, getattr(self, name) + getattr(other, name))
        return self

    @property
    def doubtful(self) -> bool:
        """Whether the whole column must be looked at: it may have no value, or be in another unit."""
        if not self.finite or self.damage.is_refused(self.rows):
            return self.rows > 0
        if not self.below and not self.above and self.possible == self.finite:
            return False
        return 2 * self.possible < self.finite or 2 * max(self.below, self.above) >= self.possible


@dataclass
class Part:
    """What a part of a table needs to know of the whole, and what it counts for it."""

    start: np.datetime64 | float | None = None
    """Earliest time of the whole log: an instant in UTC, or a number in s. None: that of this part."""
    derived: Mapping[str, Column] = field(default_factory=dict)
    """Quantities that are derived from several rows; shape (n,)."""
    counted: slice = field(default_factory=lambda: slice(None))
    """Rows to count; the others are neighbors, which belong to another part."""
    seen: dict[str, Seen] = field(default_factory=dict)
    """By column."""
    disagreeing: list[int] = field(default_factory=lambda: [0, 0])
    """Rows whose echo time and reading disagree, and rows that have both."""
    damage: dict[str, Damage] = field(default_factory=dict)
    """Texts that are no numbers, by column."""

    def count_damage(self, column: str, values: "pd.Series[Any]", places: list[int]) -> None:
        """Take what texts of a column are no numbers, before its values are counted."""
        own = range(len(values))[self.counted]
        inside = [place for place in places if place in own]
        self.damage[column] = Damage.of(fields(values.iloc[inside], column)) if inside else Damage()

    def count(self, source: Assignment, values: Column, ends: tuple[float, float]) -> None:
        """Count the values of a column, in its own unit."""
        form, unit, damage = source.form, source.unit, self.damage.get(source.column, Damage())
        values = values[self.counted]
        low, high = form.typical or form.physical
        if all(low <= unit.to_si(end) <= high for end in ends):
            finite = len(values) - int(np.count_nonzero(np.isnan(values)))
            self.seen[source.column] = Seen(len(values), finite, finite, damage=damage)
            return
        with np.errstate(invalid="ignore"):
            possible = ~impossible(values, ends, source)[0]
            si = unit.to_si(values)
            below, above = possible & (si < low), possible & (si > high)
        masks = (np.isfinite(values), possible & np.isfinite(values), below, above)
        finite, able, low_ones, high_ones = (int(np.count_nonzero(mask)) for mask in masks)
        self.seen[source.column] = Seen(len(values), finite, able, low_ones, high_ones, damage)
