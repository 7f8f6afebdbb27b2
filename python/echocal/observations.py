"""Measured data in SI units, every row accounted for."""

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

__all__ = ["Observations"]

Column = NDArray[np.float64]


@dataclass(frozen=True)
class Observations:
    """A table of echoes in SI units: as many rows as its source, in the same order.

    Attributes
    ----------
    echo_time : ndarray, shape (n,)
        Recorded echo time, out and back [s]. Where the source has readings instead, this is
        ``2 reading / c`` with the speed that the firmware used.
    conditions : mapping of str to ndarray, shape (n,)
        Recorded influence quantities by name (see `echocal.conditions.QUANTITIES`), only those
        that the source has.
    reference_distance : ndarray, shape (n,), or None
        Reference distance [m]; None where the source has none.
    labels : mapping of str to ndarray, shape (n,)
        Integer codes of ``stand``, ``group`` and ``order``, where the source has them.
    extra : mapping of str to ndarray, shape (n,)
        Further numeric columns as they stand: candidates for "unknown, against column X".
    unusable : ndarray of str, shape (n,)
        Reason code for each row that cannot be used; empty for a usable row.
    source_names : mapping of str to str
        Name of the source's column by quantity, for messages and plots.
    """

    echo_time: Column
    conditions: Mapping[str, Column]
    reference_distance: Column | None
    unusable: NDArray[np.str_]
    labels: Mapping[str, NDArray[np.int64]] = field(default_factory=dict)
    extra: Mapping[str, Column] = field(default_factory=dict)
    source_names: Mapping[str, str] = field(default_factory=dict)

    def __len__(self) -> int:
        return len(self.echo_time)

    @property
    def usable(self) -> NDArray[np.bool_]:
        """Which rows can be used, shape (n,)."""
        return np.asarray(self.unusable == "", dtype=np.bool_)
