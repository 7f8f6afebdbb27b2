"""Penalized cubic splines (P-splines) of one column, for the smooth correction."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import BSpline

from echocal.diagnose.candidates.unexplained_terms import VALUES_PER_DEGREE, column_of
from echocal.diagnose.preprocess.table import Table
from echocal.diagnose.settings.priors import TermSettings
from echocal.model.shape import DISTANCE
from echocal.observations.quantiles import quantiles, spread
from echocal.quantities import BY_COLUMN

__all__ = ["HOUR_ANGLE", "Spline", "splines"]

Column = NDArray[np.float64]

HOUR_ANGLE = "hour_angle"
"""Quantity of the local clock, which later readings have, too."""

_DEGREE = 3
_PIECES = 10  # over the range of a column; the penalty decides how smooth it is
_FEWEST_PIECES = 3
_ENOUGH = 50_000  # rows that show how many distinct values there are
_LONGEST_GAP = 1.5  # h without rows, with which a column of hours has no smooth function of the day
_NOT_LATER = frozenset({"row", "time"})
"""Columns that no later reading shares."""


@dataclass(frozen=True)
class Spline:
    """Basis functions of one column: cubic B-splines on knots with equal spacing.

    Attributes
    ----------
    against : str
        ``"distance"``, an influence quantity, or a further column.
    low, high : float
        Range of the column, in its unit.
    periodic : bool
        Whether both ends are one place, as midnight is.
    """

    against: str
    low: float
    high: float
    pieces: int
    periodic: bool = False

    def at(self, values: Column) -> Column:
        """Basis functions, shape (n, k); values outside of the range are set on its end."""
        step = (self.high - self.low) / self.pieces
        knots = self.low + step * np.arange(-_DEGREE, self.pieces + _DEGREE + 1)
        inside = np.clip(values, knots[_DEGREE], knots[-_DEGREE - 1])
        design = BSpline.design_matrix(inside, knots, _DEGREE).toarray()
        if self.periodic:
            design[:, :_DEGREE] += design[:, self.pieces :]
            design = design[:, : self.pieces]
        return np.asarray(design)

    @property
    def penalty(self) -> Column:
        """Products of the second differences of the coefficients, shape (k, k)."""
        width = self.pieces if self.periodic else self.pieces + _DEGREE
        second = np.diff(np.eye(width), 2, axis=0)
        if self.periodic:
            second = (
                np.roll(np.eye(width), 1, axis=1) - 2 * np.eye(width) + np.roll(np.eye(width), -1, axis=1)
            )
        return np.asarray(second.T @ second)


def splines(table: Table, tried: Mapping[str, object], terms: TermSettings) -> tuple[Spline, ...]:
    """Splines against the columns that unexplained terms are tried for and that later readings have.

    Parameters
    ----------
    tried : mapping
        Names of columns of unexplained terms, as people read them.
    """
    found = []
    for name in tried:
        if name in _NOT_LATER:
            continue
        if name == "hour of day":
            found += _of_the_day(table)
            continue
        column = column_of(name, table.against())
        low, high = quantiles(spread(column), terms.range)
        distinct = len(np.unique(column[:_ENOUGH]))
        pieces = min(_PIECES, distinct // VALUES_PER_DEGREE)
        if high > low and pieces >= _FEWEST_PIECES:
            found.append(Spline(name if name == DISTANCE else _quantity(name), low, high, pieces))
    return tuple(found)


def _of_the_day(table: Table) -> list[Spline]:
    """A periodic spline of the local clock, if rows are at all hours."""
    if HOUR_ANGLE not in table.conditions:
        return []
    angles = np.unique(table.conditions[HOUR_ANGLE])
    gap = np.diff(np.append(angles, angles[0] + 2 * np.pi)).max() if len(angles) else np.inf
    if not gap <= _LONGEST_GAP * np.pi / 12:
        return []
    return [Spline(HOUR_ANGLE, -np.pi, np.pi, _PIECES, periodic=True)]


def _quantity(name: str) -> str:
    return BY_COLUMN[name].id if name in BY_COLUMN else name
