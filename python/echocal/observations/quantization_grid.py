"""The quantization grid of a column: its values are whole multiples of one step."""

from dataclasses import dataclass

import numpy as np

from echocal.arrays import Column

FINEST_STEP = 2e-5
"""Smallest step of a device's readings [m]; a smaller one comes from arithmetic."""

_ENOUGH = 4000  # rows that are enough to find the step
_FEWEST = 5  # rows; and distinct values that determine a grid with an offset
_PARTS = 12  # most steps in the smallest gap
_EXACT = 1e-6  # part of a step by which arithmetic and printing may move a value
_PRINTED = 1e-10  # relative error of a value that a formula has converted


@dataclass(frozen=True)
class QuantizationGrid:
    """Values that are whole multiples of a step, apart from an offset."""

    step: float
    distinct: int  # number of different values among the rows that were used
    rows: int  # number of rows that were used
    repeated: int | None = None
    """Rows that repeat a reading at its distance, where they alone are evidence of the step."""

    @property
    def evidence(self) -> float:
        """Log Bayes factor against continuous values, which hit the grid or repeat only by chance."""
        if self.repeated is not None:
            return min(self.repeated * 2.0, 60.0)
        return float(min((self.distinct - 3) * 6.0 + (self.rows - self.distinct) * 2.0, 60.0))


def find_grid(values: Column) -> QuantizationGrid | None:
    """Find the largest step of which all differences of values are multiples; NaN is a value that is missing.

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
    if len(gaps) + 1 < _FEWEST:  # few values: the values themselves must be multiples, too
        some = np.append(0.0, some)
    least = float(gaps.min())
    for part in range(1, _PARTS + 1):
        step = least / part
        if step < 100 * noise:
            return None
        refined = _fitted(some, step)
        if refined is not None:
            return QuantizationGrid(refined, len(gaps) + 1, len(looked_at))
    return None


def _fitted(values: Column, step: float) -> float | None:
    """The step that fits all values best, if no value is off the grid."""
    offsets = values - values[0]
    for _ in range(2):
        counts = np.round(offsets / step)
        if not counts.any():
            return None
        step = float(counts @ offsets / (counts @ counts))
    remainder = np.abs(offsets - step * np.round(offsets / step))
    limit = _EXACT * step + _PRINTED * float(np.abs(values).max())
    return step if float(remainder.max()) < limit else None
