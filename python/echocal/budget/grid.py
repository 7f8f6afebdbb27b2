"""Rows of a grid of conditions, as if a device had recorded them."""

from typing import Any

import numpy as np

from echocal.errors import UsageError, among
from echocal.keywords import keyword
from echocal.model import Model
from echocal.observations import Observations
from echocal.quantities import QUANTITIES
from echocal.sweep.grid import axis

__all__ = ["observations_of"]

_LARGEST = 100_000


def observations_of(model: Model, given: dict[str, Any]) -> Observations:
    """Rows for every combination of distances and conditions; the last one changes fastest.

    Raises
    ------
    UsageError
        If a name or a range cannot be understood, or there are too many combinations.
    """
    known = ("distance", *QUANTITIES)
    for name in given:
        if name not in known:
            message = f"{keyword(name)}: no such condition{among(name, known, 'there are')}"
            raise UsageError(message)
    if "distance" not in given:
        message = f"give readings, or the distances of a grid: {keyword('distance', 2)}"
        raise UsageError(message)
    axes = {name: np.atleast_1d(axis(name, own)) for name, own in given.items()}
    count = np.prod([float(len(values)) for values in axes.values()])
    if count > _LARGEST:
        message = f"{count:.0f} combinations are more than {_LARGEST}; take larger steps"
        raise UsageError(message)
    grid = dict(zip(axes, map(np.ravel, np.meshgrid(*axes.values(), indexing="ij")), strict=True))
    distance = grid.pop("distance")
    indication = np.asarray(model.indicate(distance, **grid))
    echo = np.asarray(Model(model.law).time_of_flight(indication, **grid))
    columns = {column: grid[name] for name, column in model.columns.items() if name in grid}
    conditions = {name: values for name, values in grid.items() if name not in model.columns}
    return Observations(echo, conditions, None, np.full(len(distance), ""), thermometers=columns)
