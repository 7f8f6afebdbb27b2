"""Blocks of rows, and the folds that hold them out."""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from echocal.diagnose.preprocess.table import Table
from echocal.diagnose.settings.rows import RowSettings

__all__ = ["Folds", "Rows"]

Mask = NDArray[np.bool_]
Labels = NDArray[np.int64]
Rows = Mask | slice
"""Rows as a mask or as a slice."""


@dataclass(frozen=True)
class Folds:
    """Blocks of rows, and the folds that hold them out.

    Attributes
    ----------
    blocks : ndarray of int, shape (n,)
        Block of each row.
    held : tuple of ndarray of bool, shape (blocks,)
        Blocks held out, fold by fold.
    fit : ndarray of bool, shape (blocks,)
        Blocks that causes are selected on: all, but within a fold.
    scheme : str
        How the blocks are held out, in words.
    """

    blocks: Labels
    held: tuple[Mask, ...]
    fit: Mask
    scheme: str

    @classmethod
    def of(cls, table: Table, settings: RowSettings) -> "Folds":
        """Cross-validate by stations or by runs of rows."""
        count = settings.folds
        groups, reference = table.groups, table.reference
        if table.members is not None and reference is not None and not groups.any():
            # nearly every visit has a distance of its own
            groups = np.unique(reference, return_inverse=True)[1]
        if reference is not None and int(groups.max()) + 1 >= count:
            blocks, by = groups % count, table.grouped_by or "station"
        else:
            blocks = _runs(len(table), count)
            if table.reference is None:
                _divide_segments(blocks, table.groups, count)
            by = "time" if "elapsed_time" in table.conditions else "row order"
        used, blocks = np.unique(blocks, return_inverse=True)  # few rows may leave a block empty
        count = len(used)
        held = tuple(np.arange(count) == fold for fold in range(count))
        scheme = f"blocked by {by}, {count} folds"
        return cls(blocks.astype(np.int64), held, np.ones(count, dtype=bool), scheme)

    def of_rows(self, unit: Labels) -> "Folds":
        """The same folds of the rows of units; `unit` is that of each row."""
        return replace(self, blocks=self.blocks[unit])

    def within(self, blocks: Mask) -> "Folds":
        """The same folds where only these blocks may be seen."""
        held = tuple(fold & blocks for fold in self.held if (fold & blocks).any())
        return replace(self, held=held, fit=self.fit & blocks)

    @property
    def fitted(self) -> Mask:
        """Rows that causes are selected on, shape (n,)."""
        return np.asarray(self.fit[self.blocks])

    @property
    def judged(self) -> Mask:
        """Blocks that at least one fold holds out."""
        return np.asarray(np.any(self.held, axis=0))

    def rows(self, held: Mask) -> Rows:
        """Rows of the blocks in `held`: a slice where they are contiguous, which needs no copy."""
        mask = held[self.blocks]
        first, last = int(mask.argmax()), len(mask) - int(mask[::-1].argmax())
        return slice(first, last) if last - first == int(mask.sum()) else mask


def _runs(rows: int, count: int) -> Labels:
    """Contiguous runs of nearly equal length."""
    return np.arange(rows) * count // rows


def _divide_segments(blocks: Labels, groups: Labels, count: int) -> None:
    """Divide each segment that lies in one block into runs of its own.

    Otherwise no other row would have the level of a row that is held out, and it could not be judged.
    """
    firsts = np.flatnonzero(np.diff(groups, prepend=-1))
    for number, (first, end) in enumerate(zip(firsts, np.append(firsts[1:], len(groups)), strict=True)):
        if blocks[first] == blocks[end - 1]:
            turn = number if end - first < count else 0  # short segments together reach every block
            blocks[first:end] = (_runs(end - first, count) + turn) % count
