"""Columns that say which rows belong together."""

from __future__ import annotations

from typing import Any

import numpy as np
import pandas as pd

from echocal.arrays import Labels
from echocal.errors import DataError
from echocal.observations.fields import fields, is_empty, refuse_object, row, shown

_FEW = 50  # different texts from which on a column holds remarks, not kinds


def codes(values: pd.Series[Any], column: str) -> Labels:
    """Number the distinct values in the order in which they appear; -1 where empty.

    Raises `DataError` if a field is no single value.
    """
    if pd.api.types.is_numeric_dtype(values) or pd.api.types.is_datetime64_any_dtype(values):
        return np.asarray(pd.factorize(values)[0], dtype=np.int64)
    numbers: dict[Any, int] = {}
    found = np.full(len(values), -1, dtype=np.int64)
    for position, field in enumerate(values.astype(object)):
        label = field.strip() if isinstance(field, str) else field
        try:
            if not is_empty(label):
                found[position] = numbers.setdefault(field, len(numbers))
        except (TypeError, ArithmeticError):  # a list; a signaling NaN
            refuse_object(column, position, field)
            raise
    return found


def few_codes(values: pd.Series[Any]) -> Labels | None:
    """Number the texts of a column in the order in which they appear; None where they are many or one.

    -1 where empty.
    """
    try:
        found, texts = pd.factorize(values)
    except TypeError:  # lists, and other values that cannot be compared
        return None
    if not 2 <= len(texts) <= _FEW or not all(isinstance(text, str) for text in texts):
        return None
    return np.asarray(found, dtype=np.int64)


def positions(values: pd.Series[Any], column: str) -> Labels:
    """Whole numbers, bare or as the only number of a text (``Obs. 3``); -1 where empty.

    Raises `DataError` if a field has no whole number, or several.
    """
    texts = fields(values, column)
    found = texts.str.extract(r"^\D*?(\d{1,18})(?:\.0)?\D*$", expand=False)
    wrong = np.flatnonzero(found.isna() & (texts != ""))
    if len(wrong):
        raise DataError(
            f"column '{column}' must hold the position in a burst, one whole number a row; "
            f"{row(wrong[0])} has '{shown(texts.iloc[wrong[0]])}'"
        )
    return found.fillna("-1").to_numpy(dtype=np.int64)
