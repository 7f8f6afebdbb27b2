"""What an unexplained term or a smooth correction adds to the indications of a model."""

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from echocal.errors import ModelError
from echocal.model.shape import DISTANCE, Shape, is_extra
from echocal.model.smooth import Smooth

__all__ = ["corrected", "indicated"]

_ROUNDS = 6  # of the fixed point for a shape against the distance, whose slope is a few percent at most

Inverse = Callable[[Any, dict[str, Any]], Any]


def indicated(
    shape: Shape | Smooth, air: Mapping[str, float], distance: Any, given: Mapping[str, Any], bare: Inverse
) -> Any:
    """Indication [m] at a true distance [m]; `bare` is the indication of the model without the shape."""
    _refuse_out(given)
    return bare(distance, _rest(shape, given)) + _number(shape, _columns(shape, air, given, distance), None)


def corrected(
    shape: Shape | Smooth, air: Mapping[str, float], indication: Any, given: Mapping[str, Any], bare: Inverse
) -> Any:
    """True distance [m] of an indication [m]; `bare` is the correction of the model without the shape.

    Whether a distance is inside the range of a smooth correction is decided by the distance without it.
    """
    _refuse_out(given)
    rest = _rest(shape, given)
    at_distance = DISTANCE in shape.columns
    found, outside = indication, None
    if isinstance(shape, Smooth):
        found = bare(indication, rest) if at_distance else indication
        outside = shape.outside(_columns(shape, air, given, found))
    for _ in range(_ROUNDS if at_distance else 1):
        shift = _number(shape, _columns(shape, air, given, found), outside)
        found = bare(indication - shift, rest)
    return found


def _columns(
    shape: Shape | Smooth, air: Mapping[str, float], given: Mapping[str, Any], distance: Any
) -> dict[str, Any]:
    """What the shape may be a function of; a smooth correction needs recorded values, not assumed ones."""
    assumed = air if isinstance(shape, Shape) else {}
    return {**assumed, **given, DISTANCE: distance}


def _number(shape: Shape | Smooth, columns: dict[str, Any], outside: Any) -> Any:
    """Shift [m]; rows that are known to be outside of a smooth correction have none."""
    if isinstance(shape, Shape):
        shift = shape.of(shape.column(columns))
    elif outside is None:
        shift = shape.of(columns)
    else:
        shift = np.where(outside, 0.0, shape.within(columns))
    return float(shift) if shift.ndim == 0 else shift


def _rest(shape: Shape | Smooth, given: Mapping[str, Any]) -> dict[str, Any]:
    """The conditions for the model without its shape."""
    return {name: v for name, v in given.items() if name not in shape.columns or not is_extra(name)}


def _refuse_out(given: Mapping[str, Any]) -> None:
    if given.get("out") is not None:
        message = "a model with a shape makes a new array: leave out= away"
        raise ModelError(message)
