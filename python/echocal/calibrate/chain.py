"""A physical model as a form: parameters of effects and of a linear law, derivatives from the core."""

from collections.abc import Iterable, Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from echocal import _core
from echocal.calibrate.form import Column, Columns, Parameter
from echocal.calibrate.regression import indication
from echocal.errors import DataError, UsageError
from echocal.model import Model
from echocal.observations import Observations

__all__ = ["Chain"]

LAW = {"law.intercept": "speed_intercept", "law.slope": "speed_slope"}
"""A law's coefficient moves as the effect that deviates nature's law from the device's."""


class Chain:
    """A `Model` with some of its parameters free.

    Parameters
    ----------
    model : Model
        The model; its own values are where the search begins.
    fit : iterable of str
        ``"fixed_delay.delay"``, ``"fixed_delay"`` for all its parameters, ``"law.intercept"``
        and ``"law.slope"`` where the law is linear. An effect that the model lacks is added.

    Raises
    ------
    UsageError
        If a name is unknown or repeated, or the law has no such coefficient.
    """

    unit = "m"
    has_intercept = True

    def __init__(self, model: Model, fit: Iterable[str]) -> None:
        self.model = model
        self._registry = {facts["id"]: facts for facts in _core.effects()}
        self.names = [name for request in fit for name in self._expand(request)]
        if not self.names or len(set(self.names)) < len(self.names):
            message = f"fit needs distinct parameters, e.g. ['zero_error.offset']; got {self.names}"
            raise UsageError(message)
        self._keys = [self._key(name) for name in self.names]
        self.parameters = [
            self._parameter(name, *key) for name, key in zip(self.names, self._keys, strict=True)
        ]

    def observed(self, observations: Observations) -> Column:
        """Return what the device indicated with the model's law [m]."""
        return indication(observations, self.model.law)

    def columns(self, observations: Observations) -> Columns:
        """Return the reference distance and the recorded conditions."""
        if observations.reference_distance is None:
            message = "calibration needs a reference distance; add a column distance_m, _cm or _mm"
            raise DataError(message)
        return {"distance": observations.reference_distance, **observations.conditions}

    def evaluate(self, values: Column, columns: Columns) -> tuple[Column, NDArray[np.float64]]:
        """Return the indication [m] and the core's exact derivatives."""
        model = Model(self.model.law, self._effects(values), air=self.model.air)
        conditions = {name: column for name, column in columns.items() if name != "distance"}
        derivatives = model.jacobian(columns["distance"], **conditions)
        order = self._order(model)
        picked = [1 + order.index(key) for key in self._keys]
        return model.indicate(columns["distance"], **conditions), derivatives[..., picked]

    def fitted(self, values: Column) -> Model:
        """Return the model with these values; a law's coefficients go into the law."""
        effects = self._effects(values)
        law = self.model.law
        moved = {name: float(value) for name, value in zip(self.names, values, strict=True) if name in LAW}
        if moved:
            coefficients = self._law() | moved
            law = f"{coefficients['law.intercept']!r}{coefficients['law.slope']:+.17g}*T"
            for name in moved:
                del effects[LAW[name]]
        return Model(law, effects, air=self.model.air)

    def _effects(self, values: Column) -> dict[str, dict[str, float]]:
        effects = {id_: dict(parameters) for id_, parameters in self.model.effects.items()}
        law = self._law() if LAW.keys() & set(self.names) else {}
        for name, (effect, parameter), value in zip(self.names, self._keys, values, strict=True):
            effects.setdefault(effect, {})[parameter] = float(value) - law.get(name, 0.0)
        return effects

    def _order(self, model: Model) -> list[tuple[str, str]]:
        """Effect and parameter of each derivative after the first, which is to the distance."""
        facts = [(id_, self._registry[id_]["parameters"]) for id_, _ in model._core.terms]
        return [(id_, parameter["name"]) for id_, parameters in facts for parameter in parameters]

    def _expand(self, request: str) -> list[str]:
        id_, _, parameter = request.partition(".")
        if id_ == "law":
            names = list(LAW)
        elif id_ in self._registry:
            names = [f"{id_}.{facts['name']}" for facts in self._registry[id_]["parameters"]]
        else:
            message = f"cannot fit '{request}': no effect '{id_}'; known: law, {', '.join(self._registry)}"
            raise UsageError(message)
        if parameter and request not in names:
            message = f"cannot fit '{request}'; {id_} has: {', '.join(names)}"
            raise UsageError(message)
        return [request] if parameter else names

    def _key(self, name: str) -> tuple[str, str]:
        effect, _, parameter = name.partition(".")
        if name not in LAW:
            return effect, parameter
        self._law()
        effect = LAW[name]
        if effect in self.model.effects:
            message = f"cannot fit '{name}': the model already has {effect}, which acts alike"
            raise UsageError(message)
        return effect, self._registry[effect]["parameters"][0]["name"]

    def _parameter(self, name: str, effect: str, parameter: str) -> Parameter:
        facts: Mapping[str, Any] = next(
            p for p in self._registry[effect]["parameters"] if p["name"] == parameter
        )
        value = self.model.effects.get(effect, {}).get(parameter, facts["neutral"])
        shift = self._law()[name] if name in LAW else 0.0
        low, high = facts["bounds"]
        return Parameter(
            name, facts["unit"], value + shift, (low + shift, high + shift), facts["prior_scale"]
        )

    def _law(self) -> dict[str, float]:
        """Coefficients of the linear law: its speed at 0 degC and per degree, from the core."""
        reads = {facts["id"]: facts["reads"] for facts in _core.laws()}.get(self.model.law, ["temperature"])
        if reads != ["temperature"]:
            message = (
                f"law '{self.model.law}' has no coefficients to fit; use a linear one, e.g. '331.3+0.606*T'"
            )
            raise UsageError(message)
        at_zero, at_one = 2.0 / Model(self.model.law).time_of_flight(1.0, temperature=np.array([0.0, 1.0]))
        return {"law.intercept": float(at_zero), "law.slope": float(at_one - at_zero)}
