"""Influence quantities: their names, units and defaults, and how arguments become columns."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from echocal import _core
from echocal.errors import UsageError

__all__ = ["QUANTITIES", "Quantity", "columns"]


@dataclass(frozen=True)
class Quantity:
    """An influence quantity (VIM 2.52)."""

    name: str
    unit: str
    default: float | None


QUANTITIES: dict[str, Quantity] = {facts["name"]: Quantity(**facts) for facts in _core.quantities()}
"""Every influence quantity by name, in the order in which the core takes them."""


def columns(
    first: ArrayLike, conditions: Mapping[str, ArrayLike | None]
) -> tuple[tuple[int, ...], list[NDArray[np.float64]]]:
    """Broadcast a column and its conditions against each other.

    Parameters
    ----------
    first : array_like
        The column that the conditions belong to (a distance, a time).
    conditions : mapping of str to array_like
        Values by name of the influence quantity; absent or None means its default, NaN if it
        has none.

    Returns
    -------
    tuple of int
        The common shape.
    list of ndarray
        The column, then one flat array per quantity, all of the same length.

    Raises
    ------
    UsageError
        If a name is unknown or the shapes cannot be broadcast.
    """
    unknown = sorted(set(conditions) - set(QUANTITIES))
    if unknown:
        message = f"unknown influence quantity '{unknown[0]}'; known: {', '.join(QUANTITIES)}"
        raise UsageError(message)
    given = {name: value for name, value in conditions.items() if value is not None}
    values = [np.asarray(first, dtype=np.float64)]
    for name, quantity in QUANTITIES.items():
        fallback = np.nan if quantity.default is None else quantity.default
        values.append(np.asarray(given.get(name, fallback), dtype=np.float64))
    try:
        broadcast = np.broadcast_arrays(*values)
    except ValueError:
        shapes = ", ".join(f"{name} {np.shape(value)}" for name, value in given.items())
        message = f"shapes do not broadcast: first argument {values[0].shape}, {shapes}"
        raise UsageError(message) from None
    return broadcast[0].shape, [np.ascontiguousarray(column).reshape(-1) for column in broadcast]
