"""Polars expressions: a model's function over columns of a frame that is not read yet."""

import sys
from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from echocal.errors import UsageError


def among(first: object, conditions: Mapping[str, object]) -> bool:
    """Return whether an argument is a polars expression; polars is not imported for that."""
    polars = sys.modules.get("polars")
    if polars is None:
        return False
    expression = polars.Expr
    return isinstance(first, expression) or any(isinstance(own, expression) for own in conditions.values())


def over(function: Callable[..., Any], first: Any, conditions: Mapping[str, Any], name: str) -> Any:
    """Return the expression of a function of rows.

    Every row is independent, so polars may split the rows as it likes: the results are the same. Raises
    `UsageError` if `out` or `n_threads` is given: polars decides on both. The function gets the first
    argument and the conditions by keyword, as arrays; None is not given. `name` is that of the column that
    results.
    """
    import polars as pl

    refused = sorted({"out", "n_threads"} & {key for key, own in conditions.items() if own is not None})
    if refused:
        raise UsageError(
            f"{refused[0]} cannot be given for polars expressions: polars splits the rows itself"
        )
    given = {"": first, **{key: own for key, own in conditions.items() if own is not None}}
    lazy = {key: own for key, own in given.items() if isinstance(own, pl.Expr)}
    fixed = {key: own for key, own in given.items() if key not in lazy}
    fields = {key: f"_{place}" for place, key in enumerate(lazy)}

    def rows(parts: pl.Series) -> pl.Series:
        table = parts.struct
        columns = {key: table.field(field).cast(pl.Float64).to_numpy() for key, field in fields.items()}
        arguments = {**fixed, **columns}
        result = function(arguments.pop(""), **arguments)
        missing = np.logical_or.reduce([table.field(field).is_null().to_numpy() for field in fields.values()])
        values = pl.Series(name, np.broadcast_to(result, len(parts)), dtype=pl.Float64)
        return values if not missing.any() else values.set(pl.Series(missing), None)

    whole = pl.struct([own.alias(fields[key]) for key, own in lazy.items()])
    return whole.map_batches(rows, return_dtype=pl.Float64, is_elementwise=True).alias(name)
