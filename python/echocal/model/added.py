"""What an unexplained term or a smooth correction adds to the indications of a model."""

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from echocal.errors import ModelError
from echocal.model.shape import DISTANCE, Shape, Smooth, is_extra

_ROUNDS = 6  # of the fixed point for a shape against the distance, whose slope is a few percent at most

Inverse = Callable[[Any, dict[str, Any]], Any]


def indicated(
    shape: Shape | Smooth, air: Mapping[str, float], distance: Any, given: Mapping[str, Any], bare: Inverse
) -> Any:
    """Indication [m] at a true distance [m]; `bare` is the indication of the model without the shape."""
    _refuse_out(given)
    return bare(distance, others(shape, given)) + _number(shape, _columns(shape, air, given, distance), None)


def corrected(
    shape: Shape | Smooth, air: Mapping[str, float], indication: Any, given: Mapping[str, Any], bare: Inverse
) -> Any:
    """True distance [m] of an indication [m]; `bare` is the correction of the model without the shape.

    Whether a distance is inside the range of a smooth correction is decided by the distance without it.
    """
    _refuse_out(given)
    rest = others(shape, given)
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


def variance(
    shape: Shape | Smooth, air: Mapping[str, float], distance: Any, given: Mapping[str, Any], residual: Any
) -> tuple[Any, Any]:
    """Variance of the shift of an indication, and the residual variance of a distance [m^2].

    `residual` is that of the model without the shape. A smooth correction has its own where it acts, and
    adds nothing elsewhere.
    """
    columns = _columns(shape, air, given, distance)
    if isinstance(shape, Shape):
        return shape.band(shape.column(columns)) ** 2, residual
    outside, own = shape.outside(columns), shape.residual_uncertainty
    inside = residual if own is None else own.of(distance) ** 2
    return np.where(outside, 0.0, shape.variance(columns)), np.where(outside, residual, inside)


def others(shape: Shape | Smooth | None, given: Mapping[str, Any]) -> dict[str, Any]:
    """The conditions for the model without its shape."""
    columns = () if shape is None else shape.columns
    return {name: v for name, v in given.items() if name not in columns or not is_extra(name)}


def _refuse_out(given: Mapping[str, Any]) -> None:
    if given.get("out") is not None:
        raise ModelError("a model with a shape makes a new array: leave out= away")
