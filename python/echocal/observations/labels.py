"""Columns that say which rows belong together."""

from __future__ import annotations

from typing import Any

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from echocal.errors import DataError
from echocal.observations.numbers import row

__all__ = ["codes", "positions"]


def codes(values: pd.Series[Any]) -> NDArray[np.int64]:
    """Number the distinct values in the order in which they appear; -1 where empty."""
    filled = values.where(values.notna() & (values.astype(str).str.strip() != ""))
    return np.asarray(pd.factorize(filled)[0], dtype=np.int64)


def positions(values: pd.Series[Any], column: str) -> NDArray[np.int64]:
    """Whole numbers, bare or as the only number of a text (``Obs. 3``); -1 where empty.

    Raises
    ------
    DataError
        If a field has no whole number, or several.
    """
    fields = values.astype(object).where(values.notna(), "").map(lambda field: str(field).strip())
    found = fields.str.extract(r"^\D*?(\d+)(?:\.0)?\D*$", expand=False)
    wrong = np.flatnonzero(found.isna() & (fields != ""))
    if len(wrong):
        message = (
            f"column '{column}' must hold the position in a burst, one whole number a row; "
            f"{row(wrong[0])} has '{fields.iloc[wrong[0]]}'"
        )
        raise DataError(message)
    return found.fillna("-1").to_numpy(dtype=np.int64)
