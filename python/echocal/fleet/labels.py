"""Keys of sensors as text, the same from every type of column."""

from typing import Any

from echocal.fleet.polar import polars
from echocal.model.folder import WHOLE

__all__ = ["label"]


def label(name: str, kind: Any) -> Any:
    """Expression of a column's values as text: whole numbers have no fraction, empty texts are null.

    Parameters
    ----------
    name : str
        The column.
    kind : polars.DataType
        Its type.
    """
    pl = polars()
    column = pl.col(name)
    if kind.is_float():
        whole = (column == column.floor()) & (column.abs() < 2.0**53)
        number = pl.when(whole).then(column.cast(pl.Int64, strict=False).cast(pl.String))
        text = number.otherwise(column.cast(pl.String))
        return pl.when(column.is_nan()).then(None).otherwise(text)
    text = column.cast(pl.String).str.strip_chars().str.replace(WHOLE, "$1")
    return pl.when(text == "").then(None).otherwise(text)
