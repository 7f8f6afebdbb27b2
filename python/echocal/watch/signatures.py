"""What each cause would add to a row's residual: the signatures that the test looks for."""

from collections.abc import Collection, Mapping
from dataclasses import dataclass

import numpy as np

from echocal.arrays import Column
from echocal.errors import DataError, EchocalError, ModelError
from echocal.model import Model
from echocal.registry import Effect, Parameter, effects

STEP, DRIFT = "step_change", "drift"
"""Causes that need no column: the reading is off by a constant, or ever more, from the onset on."""

_LATER = "temperature_later_"
_OF_THE_TABLE = ("elapsed_time", "position_in_group")


@dataclass(frozen=True)
class Signature:
    """One direction that is tested."""

    # id, parameter, unit: the cause, its size, and the size's unit
    id: str
    parameter: str
    unit: str
    scale: float
    """Standard deviation of the prior of the size, in this unit: signatures are per such a deviation."""


def refuse_unwatchable(model: Model) -> None:
    """Refuse a model whose corrections depend on rows that have not come yet.

    Raises `DataError` with the quantity and the way out.
    """
    if message := unwatchable(model):
        raise DataError(message)


def unwatchable(model: Model) -> str:
    """Say why a model cannot be watched, and the way out; nothing if it can."""
    reads = {name for name in model.reads if name.startswith(_LATER) or name in _OF_THE_TABLE}
    if not reads:
        return ""
    return (
        f"the model reads {', '.join(sorted(reads))}, which is known of a whole table only, not of rows "
        "as they come; correct finished tables with `echocal correct`, or watch with a model without it"
    )


class Signatures:
    """Signatures of all causes that a model and the recorded quantities allow.

    `recorded` are the influence quantities that the rows have.
    """

    def __init__(self, model: Model, recorded: Collection[str]) -> None:
        self.base = model.without_shape()
        self.listed: list[Signature] = []
        self._models: list[tuple[Model, int]] = []
        for effect in effects():
            extended = _extended(self.base, effect, recorded)
            if extended is None:
                continue
            size = next(p for p in effect.parameters if p.role == "size")
            place = extended.parameter_names.index(f"{effect.id}.{size.name}")
            self._models.append((extended, 1 + place))
            self.listed.append(Signature(effect.id, size.name, size.unit, size.prior_scale))

    @property
    def ids(self) -> list[str]:
        """Causes by signature."""
        return [signature.id for signature in self.listed]

    def at(self, distance: Column, conditions: Mapping[str, Column]) -> Column:
        """Derivatives of the corrected distance to every size, shape (n, j) [m per prior sd]."""
        found = np.empty((len(distance), len(self.listed)))
        for column, ((model, place), signature) in enumerate(zip(self._models, self.listed, strict=True)):
            needed = {name: values for name, values in conditions.items() if name in model.reads}
            jacobian = np.asarray(model.jacobian(distance, **needed))
            found[:, column] = signature.scale * jacobian[:, place] / jacobian[:, 0]
        return np.nan_to_num(found, nan=0.0, posinf=0.0, neginf=0.0)


def step_and_drift() -> tuple[Signature, Signature]:
    """The two signatures that are always tested; a drift is told per day."""
    return tuple(  # type: ignore[return-value]
        Signature(effect.id, size.name, size.unit, size.prior_scale)
        for id_ in (STEP, DRIFT)
        for effect in effects()
        if effect.id == id_
        for size in effect.parameters[:1]
    )


def _extended(base: Model, effect: Effect, recorded: Collection[str]) -> Model | None:
    """The model with an effect at neutral; None where the cause is no candidate."""
    reads = (*effect.reads, *effect.requires)
    if not effect.recurs or effect.id in base.effects or effect.stage == "firmware":
        return None
    if any(name.startswith(_LATER) or name in _OF_THE_TABLE for name in reads):
        return None
    if any(name not in recorded for name in effect.requires):
        return None
    if any(name in recorded or name in base.air for name in effect.excludes):
        return None
    try:
        model = Model(base.law, {**base.effects, effect.id: _neutral(effect.parameters)}, air=base.air)
        model.refuse_missing(dict.fromkeys(recorded))
    except (ModelError, DataError, EchocalError):
        return None
    return model


def _neutral(parameters: tuple[Parameter, ...]) -> dict[str, float]:
    return {p.name: p.known[0] if p.role == "shape" and p.known else p.neutral for p in parameters}
