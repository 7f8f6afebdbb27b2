"""A table made ready: usable rows, their reading, level and blocks."""

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from numbers import Real
from typing import Any

import numpy as np
from numpy.typing import NDArray

from echocal.conditions import QUANTITIES
from echocal.diagnose.preprocess.base import Base
from echocal.diagnose.preprocess.rows import (
    far_as_a_whole,
    far_from_stand,
    far_rows,
    level_steps,
    series_starts,
)
from echocal.errors import DataError, UsageError
from echocal.model import Model
from echocal.observations import Observations
from echocal.observations.quantiles import median
from echocal.observations.units import NAMES

__all__ = ["Table", "prepare", "refuse_distance"]

Column = NDArray[np.float64]
Labels = NDArray[np.int64]

FAR = "far from what its neighbors or the base simulation say"
OFF_STAND = "far from what the same target mostly read: another echo"
_FEWEST = 8  # rows below which nothing can be told


@dataclass(frozen=True)
class Table:
    """Usable rows of a table.

    Attributes
    ----------
    row : ndarray of int, shape (n,)
        Position in the source.
    indication : ndarray, shape (n,)
        Reading [m] with the base's speed of sound.
    reference : ndarray, shape (n,), or None
        Reference distance [m]; None where only known to be constant.
    conditions, extra : mapping of str to ndarray
    groups : ndarray of int, shape (n,)
        Stretch of constant level, or stand.
    starts : ndarray of bool, shape (n,)
        First rows of series.
    steps : ndarray of int
        Source rows at which the level jumps.
    unusable : mapping of str to int
        Rows left out, by reason.
    echoes : bool
        Whether the indication comes from recorded echo times, which the device's own arithmetic has
        not touched; also where the readings stand beside them.
    """

    row: Labels
    indication: Column
    reference: Column | None
    conditions: Mapping[str, Column]
    extra: Mapping[str, Column]
    groups: Labels
    starts: NDArray[np.bool_]
    steps: Labels
    unusable: Mapping[str, int]
    echoes: bool = False

    def __len__(self) -> int:
        return len(self.row)

    def distance(self, model: Model, rows: NDArray[np.bool_] | None = None) -> Column:
        """Distance of every row [m] if a model were right: the reference, or each group's median.

        Parameters
        ----------
        model : Model
        rows : ndarray of bool, optional
            Rows that the medians are taken over.
        """
        if self.reference is not None:
            return self.reference
        corrected = self.correct(model)
        return levels(
            corrected, self.groups, np.ones(len(self), dtype=bool) if rows is None else rows, np.median
        )

    def correct(
        self, model: Model, rows: NDArray[Any] | slice | None = None, out: Column | None = None
    ) -> Column:
        """Distance [m] by a model, of some rows or all, from the conditions that it reads."""
        reads = model.reads if model.shape is None else {*model.reads, model.shape.against}
        needed = {name: column for name, column in self.conditions.items() if name in reads}
        indication = self.indication
        if rows is not None:
            indication, needed = indication[rows], {name: column[rows] for name, column in needed.items()}
        if model.shape is None:
            return np.asarray(model.correct(indication, **needed, out=out))
        further = self.extra.get(model.shape.against) if model.shape.is_extra else None
        if further is not None:
            needed[model.shape.against] = further if rows is None else further[rows]
        corrected = np.asarray(model.correct(indication, **needed))
        if out is not None:
            out[:] = corrected
        return corrected

    def air(self) -> dict[str, float]:
        """Median of each recorded quantity of the air but the temperature, which every device has."""
        recorded = self.conditions.keys() & {"relative_humidity", "pressure", "co2_mole_fraction"}
        medians = {name: median(self.conditions[name]) for name in sorted(recorded)}
        return {name: float(f"{value:.6g}") for name, value in medians.items()}  # 63.4 % is 0.634

    def against(self) -> dict[str, Column]:
        """Columns that a remainder may be a function of, by the name a person knows."""
        return {**self.known(), **self.extra}

    def known(self) -> dict[str, Column]:
        """Those that are no further columns: influence quantities, distance, and time or row."""
        recorded = {n: c for n, c in self.conditions.items() if QUANTITIES[n].derived_from is None}
        columns = {"time" if name == "elapsed_time" else name: c for name, c in recorded.items()}
        if "time" not in columns:
            columns["row"] = (self.row + 1).astype(float)  # as messages count
        if self.reference is not None:
            columns["distance"] = self.reference
        return columns


def levels(values: Column, groups: Labels, rows: NDArray[np.bool_], center: object) -> Column:
    """Center of each group over `rows`, spread over all rows of the group; NaN for other groups."""
    result = np.full(len(values), np.nan)
    for group in np.unique(groups[rows]):
        member = groups == group
        result[member] = center(values[member & rows])  # type: ignore[operator]
    return result


