"""Fields of a column as text, whatever objects it holds."""

from __future__ import annotations

from datetime import date, time, timedelta
from decimal import Decimal
from numbers import Real
from typing import Any

import numpy as np
import pandas as pd

from echocal.arrays import Column
from echocal.errors import DataError
from echocal.keywords import keyword

_SCALARS = (str, Real, Decimal, np.bool_, np.datetime64, np.timedelta64, date, time, timedelta, pd.Period)
_NONE = (None, pd.NA, pd.NaT)
_WIDEST = 1024  # bits of an integer: more are beyond any float, and Python writes no more than 4,300 digits
_LONGEST = 60  # characters of a field that a message shows


def row(position: int | np.intp) -> str:
    """Name a row for a person: the first row below the header is row 1."""
    return f"row {int(position) + 1}"


def rows(count: int | np.intp) -> str:
    """Count rows for a person."""
    return f"{count} row" if count == 1 else f"{count} rows"


def span(seconds: float) -> str:
    """Length of time for a person.

    Examples
    --------
    >>> span(5.0), span(600.0), span(9700.0)
    ('5 s', '10 min', '2.7 h')
    """
    for size, unit in ((86400.0, "d"), (3600.0, "h"), (60.0, "min")):
        if seconds >= 2 * size:
            return f"{round(seconds / size, 1):g} {unit}"
    return f"{seconds:.3g} s"


def shown(text: str) -> str:
    r"""Text of a field for a message: on one line, and no longer than one reads.

    Examples
    --------
    >>> shown("two\nlines")
    'two\\nlines'
    """
    plain = text.encode("unicode_escape").decode() if not text.isprintable() else text
    return plain if len(plain) <= _LONGEST else f"{plain[:_LONGEST]}..."


def fields(values: pd.Series[Any], column: str) -> pd.Series[Any]:
    """Text of each field without blanks around it; empty where there is no value.

    Raises `DataError` if a field is neither text nor a single value: a list, bytes, a signaling NaN.

    Examples
    --------
    >>> import pandas as pd
    >>> fields(pd.Series([" 20.0", None, 3]), "temperature_C").tolist()
    ['20.0', '', '3']
    """
    objects = np.asarray(values.astype(object), dtype=object)
    texts = [
        field.strip() if type(field) is str else _text(field, column, position)
        for position, field in enumerate(objects)
    ]
    return pd.Series(texts, index=values.index, dtype=object)


def floats(values: pd.Series[Any]) -> Column:
    """Numbers of a column, NaN where a field is none."""
    return pd.to_numeric(values, errors="coerce").to_numpy(dtype=np.float64, na_value=np.nan)


def is_empty(field: Any) -> bool:
    """Whether a field has no value: an empty text, None, NaN, NaT."""
    if isinstance(field, str):
        return not field
    return any(field is none for none in _NONE) or (isinstance(field, _SCALARS) and field != field)


def refuse_object(column: str, position: int, field: object) -> None:
    """Refuse a field that is no single value. Raises `DataError` if it is not."""
    if (isinstance(field, _SCALARS) and not _signals(field)) or any(field is none for none in _NONE):
        return
    what = "a signaling NaN" if _signals(field) else f"a value of type {type(field).__name__}"
    raise DataError(
        f"column '{column}' holds {what} at {row(position)}; give one number or text a row "
        f"(None for no value), or leave the column out: {keyword('columns', {column: 'ignore'})}"
    )


def _text(field: object, column: str, position: int) -> str:
    refuse_object(column, position, field)
    if is_empty(field):
        return ""
    if isinstance(field, int) and field.bit_length() > _WIDEST:
        return "inf" if field > 0 else "-inf"
    return str(field).strip()


def _signals(field: object) -> bool:
    return isinstance(field, Decimal) and field.is_snan()
