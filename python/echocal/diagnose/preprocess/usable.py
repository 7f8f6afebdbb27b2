"""Rows that a diagnosis can use, and the reasons why the others are left out."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from echocal.diagnose.preprocess.base import Base
from echocal.observations import Observations

__all__ = ["Usable", "some", "usable_rows"]

Column = NDArray[np.float64]
Labels = NDArray[np.int64]
Mask = NDArray[np.bool_]


@dataclass(frozen=True, eq=False)
class Usable:
    """Rows that are used.

    Attributes
    ----------
    rows : ndarray of int, shape (n,)
        Position in the source.
    indication : ndarray, shape (n,)
        Reading [m] with the base's speed of sound.
    left_out : mapping of str to ndarray of int
        Positions in the source of the rows that are not used, by reason.
    """

    rows: Labels
    indication: Column
    left_out: Mapping[str, Labels]

    def without(self, far: Mask, reason: str) -> "Usable":
        """The same rows without some of them."""
        left_out = {**self.left_out, reason: self.rows[far]}
        return Usable(self.rows[~far], self.indication[~far], left_out)


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
    bad = np.flatnonzero(~usable)
    reasons = observations.unusable[bad]
    left_out = {str(reason): bad[reasons == reason] for reason in np.unique(reasons)}
    if len(unknown := np.flatnonzero(usable & ~good)):
        left_out["no reference distance"] = unknown
    found = Usable(rows, indication, left_out)
    return found if known.all() else found.without(~known, "no reading can be computed")


def some(column: Column, rows: Labels) -> Column:
    """Some rows of a column; the column itself where that is all of them."""
    return column if len(rows) == len(column) else column[rows]
