"""The step of a column whose values are quantized: whole multiples of one step."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

__all__ = ["FINEST", "Lattice", "find_lattice"]

Column = NDArray[np.float64]

FINEST = 2e-5
"""Step of a reading below which arithmetic made it, not the device [m]."""

_ENOUGH = 4000  # distinct values that decide as well as all
_FEWEST = 5  # rows; and distinct values that a lattice is read from without a zero
_PARTS = 12  # the smallest gap may be this many steps
_EXACT = 1e-6  # part of a step that arithmetic and a printer's last digit leave
_PRINTED = 1e-10  # relative error of a value that went through a formula


@dataclass(frozen=True)
class Lattice:
    """Values that are whole multiples of a step, apart from an offset.

    Attributes
    ----------
    step : float
    distinct : int
        Different values among the rows that were looked at.
    rows : int
        Rows that were looked at.
    """

    step: float
    distinct: int
    rows: int

    @property
    def evidence(self) -> float:
        """Log Bayes factor against values anywhere: none would hit the lattice, or repeat, by chance."""
        return float(min((self.distinct - 3) * 6.0 + (self.rows - self.distinct) * 2.0, 60.0))


def find_lattice(values: Column) -> Lattice | None:
    """Find the largest step that all differences are multiples of.

    Parameters
    ----------
    values : ndarray, shape (n,)
        NaN where there is none.

    Returns
    -------
    Lattice or None
        None where values are not quantized, or too few differ.
    """
    known = np.isfinite(values)
    finite = values if known.all() else values[known]
    if len(finite) < _FEWEST:
        return None
    looked_at = finite[:: max(1, len(finite) // _ENOUGH)]
    some = np.unique(looked_at)
    noise = _PRINTED * float(np.abs(some).max())
    gaps = np.diff(some)
    gaps = gaps[gaps > 4 * noise]
    if not len(gaps):
        return None
    if len(gaps) + 1 < _FEWEST:  # few values: whole multiples of the step they must be, too
        some = np.append(0.0, some)
    least = float(gaps.min())
    for part in range(1, _PARTS + 1):
        step = least / part
        if step < 100 * noise:
            return None
        refined = _fitted(some, step)
        if refined is not None:
            return Lattice(refined, len(gaps) + 1, len(looked_at))
    return None


def _fitted(values: Column, step: float) -> float | None:
    """The step that fits all values best, if it leaves nothing over."""
    offsets = values - values[0]
    for _ in range(2):
        counts = np.round(offsets / step)
        if not counts.any():
            return None
        step = float(counts @ offsets / (counts @ counts))
    left = np.abs(offsets - step * np.round(offsets / step))
    limit = _EXACT * step + _PRINTED * float(np.abs(values).max())
    return step if float(left.max()) < limit else None
