"""The registry of effects as typed data."""

from collections.abc import Mapping
from dataclasses import asdict, dataclass
from functools import cache
from typing import Any, Literal, TypeVar

from echocal import _core
from echocal.errors import UsageError, among

__all__ = ["Effect", "Parameter", "effects", "find_effect", "found"]

T = TypeVar("T")


@dataclass(frozen=True)
class Parameter:
    """One parameter of an effect.

    Attributes
    ----------
    name, unit : str
        Name, and SI unit (or ``"1"``).
    role : {"size", "shape"}
        A size measures how large the effect is; a shape is a nonlinear parameter. If every size is neutral,
        the effect changes nothing.
    neutral : float
        For a size, the value at which the effect changes nothing; for a shape, its usual value.
    bounds : tuple of float
        Physical bounds, inclusive.
    prior_scale : float
        Typical magnitude of the deviation from neutral: one standard deviation of its prior.
    known : tuple of float
        The values that theory or common practice fix; empty if there are none.
    tried : tuple of float
        The values of a shape at which a search tries the effect, besides `known`.
    tried_along : str or None
        ``"distance"`` or an influence quantity: `tried` are then quantiles (0 to 1) of that column.
    tail : float
        How many times wider the tail of the prior is; 1 where it has none.
    over : tuple of (str, float) or None
        The range of an influence quantity that `prior_scale` is meant for; over a longer range the
        scale is smaller in proportion.
    divides : str or None
        An influence quantity: the effect is one thing in rows up to this value, another in all beyond.
    """

    name: str
    unit: str
    role: Literal["size", "shape"]
    neutral: float
    bounds: tuple[float, float]
    prior_scale: float
    known: tuple[float, ...]
    tried: tuple[float, ...]
    tried_along: str | None
    tail: float
    over: tuple[str, float] | None
    divides: str | None

    @classmethod
    def from_core(cls, facts: dict[str, Any]) -> "Parameter":
        """Convert the core's data to this type."""
        return cls(**{**facts, **{name: tuple(facts[name]) for name in ("known", "tried")}})


@dataclass(frozen=True)
class Effect:
    """What is known about an effect: a deviation of a real sensor from its simulation."""

    id: str
    """Name in models, files and messages."""
    stage: str
    # sentence, formula, source: description, formula and source; primed symbols are the values after the
    # effect
    """Stage of the measurement chain at which it acts."""
    sentence: str
    formula: str
    source: str
    reads: tuple[str, ...]
    # requires, excludes: quantities that must, or must not, be recorded; otherwise the effect has no meaning
    """Influence quantities that it depends on."""
    requires: tuple[str, ...]
    excludes: tuple[str, ...]
    supplies: str | None
    """Quantity whose influence it adds: a law that reads that quantity refuses the effect."""
    calls: str | None
    """Law that its formula uses: the effect holds where that law holds."""
    extends: tuple[str, ...]
    """The only laws that it can extend; empty where it extends any."""
    parameters: tuple[Parameter, ...]
    """In the order of `Model.parameter_names`."""
    edges: bool
    """Whether its formula has edges, where a derivative jumps."""
    recurs: bool
    """Whether it also applies to another campaign. Effects that began or grew during one do not."""
    prior: float
    # domain, check: where it holds, and the measurement that confirms or refutes it
    """How probable it is before the data, beside a usual effect (1)."""
    domain: str
    check: str
    firmware: Literal["folded", "needs", "refused"]
    """How a microcontroller compensates it: in its tables, with a further input, or not at all; one of
    {"folded", "needs", "refused"}."""
    firmware_detail: str | None
    """The further input, or the reason for the refusal."""

    @classmethod
    def from_core(cls, facts: dict[str, Any]) -> "Effect":
        """Convert the core's data to this type."""
        lists = {name: tuple(facts[name]) for name in ("reads", "requires", "excludes", "extends")}
        parameters = tuple(Parameter.from_core(p) for p in facts["parameters"])
        return cls(**{**facts, **lists, "parameters": parameters})

    def to_dict(self) -> dict[str, Any]:
        """As plain data, for JSON."""
        return {"id": self.id, "kind": "effect", **asdict(self)}


@cache
def effects() -> tuple[Effect, ...]:
    """Return the registry: every effect that echocal knows.

    Returns
    -------
    tuple of Effect
        Facts of each effect: id, stage, sentence, formula, source, parameters, domain, firmware
        form and more.

    Examples
    --------
    >>> import echocal
    >>> delay = next(effect for effect in echocal.effects() if effect.id == "fixed_delay")
    >>> delay.formula
    "t' = t + delay"
    >>> delay.parameters[0].unit
    's'
    """
    return tuple(Effect.from_core(facts) for facts in _core.effects())


def find_effect(id_: str) -> Effect:
    """Return the effect of this id.

    Raises `UsageError` if there is none; the text suggests the nearest.

    Examples
    --------
    >>> from echocal.registry import find_effect
    >>> find_effect("humidity").firmware_detail
    'relative_humidity'
    """
    return found(id_, _by_id(), "effect")


@cache
def _by_id() -> Mapping[str, Effect]:
    return {effect.id: effect for effect in effects()}


def found(id_: str, known: Mapping[str, T], what: str) -> T:
    """Return the entry of this id, or raise `UsageError` with the nearest that there is."""
    if id_ not in known:
        raise UsageError(f"unknown {what} '{id_}'{among(id_, known, 'known:')}")
    return known[id_]
