"""Blocks of rows, and the folds that hold them out."""

from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from echocal.diagnose.findings.parts import HELD_OUT
from echocal.diagnose.preprocess.table import Table
from echocal.diagnose.preprocess.window import instant, times
from echocal.diagnose.settings.rows import RowSettings
from echocal.errors import UsageError
from echocal.observations import Observations

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
        Blocks that causes are selected on: all, except those that the user holds out.
    scheme : str
        How the blocks are held out, in words.
    known : dict
        Rows of blocks that were requested before.
    """

    blocks: Labels
    held: tuple[Mask, ...]
    fit: Mask
    scheme: str
    known: dict[bytes, Rows] = field(default_factory=dict, repr=False)

    @classmethod
    def of(
        cls, table: Table, observations: Observations, after: str | float | None, settings: RowSettings
    ) -> "Folds":
        """Hold out the rows that the user names; else cross-validate by stations or by runs of rows.

        In a cross-validation the causes are selected on all rows, and their sizes are fitted
        without the block that is held out. Rows that the user holds out take no part in either.
        """
        count = settings.folds
        held_out, held_text = _held_out(observations, table, after, settings.fewest)
        if held_out is not None:
            return cls(
                held_out.astype(np.int64), (np.array([False, True]),), np.array([True, False]), held_text
            )
        stations = 1 + int(table.groups.max())
        if table.reference is not None and stations >= count:
            blocks, by = table.groups % count, "station"
        else:
            blocks = np.arange(len(table)) * count // len(table)
            by = "time" if "elapsed_time" in table.conditions else "row order"
        held = tuple(np.arange(count) == fold for fold in range(count))
        return cls(
            blocks.astype(np.int64), held, np.ones(count, dtype=bool), f"blocked by {by}, {count} folds"
        )

    @property
    def judged(self) -> Mask:
        """Blocks that at least one fold holds out."""
        return np.asarray(np.any(self.held, axis=0))

    def rows(self, held: Mask) -> Rows:
        """Rows of the blocks in `held`: a slice where they are contiguous, which needs no copy."""
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


def _held_out(
    observations: Observations, table: Table, after: str | float | None, fewest: int
) -> tuple[Mask | None, str]:
    """Rows that the user holds out, and the scheme in words."""
    if after is None:
        return None, ""
    if isinstance(after, str):
        held = times(observations, after)[table.row] >= instant(after)
    else:
        elapsed = table.conditions.get("elapsed_time")
        if elapsed is None:
            message = "rows cannot be held out by time: the table has no column of times (map one to time_s)"
            raise UsageError(message)
        held = elapsed >= after
    judged = int(held.sum())
    if min(judged, len(held) - judged) < fewest:
        message = (
            f"with rows held out from {after} on, {len(held) - judged} rows are left to fit and {judged} to "
            f"validate; both numbers must be at least {fewest}"
        )
        raise UsageError(message)
    return held, f"{HELD_OUT} {after} on; causes are selected and fitted without them"
