"""Rows that a diagnosis can use, and the reasons why the others are left out."""

from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from echocal.diagnose.preprocess.base import Base
from echocal.observations import Observations

__all__ = ["Usable", "some", "usable_rows"]

Column = NDArray[np.float64]
Labels = NDArray[np.int64]


@dataclass(frozen=True, eq=False)
class Usable:
    """Rows that are used.

    Attributes
    ----------
    rows : ndarray of int, shape (n,)
        Position in the source.
    indication : ndarray, shape (n,)
        Reading [m] with the base's speed of sound.
    left_out : mapping of str to int
        Rows that are not used, by reason.
    """

    rows: Labels
    indication: Column
    left_out: Mapping[str, int]


def usable_rows(observations: Observations, base: Base, reference: Column | None) -> Usable:
    """Find the rows with all values that a diagnosis needs.

    Parameters
    ----------
    observations : Observations
    base : Base
    reference : ndarray, shape (total,), or None
        Reference distance of every row [m]; None where it is not known.
    """
    usable = observations.usable
    good = usable if reference is None else usable & np.isfinite(reference)
    rows = np.flatnonzero(good)
    indication = base.indication(
        some(observations.echo_time, rows), {k: some(v, rows) for k, v in observations.conditions.items()}
    )
    known = np.isfinite(indication)
    left_out = Counter(observations.unusable[~usable].tolist())
    left_out["no reference distance"] += int(usable.sum()) - len(rows)
    left_out["no reading can be computed"] += len(rows) - int(known.sum())
    if not known.all():
        rows, indication = rows[known], indication[known]
    return Usable(rows, indication, +left_out)


def some(column: Column, rows: Labels) -> Column:
    """Some rows of a column; the column itself where that is all of them."""
    return column if len(rows) == len(column) else column[rows]
