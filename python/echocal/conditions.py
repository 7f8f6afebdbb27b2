"""How arguments become columns of influence quantities."""

from collections.abc import Iterable, Mapping
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from echocal.errors import UsageError, among
from echocal.quantities import QUANTITIES

__all__ = ["columns", "numbers", "refuse_unknown", "unmasked"]


def refuse_unknown(names: Iterable[str]) -> None:
    """Raise `UsageError` where a name is none of an influence quantity."""
    for name in names:
        if name not in QUANTITIES:
            raise UsageError(f"unknown influence quantity '{name}'{among(name, QUANTITIES, 'known:')}")


def unmasked(given: Any) -> NDArray[Any]:
    """Array of anything; None where it is masked, which NumPy alone would take for measured."""
    if isinstance(given, np.ma.MaskedArray):
        values = np.array(given.data, dtype=object)
        values[np.ma.getmaskarray(given)] = None
        return values
    return np.asarray(given)


def columns(
    first: ArrayLike, conditions: Mapping[str, ArrayLike | None]
) -> tuple[tuple[int, ...], list[NDArray[np.float64]]]:
    """Broadcast a column (a distance, a time) and its conditions against each other.

    The common shape, and the column, then one flat array per quantity, all of the same length. A quantity
    that is absent or None has its default, NaN if it has none. Raises `UsageError` if a name is unknown, a
    value is no real number, or the shapes cannot be broadcast.
    """
    refuse_unknown(conditions)
    given = {name: value for name, value in conditions.items() if value is not None}
    values = [numbers("the first argument", first)]
    for name, quantity in QUANTITIES.items():
        fallback = np.nan if quantity.default is None else quantity.default
        values.append(numbers(name, given.get(name, fallback)))
    try:
        shape = np.broadcast_shapes(*(value.shape for value in values))
    except ValueError:
        shapes = ", ".join(f"{name} {np.shape(value)}" for name, value in given.items())
        raise UsageError(f"shapes do not broadcast: first argument {values[0].shape}, {shapes}") from None
    whole = (value if value.shape == shape else np.full(shape, value) for value in values)
    return shape, [np.ascontiguousarray(column).reshape(-1) for column in whole]


def numbers(name: str, given: ArrayLike) -> NDArray[np.float64]:
    """Array of real numbers, NaN where masked or None; raises `UsageError` for anything else."""
    if isinstance(given, float | int):
        return np.asarray(given, dtype=np.float64)  # the common case is fast
    try:
        values = unmasked(given)
    except ValueError as error:  # rows of several lengths
        raise UsageError(f"{name} is no array of numbers: {error}") from None
    try:
        if values.dtype.kind not in "biufO":  # NumPy would take a date for a number
            raise TypeError
        return values.astype(np.float64, copy=False)
    except (TypeError, ValueError, OverflowError):
        raise UsageError(f"{name} must be real numbers, but has dtype {values.dtype}") from None
