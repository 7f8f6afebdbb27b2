"""Parameters that each unit has of its own, and the box of their allowed values."""

import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass

from echocal.errors import DataError, UsageError
from echocal.keywords import exact, keyword
from echocal.model import Model
from echocal.registry import find_effect


@dataclass(frozen=True)
class Parameter:
    """A parameter that can differ from unit to unit.

    It changes an echo time by a straight line that is the same at every distance and in all conditions. So
    the function that is proven for one value of it is proven for all.
    """

    effect: str
    name: str
    unit: str  # unit in a model, and of a box
    steps: float  # how many steps of the block make one unit
    reach: float
    """Half the width of the default box, around the value of the model. Both together stay below 256 echo
    codes of 1 us at 4 m, so that one byte holds the whole codes and one byte their fraction."""

    @property
    def key(self) -> str:
        """Its name in a model."""
        return f"{self.effect}.{self.name}"

    def of(self, model: Model) -> float:
        """The value in a model; neutral where the model does not have the effect."""
        return float(model.effects.get(self.effect, {}).get(self.name, 0.0))

    def stored(self, value: float) -> int:
        """The number of steps in a block."""
        return round(self.linear(value) * self.steps)

    def linear(self, value: float) -> float:
        """What the block holds, in which the correction is linear: of a frequency error f, f / (1 + f)."""
        return value / (1.0 + value) if self.name == "frequency_error" else value

    def read(self, stored: int) -> float:
        """The value that a number of steps stands for."""
        held = stored / self.steps
        return held / (1.0 - held) if self.name == "frequency_error" else held


PARAMETERS = (
    Parameter("fixed_delay", "delay", "s", 2.0**5 * 1e6, 50e-6),
    Parameter("clock_error", "frequency_error", "1", 2.0**19, 1.9e-3),
)
"""All of them, in the order of the block."""


@dataclass(frozen=True)
class Side:
    """The allowed values of one parameter."""

    parameter: Parameter
    # low, high: ends, included
    low: float
    high: float
    default: float  # the value of the model, which a unit without a valid block gets
    free: bool
    """Whether units differ in it. Otherwise both ends are the value of the model."""

    @property
    def least(self) -> int:
        """The low end in steps of the block."""
        return self.parameter.stored(self.low)

    @property
    def span(self) -> int:
        """Steps between the ends."""
        return self.parameter.stored(self.high) - self.least

    def words(self) -> str:
        """The side in words."""
        unit = "" if self.parameter.unit == "1" else f" {self.parameter.unit}"
        return f"{self.parameter.key}: {exact(self.low)} .. {exact(self.high)}{unit}"


