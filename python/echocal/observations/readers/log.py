"""What the reader of a format gives: records, and what stands beside them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import pandas as pd

from echocal.errors import DataError
from echocal.observations.fields import shown
from echocal.observations.numbers import NO_NUMBER

__all__ = ["Log", "numeric"]


@dataclass
class Log:
    """Rows of a log.

    Attributes
    ----------
    records : sequence of mapping of str to object
        Values of each row, by column; an empty one where the row could not be read.
    units : dict of str to str
    notes : list of str
    corrupt : dict of int to str
        Reason of each row that could not be read.
    """

    records: Sequence[Mapping[str, Any]]
    units: dict[str, str] = field(default_factory=dict)
    notes: list[str] = field(default_factory=list)
    corrupt: dict[int, str] = field(default_factory=dict)

    def table(self) -> pd.DataFrame:
        """Columns in the order in which they appear; numbers where all values are such.

        Raises
        ------
        DataError
            If no row has a value.
        """
        names = dict.fromkeys(name for record in self.records for name in record)
        if not names:
            raise DataError("the log has no values")
        columns = {name: [record.get(name) for record in self.records] for name in names}
        if self.corrupt:
            first = min(self.corrupt)
            self.notes.append(
                f"{len(self.corrupt)} of {len(self.records)} lines have no values, first row {first + 1}: "
                f"'{shown(self.corrupt[first])}'"
            )
            self.corrupt = dict.fromkeys(self.corrupt, "line without values")
        return pd.DataFrame(
            {name: numeric(pd.Series(values, dtype=object)) for name, values in columns.items()}
        )


def numeric(values: pd.Series[Any]) -> pd.Series[Any]:
    """Numbers, if all values are such or say that there is none; else the values."""
    plain = values.map(lambda v: None if v is None or (isinstance(v, str) and v.strip() in NO_NUMBER) else v)
    if any(isinstance(v, bool) for v in plain):
        return values
    numbers = pd.to_numeric(plain, errors="coerce")
    return numbers if numbers.notna().sum() == plain.notna().sum() and plain.notna().any() else values
