"""Which rows are held out together."""

from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from echocal.diagnose.preprocess.scene import Table

__all__ = ["Folds", "Rows"]

Mask = NDArray[np.bool_]
Labels = NDArray[np.int64]
Rows = Mask | slice
"""Rows by a mask, or by where they begin and end."""

_FOLDS = 5


@dataclass(frozen=True)
class Folds:
    """Which rows are held out together.

    Attributes
    ----------
    blocks : ndarray of int, shape (n,)
        Block of each row.
    held : tuple of ndarray of bool, shape (blocks,)
        Blocks held out, fold by fold.
    fit : ndarray of bool, shape (blocks,)
        Blocks that causes are chosen from: all, except what the user held out.
    scheme : str
        In words.
    known : dict
        Rows of blocks asked for before.
    """

    blocks: Labels
    held: tuple[Mask, ...]
    fit: Mask
    scheme: str
    known: dict[bytes, Rows] = field(default_factory=dict, repr=False)

    @classmethod
    def of(cls, table: Table, held_out: Mask | None, held_text: str = "") -> "Folds":
        """Hold out what the user says; else stands in turn, or runs of rows in turn."""
        if held_out is not None:
            return cls(
                held_out.astype(np.int64), (np.array([False, True]),), np.array([True, False]), held_text
            )
        stands = 1 + int(table.groups.max())
        if table.reference is not None and stands >= _FOLDS:
            blocks, by = table.groups % _FOLDS, "stand"
        else:
            blocks = np.arange(len(table)) * _FOLDS // len(table)
            by = "time" if "elapsed_time" in table.conditions else "row order"
        held = tuple(np.arange(_FOLDS) == fold for fold in range(_FOLDS))
        return cls(
            blocks.astype(np.int64), held, np.ones(_FOLDS, dtype=bool), f"blocked by {by}, {_FOLDS} folds"
        )

    @property
    def judged(self) -> Mask:
        """Blocks that some fold holds out."""
        return np.asarray(np.any(self.held, axis=0))

    def rows(self, held: Mask) -> Rows:
        """Rows of the blocks in `held`: a slice where they follow each other, so that none is copied."""
        key = held.tobytes()
        if key not in self.known:
            self.known[key] = self._run(held) if self._ascending else self._mask(held)
        return self.known[key]

    @cached_property
    def _ascending(self) -> bool:
        """Whether the rows of each block follow those of the block before."""
        return bool((self.blocks[1:] >= self.blocks[:-1]).all())

    def _run(self, held: Mask) -> Rows:
        """Rows of blocks, where blocks ascend."""
        first, last = int(held.argmax()), len(held) - 1 - int(held[::-1].argmax())
        if not held[first : last + 1].all():
            return np.asarray(held[self.blocks])
        return slice(int(self.blocks.searchsorted(first)), int(self.blocks.searchsorted(last, side="right")))

    def _mask(self, held: Mask) -> Rows:
        mask = held[self.blocks]
        first, last = int(mask.argmax()), len(mask) - int(mask[::-1].argmax())
        return slice(first, last) if last - first == int(mask.sum()) else mask
