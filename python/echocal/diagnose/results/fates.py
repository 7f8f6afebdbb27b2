"""What became of each row of the source."""

from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from echocal.diagnose.preprocess.hold_out import HELD_OUT_ROW
from echocal.diagnose.preprocess.table import Table

__all__ = ["USED", "Fates"]

USED = "used"
"""Fate of a row that causes are chosen and fitted on."""


@dataclass(frozen=True, eq=False)
class Fates:
    """What became of each row of the source.

    Attributes
    ----------
    fate : ndarray of str, shape (n,)
        ``used``, ``held out``, or the reason why the row is left out.
    """

    fate: NDArray[np.object_]

    @classmethod
    def of(cls, table: Table, held: Table | None) -> "Fates":
        """The fates of the rows of a table, and of those that are held out."""
        fate = np.full(table.total, USED, dtype=object)
        for one in [table] if held is None else [table, held]:
            for reason, rows in one.left_out.items():
                fate[rows] = reason
        if held is not None:  # also those that a repair has made usable
            fate[held.rows.row] = HELD_OUT_ROW
        return cls(fate)

    @cached_property
    def counts(self) -> Mapping[str, int]:
        """Rows that are left out, by reason."""
        others = Counter(self.fate[self.fate != USED].tolist())
        return {reason: count for reason, count in sorted(others.items()) if reason != HELD_OUT_ROW}

    @property
    def used(self) -> int:
        """Number of rows that causes are chosen on or judged by."""
        return len(self.fate) - sum(self.counts.values())

    def columns(self, row: NDArray[np.int64], **values: NDArray[Any]) -> dict[str, NDArray[Any]]:
        """Number and fate of every row of the source, and values of some, NaN for the others."""
        columns: dict[str, NDArray[Any]] = {"row": np.arange(1, len(self.fate) + 1), "fate": self.fate}
        for name, some in values.items():
            columns[name] = np.full(len(self.fate), np.nan)
            columns[name][row] = some
        return columns
