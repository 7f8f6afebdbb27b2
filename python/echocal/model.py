"""A model: a law for the speed of sound and the effects that extend it."""

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from echocal import _core
from echocal.conditions import columns

__all__ = ["Model"]


class Model:
    """A law and the effects that extend it.

    Parameters
    ----------
    law : str
        Name of a law, or a linear expression such as ``"331.3+0.606*T"``.
    effects : mapping of str to mapping of str to float
        Parameters by effect id and parameter name, SI units; what is not given stays neutral.
    air : mapping of str to float
        Values assumed where a condition is not recorded, e.g. ``{"relative_humidity": 0.5}``.

    Raises
    ------
    ModelError
        If a name is unknown or a parameter lies outside its bounds.

    Examples
    --------
    >>> model = Model(law="linear", effects={"fixed_delay": {"delay": 30e-6}})
    >>> round(float(model.indicate(2.0, temperature=20.0)), 6)
    2.005151
    >>> round(float(model.correct(2.005151, temperature=20.0)), 9)
    2.0
    """

    def __init__(
        self,
        law: str = "cramer",
        effects: Mapping[str, Mapping[str, float]] | None = None,
        *,
        air: Mapping[str, float] | None = None,
    ) -> None:
        self.effects = {id_: dict(parameters) for id_, parameters in (effects or {}).items()}
        self.air = dict(air or {})
        self._core = _core.Model(law, [(id_, list(p.items())) for id_, p in self.effects.items()])

    @property
    def law(self) -> str:
        """Name or expression of the law."""
        return self._core.law

    def indicate(self, distance: ArrayLike, **conditions: ArrayLike | None) -> NDArray[np.float64]:
        """Indication of the device [m] at a true distance [m]."""
        return self._map(self._core.indicate, distance, conditions)

    def speed_of_sound(self, distance: ArrayLike, **conditions: ArrayLike | None) -> NDArray[np.float64]:
        """Speed of sound on the path [m/s] at a true distance [m]."""
        return self._map(self._core.speed_of_sound, distance, conditions)

    def time_of_flight(self, distance: ArrayLike, **conditions: ArrayLike | None) -> NDArray[np.float64]:
        """Echo time that the device records [s] at a true distance [m]."""
        return self._map(self._core.time_of_flight, distance, conditions)

    def correct(self, indication: ArrayLike, **conditions: ArrayLike | None) -> NDArray[np.float64]:
        """Return the true distance [m] of an indication [m]."""
        return self._map(self._core.correct, indication, conditions)

    def distance(self, time: ArrayLike, **conditions: ArrayLike | None) -> NDArray[np.float64]:
        """Return the true distance [m] of a recorded echo time [s]."""
        return self._map(self._core.distance, time, conditions)

    def jacobian(self, distance: ArrayLike, **conditions: ArrayLike | None) -> NDArray[np.float64]:
        """Exact derivatives of the indication, shape (..., 1 + parameters).

        The first column is the derivative to the distance [1], then one per parameter in the
        order of the measurement chain [m per unit of the parameter].
        """
        shape, (first, *rest) = columns(distance, {**self.air, **conditions})
        return self._core.jacobian(first, rest).reshape(*shape, -1)

    def _map(
        self, function: Any, first: ArrayLike, conditions: Mapping[str, ArrayLike | None]
    ) -> NDArray[np.float64]:
        shape, (column, *rest) = columns(first, {**self.air, **conditions})
        result: NDArray[np.float64] = function(column, rest).reshape(shape)
        return result