def prepare(
    observations: Observations,
    base: Base,
    reference_distance: float | None,
    constant_distance: bool,
    more_steps: Sequence[int] = (),
) -> Table:
    """Leave out what cannot be used, find far rows, stretches and series.

    `more_steps` are source rows at which an unknown level is known to jump, besides those found.
    """
    if reference_distance is not None and constant_distance:
        raise UsageError("give either a reference distance or constant_distance, not both")
    reference = observations.reference_distance
    if reference_distance is not None:
        reference = np.full(len(observations), float(reference_distance))
    if constant_distance:
        reference = None
    elif reference is None:
        message = (
            "the table has no reference distance: map a column to distance_m, give --reference-distance M, "
            "or say --constant-distance where the target never moved"
        )
        raise UsageError(message)
    usable = observations.usable
    good = usable if reference is None else usable & np.isfinite(reference)
    kept = np.flatnonzero(good)
    indication = base.indication(
        some(observations.echo_time, kept), {k: some(v, kept) for k, v in observations.conditions.items()}
    )
    known = np.isfinite(indication)
    left_out = Counter(observations.unusable[~usable].tolist())
    left_out["no reference distance"] += int(usable.sum()) - len(kept)
    left_out["no reading can be computed"] += len(kept) - int(known.sum())
    if not known.all():
        kept, indication = kept[known], indication[known]
    return _arrange(observations, indication, reference, kept, left_out, more_steps)


def some(column: Column, rows: Labels) -> Column:
    """Some rows of a column; the column itself where that is all of them."""
    return column if len(rows) == len(column) else column[rows]


def refuse_distance(given: Any) -> None:
    """Refuse a reference distance that no target can have."""
    low, high = NAMES["distance_m"][0].physical
    if given is not None and not (isinstance(given, Real) and low < float(given) <= high):
        message = f"reference distance is {given} m; give {low:g} < distance <= {high:g}"
        raise UsageError(message)


def _arrange(
    observations: Observations,
    indication: Column,
    reference: Column | None,
    kept: Labels,
    left_out: Counter[str],
    more_steps: Sequence[int],
) -> Table:
    """Leave out wild rows of those that are kept, which have these indications; find series."""
    kept, indication, stands = _without_wild(observations, indication, reference, kept, left_out)
    unusable = {reason: count for reason, count in sorted(left_out.items()) if count}
    if len(kept) < _FEWEST:
        why = "".join(f", {count} {reason}" for reason, count in unusable.items())
        message = (
            f"a diagnosis needs at least {_FEWEST} usable rows; of {len(observations)}, {len(kept)} are{why}"
        )
        raise DataError(message)
    conditions = {name: some(column, kept) for name, column in observations.conditions.items()}
    elapsed = conditions.get("elapsed_time")
    moved = reference is None
    steps = (
        level_steps(indication, elapsed, conditions.get("temperature"))
        if moved
        else np.empty(0, dtype=np.int64)
    )
    if moved:
        steps = np.union1d(steps, np.searchsorted(kept, np.array(more_steps, dtype=np.int64)))
    breaks = np.zeros(len(kept), dtype=bool)
    breaks[steps] = True
    groups = np.cumsum(breaks) if stands is None else stands
    breaks[1:] |= groups[1:] != groups[:-1]
    return Table(
        row=kept,
        indication=indication,
        reference=None if reference is None else some(reference, kept),
        conditions=conditions,
        extra={name: some(column, kept) for name, column in observations.extra.items()},
        groups=groups.astype(np.int64),
        starts=series_starts(elapsed, breaks),
        steps=kept[steps],
        unusable=unusable,
        echoes=observations.reading is None or "echo_time" in observations.source_names,
    )


def _without_wild(
    observations: Observations,
    indication: Column,
    reference: Column | None,
    kept: Labels,
    left_out: Counter[str],
) -> tuple[Labels, Column, Labels | None]:
    """Rows that are not far from what they should be, their indications and their stands."""
    expected = None if reference is None else some(reference, kept)
    far = far_rows(indication, expected, lambda: _orders(observations, reference, kept))
    if reference is not None and far.any():
        far &= ~far_as_a_whole(far, _stands(observations, reference, kept))
    if far.any():
        left_out[FAR] += int(far.sum())
        kept, indication = kept[~far], indication[~far]
    stands = None
    if reference is not None and len(kept):
        temperature = observations.conditions.get("temperature")
        stands = _stands(observations, reference, kept)
        far = far_from_stand(indication, stands, None if temperature is None else some(temperature, kept))
        if far.any():
            left_out[OFF_STAND] += int(far.sum())
            kept, indication = kept[~far], indication[~far]
            stands = _stands(observations, reference, kept)
    return kept, indication, stands


def _orders(observations: Observations, reference: Column | None, kept: Labels) -> list[Column]:
    """Columns that neighbors are sought by: the row, and what a cause is most likely a function of."""
    columns = (reference, observations.conditions.get("temperature"))
    return [kept.astype(np.float64), *(some(column, kept) for column in columns if column is not None)]


def _stands(observations: Observations, reference: Column, kept: Labels) -> Labels:
    """Rows of one placement of the target: as recorded, else of one reference distance.

    Where nearly every row has a distance of its own, an error per stand is noise like any other.
    """
    import pandas as pd  # takes long to import

    labels = observations.labels.get("stand")
    source = some(reference, kept) if labels is None else labels[kept]
    groups = pd.factorize(source, sort=True)[0].astype(np.int64)
    return groups if 1 + groups.max() <= len(kept) // 3 else np.zeros_like(groups)
