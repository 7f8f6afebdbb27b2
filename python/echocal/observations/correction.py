"""Distances from observations, by a law alone or by a model."""

import numpy as np
from numpy.typing import NDArray

from echocal.arrays import Column
from echocal.errors import DataError
from echocal.keywords import keyword
from echocal.model import Model, Smooth
from echocal.model.indicated_speed import indication_law
from echocal.model.shape import DISTANCE
from echocal.observations.table import Observations


def base_indication(observations: Observations, law: str) -> Column:
    """Indication [m], shape (n,), that a law makes of the echo times; NaN in unusable rows.

    Where readings were turned into echo times with this law, these are the readings again.
    """
    usable, echo_time = observations.usable, observations.echo_time
    if not usable.all():
        echo_time = np.where(usable, echo_time, np.nan)
    return np.asarray(Model(law).distance(echo_time, **_conditions(observations)))


def corrected_distance(observations: Observations, model: Model) -> Column:
    """Distance [m], shape (n,), by a model; NaN in unusable rows.

    Effects of the firmware and of the indication count too: the model inverts the whole chain from the
    indication of its own law, as it was fitted. Raises `DataError` if the model needs a condition that the
    table does not have.
    """
    indication = base_indication(observations, indication_law(model))
    try:
        distance = np.asarray(
            model.correct(indication, **_conditions(observations, model), **_extra(observations, model))
        )
    except DataError as error:
        out = keyword("columns", {"NAME": "ignore"})
        raise DataError(
            f"{error}; map a column with {keyword('columns')}, or leave one out with {out}"
        ) from None
    return distance


def outside_smooth(observations: Observations, model: Model) -> NDArray[np.str_]:
    """Why a smooth correction of a model adds nothing to a row, shape (n,); empty where it holds.

    Such a row has the distance by the model without the correction: it does not extrapolate.
    """
    smooth = model.shape
    if not isinstance(smooth, Smooth):
        return np.full(len(observations.usable), "")
    given = {**_conditions(observations), **_extra(observations, model)}
    if DISTANCE in smooth.columns:
        given[DISTANCE] = corrected_distance(observations, model.without_shape())
    place, names = smooth.which_outside(given)
    sources = [observations.source_names.get(name, name.replace("_", " ")) for name in names]
    reasons = np.array(["", *(f"{name} outside of the smooth correction" for name in sources)])
    return np.where(observations.usable, reasons[place + 1], "")


def _extra(observations: Observations, model: Model) -> dict[str, Column]:
    """Further columns that a shape of the model is a function of."""
    needed = () if model.shape is None else model.shape.columns
    return {name: column for name, column in observations.extra.items() if name in needed}


def _conditions(observations: Observations, model: Model | None = None) -> dict[str, Column]:
    # what cannot be used must not raise a warning about domains either
    usable = observations.usable
    bound = {} if model is None else observations.bound(model.columns)
    given = {**observations.conditions, **bound}
    if usable.all():
        return given
    return {name: np.where(usable, values, np.nan) for name, values in given.items()}