@dataclass(frozen=True)
class Box:
    """The allowed parameters of a unit."""

    delay: Side
    clock: Side

    @classmethod
    def around(cls, model: Model, wanted: Iterable[str] | Mapping[str, tuple[float, float]]) -> "Box":
        """Return the box around a model.

        Parameters
        ----------
        model : Model
            Its own parameters lie inside; the parameters of no side are fixed at its values.
        wanted : iterable of str, or mapping of str to (low, high)
            Effects, each with its ends or without: ``["fixed_delay", "clock_error=-0.005:0.005"]``.

        Raises
        ------
        UsageError
            If an effect has no parameter that can differ from unit to unit, or the ends are no range that
            holds the value of the model.

        Examples
        --------
        >>> box = Box.around(Model("cramer", {"fixed_delay": {"delay": 31e-6}}), ["fixed_delay=0:1e-4"])
        >>> box.delay.words(), box.clock.free
        ('fixed_delay.delay: 0 .. 0.0001 s', False)
        """
        ends = _ends(wanted)
        known = {parameter.effect: parameter for parameter in PARAMETERS}
        for effect in ends:
            if effect not in known:
                raise UsageError(
                    f"{keyword('per_unit', effect)}: no parameter of this effect can differ from unit to "
                    f"unit; this version has {', '.join(known)}"
                )
        if not ends:
            raise UsageError(f"{keyword('per_unit')} names no effect: give {', '.join(known)}, or both")
        return cls(*(_side(model, known[effect], ends) for effect in known))

    @classmethod
    def widest(cls, model: Model) -> "Box":
        """Return the box of all that a model can hold."""
        ends = {}
        for parameter in PARAMETERS:
            facts = find_effect(parameter.effect).parameters
            ends[parameter.effect] = next(p.bounds for p in facts if p.name == parameter.name)
        return cls.around(model, ends)

    @property
    def sides(self) -> tuple[Side, Side]:
        """Both sides, in the order of the block."""
        return self.delay, self.clock

    def texts(self) -> list[str]:
        """The box as arguments of the command."""
        free = (side for side in self.sides if side.free)
        return [f"{side.parameter.effect}={exact(side.low)}:{exact(side.high)}" for side in free]

    def least(self, model: Model) -> Model:
        """Return the model of the unit with the least parameters: that of the function underneath."""
        effects = {id_: dict(own) for id_, own in model.effects.items()}
        for side in self.sides:
            if side.free:
                value = side.parameter.read(side.least)
                effects.pop(side.parameter.effect, None)
                if value != 0.0:
                    effects[side.parameter.effect] = {side.parameter.name: value}
        return Model(
            model.law,
            effects,
            air=model.air,
            provenance=model.provenance,
            columns=model.given_columns,
            residual_uncertainty=model.residual_uncertainty,
        )

    def refuse_outside(self, model: Model, whose: str) -> None:
        """Raise `DataError` if a parameter of a model is outside."""
        for side in self.sides:
            value = side.parameter.of(model)
            if side.low <= value <= side.high:
                continue
            unit = "" if side.parameter.unit == "1" else f" {side.parameter.unit}"
            has = f"{whose}: {side.parameter.key} is {value:g}{unit}"
            if side.free:
                message = (
                    f"{has}, outside the box {side.low:g} .. {side.high:g}{unit}: generate the firmware for "
                    f"a wider box ({keyword('per_unit', f'{side.parameter.effect}=LOW:HIGH')}), or check "
                    "the unit"
                )
            else:
                message = (
                    f"{has}, and that of the firmware's model {side.low:g}{unit}; it is no parameter of a "
                    f"unit: generate the firmware with {keyword('per_unit', side.parameter.effect)}"
                )
            raise DataError(message)


def _side(model: Model, parameter: Parameter, ends: Mapping[str, tuple[float, float] | None]) -> Side:
    value = parameter.of(model)
    if parameter.effect not in ends:
        return Side(parameter, value, value, value, free=False)
    least, most = next(p.bounds for p in find_effect(parameter.effect).parameters if p.name == parameter.name)
    low, high = ends[parameter.effect] or _usual(parameter, value, least, most)
    unit = "" if parameter.unit == "1" else f" {parameter.unit}"
    given = keyword("per_unit", f"{parameter.effect}={low:g}:{high:g}")
    if not (least <= low < high <= most):
        message = f"{given} is no range within the bounds of {parameter.key}, {least:g} .. {most:g}{unit}"
        raise UsageError(message)
    if not low <= value <= high:
        raise UsageError(
            f"{given} does not hold the model's own {parameter.key}, {value:g}{unit}, which a unit without a "
            "valid block gets: widen the range, or change the model"
        )
    return Side(parameter, low, high, value, free=True)


def _usual(parameter: Parameter, value: float, least: float, most: float) -> tuple[float, float]:
    low = max(least, value - parameter.reach)
    if parameter.name == "delay" and value >= 0.0:
        low = max(0.0, low)  # a function for negative delays needs an addition more
    return low, min(most, value + parameter.reach)


def _ends(
    wanted: Iterable[str] | Mapping[str, tuple[float, float]],
) -> dict[str, tuple[float, float] | None]:
    if isinstance(wanted, Mapping):
        return {effect: (float(low), float(high)) for effect, (low, high) in wanted.items()}
    found: dict[str, tuple[float, float] | None] = {}
    for text in [wanted] if isinstance(wanted, str) else wanted:
        effect, given, ends = str(text).partition("=")
        if effect in found:
            raise UsageError(f"{keyword('per_unit', text)}: {effect} is named twice")
        found[effect] = _range(text, ends) if given else None
    return found


def _range(text: str, ends: str) -> tuple[float, float]:
    low, _, high = ends.partition(":")
    try:
        pair = float(low), float(high)
    except ValueError:
        pair = math.nan, math.nan
    if not all(map(math.isfinite, pair)):
        raise UsageError(
            f"{keyword('per_unit', text)}: give EFFECT or EFFECT=LOW:HIGH, in the unit of the model: "
            f"{keyword('per_unit', 'fixed_delay=0:1e-4')} [s]"
        )
    return pair
