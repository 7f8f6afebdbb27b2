"""The base simulation, with which the measurement is compared."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from numbers import Real
from typing import Any, NamedTuple, cast

import numpy as np
from numpy.typing import NDArray

from echocal import _core
from echocal.errors import ModelError, UsageError
from echocal.model import Model
from echocal.registry import Effect, find_effect

__all__ = ["Base", "Presumed"]

Column = NDArray[np.float64]
Parameters = Mapping[str, Mapping[str, float]]


class Presumed(NamedTuple):
    """A condition that the user states for all rows.

    Attributes
    ----------
    quantity : str
    value : float
        [SI].
    scale : float
        Prior standard deviation of the true value [SI].
    """

    quantity: str
    value: float
    scale: float


@dataclass(frozen=True)
class Base:
    """The base simulation: the readings of a device without further effects.

    A fixed speed as base describes a device, not the air. The base then predicts the distance
    itself as reading, the air follows the linear law, and the effect ``fixed_speed``, with this
    speed, is one of the causes that compete.

    Attributes
    ----------
    law : str
        Law for the air on the path.
    effects : mapping
        Effects that the base includes already.
    air : mapping of str to float
        Values that the base assumes for quantities that are not recorded.
    device_speed : float or None
        Speed with which the device converts all echoes [m/s]; None: that of the law.
    presumed : mapping of str to Presumed
        Those of `effects` that stand for a stated condition, which may be wrong.
    """

    law: str
    effects: Parameters
    air: Mapping[str, float] = field(default_factory=dict)
    device_speed: float | None = None
    presumed: Mapping[str, Presumed] = field(default_factory=dict)

    @classmethod
    def of(cls, base: "str | float | Model") -> "Base":
        """Read a law's name, an expression, a fixed speed or a model."""
        if isinstance(base, Model):
            base.refuse_shape("the base of a diagnosis")
            if base.columns:
                message = (
                    f"the base of a diagnosis reads {', '.join(base.columns)} from a further thermometer, "
                    "which no base does; give a base without that effect"
                )
                raise UsageError(message)
            return cls(base.law, base.effects, base.air)
        speed = isinstance(base, Real) and not isinstance(base, bool)
        law = Model(str(base) if speed else cast("str", base)).law  # which refuses what is neither
        try:
            device_speed = float(law)
        except ValueError:
            return cls(law, {})
        (low, high) = next(p.bounds for p in find_effect("fixed_speed").parameters if p.name == "speed")
        if not low <= device_speed <= high:
            message = f"the base is a fixed speed of {law} m/s; give a speed of {low:g} .. {high:g}, or a law"
            raise UsageError(message)
        return cls("linear", {}, device_speed=device_speed)

    @cached_property
    def plain(self) -> Model:
        """The base as a model."""
        return self.model()

    @property
    def assumed(self) -> "Base":
        """The same air with stated conditions as values of the law, not as effects."""
        effects = {id_: own for id_, own in self.effects.items() if id_ not in self.presumed}
        air = {**self.air, **{one.quantity: one.value for one in self.presumed.values()}}
        return Base(self.law, effects, air, self.device_speed)

    @property
    def reading_speed(self) -> str:
        """Speed that a device converts with by default, as the name of a law or an expression."""
        return self.law if self.device_speed is None else str(self.device_speed)

    def indication(self, echo_time: Column, conditions: Mapping[str, Column]) -> Column:
        """Reading [m] for an echo time [s]."""
        reading: Column = Model(self.reading_speed, air=self.air).distance(echo_time, **conditions)
        return reading

    def model(self, extra: Parameters | None = None, **more: Any) -> Model:
        """Return the base extended by effects; `more` goes to `Model`."""
        return Model(self.law, {**self.effects, **(extra or {})}, air=self.air, **more)

    def expected(self, distance: Column, conditions: Mapping[str, Column]) -> Column:
        """Reading [m] that the base simulation predicts at a distance [m]."""
        expected: Column = self.plain.indicate(distance, **conditions)
        return expected

    def allows(self, effect: Effect) -> bool:
        """Whether an effect can extend this base."""
        if effect.id in self.effects:
            return effect.id in self.presumed
        terms = [(id_, list(own.items())) for id_, own in self.effects.items()]
        try:
            _core.Model(self.law, [*terms, (effect.id, [])])
        except ModelError:
            return False
        return True

    def to_dict(self) -> dict[str, Any]:
        """As in ``echocal.diagnosis/1``."""
        effects = {id_: dict(own) for id_, own in self.assumed.effects.items()}
        return {"law": self.law, "effects": effects, "device_speed": self.device_speed}
