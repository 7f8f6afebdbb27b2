"""Columns that are not taken for a quantity by their names alone, because of their values."""

from __future__ import annotations

from typing import TYPE_CHECKING

from echocal.observations.hints import role_of

if TYPE_CHECKING:
    import pandas as pd

__all__ = ["doubtful_in"]

_GAPS = 0.1  # of the rows: their rows would be lost for a quantity that is not needed
_CODES = 10  # different values: a quality number has more, a flag of a quality control has fewer


def doubtful_in(table: pd.DataFrame) -> dict[str, str]:
    """Why a column is not used unless somebody asks for it, by column.

    Examples
    --------
    >>> import pandas as pd
    >>> doubtful_in(pd.DataFrame({"humidity_percent": [40.0, None], "quality": [0, 1]}))
    {'humidity_percent': 'has many gaps', 'quality': 'has few different values, as a code has,'}
    """
    gaps = table.select_dtypes("number").isna().mean()
    found = {str(name): "has many gaps" for name, share in gaps.items() if share > _GAPS}
    for name in table.columns:
        if role_of(str(name)) == "echo_quality" and table[name].nunique() < _CODES:
            found.setdefault(str(name), "has few different values, as a code has,")
    return found
