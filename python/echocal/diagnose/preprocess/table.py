"""The table of a diagnosis: usable rows, their readings and their grouping."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from echocal.diagnose.preprocess.order import Order
from echocal.model import Model
from echocal.model.shape import is_extra
from echocal.observations.quantiles import median
from echocal.quantities import AIR, QUANTITIES

__all__ = ["Members", "Table", "levels"]

Column = NDArray[np.float64]
Labels = NDArray[np.int64]


@dataclass(frozen=True, eq=False)
class Members:
    """The rows that the lines of a table are means of.

    Attributes
    ----------
    rows : Table
    unit : ndarray of int, shape (n,)
        Line that each of them belongs to.
    """

    rows: "Table"
    unit: Labels


@dataclass(frozen=True)
class Table:
    """Usable rows of a table, or units of them: means over rows that are no independent measurements.

    Attributes
    ----------
    row : ndarray of int, shape (n,)
        Position in the source.
    indication : ndarray, shape (n,)
        Reading [m] with the base's speed of sound.
    reference : ndarray, shape (n,), or None
        Reference distance [m]; None where only known to be constant.
    conditions, extra, thermometers : mapping of str to ndarray
    groups : ndarray of int, shape (n,)
        Segment of constant level, or station.
    starts : ndarray of bool, shape (n,)
        First rows of series.
    steps : ndarray of int
        Source rows at which the level jumps.
    left_out : mapping of str to ndarray of int
        Positions in the source of the rows that are left out, by reason.
    total : int
        Rows of the source.
    echoes : bool
        Whether the indication comes from recorded echo times, which the arithmetic of the device
        does not change; also if readings are recorded, too.
    stated_speed : str
        Speed of the device that the user states, as a law or in m/s: its arithmetic is known. Empty where
        the speed is that of the base.
    labels : mapping of str to ndarray of int, shape (n,)
        Codes of ``stand``, ``group`` and columns of text; -1 where empty.
    grouped_by : str
        Column whose levels the groups are, where they are not segments or stations.
    placements : ndarray of int, shape (n,), or None
        Placement of the target of each row where the distance is unknown: `groups` before the level steps.
    step_probability : mapping of int to float
        Probability of the steps that were weighed beside causes, by source row.
    rounding : float
        Standard deviation of the error of rounding of a reading [m]; 0 where the readings have no step.
    members : Members or None
        The rows of each unit; None where each row is a unit.
    """

    row: Labels
    indication: Column
    reference: Column | None
    conditions: Mapping[str, Column]
    extra: Mapping[str, Column]
    groups: Labels
    starts: NDArray[np.bool_]
    steps: Labels
    left_out: Mapping[str, Labels]
    total: int
    echoes: bool = False
    thermometers: Mapping[str, Column] = field(default_factory=dict)
    stated_speed: str = ""
    labels: Mapping[str, Labels] = field(default_factory=dict)
    grouped_by: str = ""
    placements: Labels | None = None
    step_probability: Mapping[int, float] = field(default_factory=dict)
    rounding: float = 0.0
    members: Members | None = None

    def __len__(self) -> int:
        return len(self.row)

    @property
    def rows(self) -> "Table":
        """The rows themselves."""
        return self if self.members is None else self.members.rows

    @cached_property
    def unit(self) -> Labels:
        """Unit of each of these rows."""
        return np.arange(len(self)) if self.members is None else self.members.unit

    @cached_property
    def deviation(self) -> Column:
        """Reading of each of these rows less that of its unit [m]."""
        return np.asarray(self.rows.indication - self.indication[self.unit])

    def means(self, values: Column) -> Column:
        """Mean over the rows of each unit; NaN where one of them is not known."""
        if self.members is None:
            return values
        return np.asarray(np.bincount(self.unit, values) / np.bincount(self.unit))

    def places(self, rows: Labels) -> Labels:
        """Places of source rows, of which the newest may come first."""
        order = np.argsort(self.row, kind="stable")
        return np.asarray(order[np.searchsorted(self.row, rows, sorter=order)])

    @cached_property
    def order(self) -> Order:
        """The grouping of the rows."""
        distance = self.indication if self.reference is None else self.reference
        return Order(self.starts, self.groups, distance, flat_level=self.reference is None)

    def distance(self, model: Model, rows: NDArray[np.bool_] | None = None) -> Column:
        """Distance of every row [m]: the reference, or the median of each group by a model.

        Parameters
        ----------
        model : Model
        rows : ndarray of bool, optional
            Rows that the medians include; default: all.
        """
        if self.reference is not None:
            return self.reference
        corrected = self.correct(model)
        return levels(
            corrected, self.groups, np.ones(len(self), dtype=bool) if rows is None else rows, np.median
        )

    def bound(self, model: Model) -> dict[str, Column]:
        """Quantities that a model reads from further thermometers."""
        return {quantity: self.thermometers[name] for quantity, name in model.columns.items()}

    def correct(
        self, model: Model, rows: NDArray[Any] | slice | None = None, out: Column | None = None
    ) -> Column:
        """Readings of some or all rows, corrected by a model [m]."""
        own = () if model.shape is None else model.shape.columns
        reads = {*model.reads, *own}
        given = {**self.conditions, **self.bound(model)}
        needed = {name: column for name, column in given.items() if name in reads}
        indication = self.indication
        if rows is not None:
            indication, needed = indication[rows], {name: column[rows] for name, column in needed.items()}
        if model.shape is None:
            return np.asarray(model.correct(indication, **needed, out=out))
        for name in own:
            if name in self.extra and is_extra(name):
                needed[name] = self.extra[name] if rows is None else self.extra[name][rows]
        corrected = np.asarray(model.correct(indication, **needed))
        if out is not None:
            out[:] = corrected
        return corrected

    def air(self) -> dict[str, float]:
        """Median of the recorded humidity, pressure and CO2."""
        recorded = self.conditions.keys() & {*AIR} - {"temperature"}
        medians = {name: median(self.conditions[name]) for name in sorted(recorded)}
        return {name: float(f"{value:.6g}") for name, value in medians.items()}  # 63.4 % is 0.634

    def against(self) -> dict[str, Column]:
        """Columns that a residual may depend on, by their names for people."""
        return {**self.known, **self.extra}

    @cached_property
    def known(self) -> dict[str, Column]:
        """Those with a known meaning: influence quantities, distance, and time or row."""
        recorded = {n: c for n, c in self.conditions.items() if QUANTITIES[n].derived_from is None}
        columns = {QUANTITIES[name].column: c for name, c in recorded.items()}
        if "time" not in columns:
            columns["row"] = (self.row + 1).astype(float)  # as messages count
        if self.reference is not None:
            columns["distance"] = self.reference
        return columns


def levels(values: Column, groups: Labels, rows: NDArray[np.bool_], center: object) -> Column:
    """Center of each group over `rows`, for all rows of the group; NaN for groups without such rows."""
    result = np.full(len(values), np.nan)
    for group in np.unique(groups[rows]):
        member = groups == group
        result[member] = center(values[member & rows])  # type: ignore[operator]
    return result
