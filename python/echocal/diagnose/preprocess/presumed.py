"""A condition that is only stated for all rows: a part of the base, and a cause if it is wrong."""

from dataclasses import replace

from echocal.diagnose.preprocess.base import Base, Presumed
from echocal.observations import Observations
from echocal.quantities import QUANTITIES
from echocal.registry import Effect, effects

__all__ = ["presume"]


def presume(base: Base, observations: Observations) -> tuple[Base, Observations]:
    """Put each stated condition into the base, as the effect that stands for it where it is not recorded.

    Then this effect competes: its prior is that of the statement. A law that does not read the condition
    ignores it, and a condition that no such effect stands for counts as recorded.

    Returns
    -------
    Base
    Observations
        Without these conditions.
    """
    for quantity, (value, uncertainty) in observations.stated.items():
        effect = _standing_for(quantity, base)
        if effect is None:
            continue
        (size,) = effect.parameters
        at = value - (QUANTITIES[quantity].default or 0.0)  # what the law takes where nothing is recorded
        own = Presumed(quantity, value, uncertainty or size.prior_scale)
        base = replace(
            base,
            effects={**base.effects, effect.id: {size.name: at}},
            presumed={**base.presumed, effect.id: own},
        )
        rest = {name: column for name, column in observations.conditions.items() if name != quantity}
        observations = replace(observations, conditions=rest)
    return base, observations


def _standing_for(quantity: str, base: Base) -> Effect | None:
    """The effect of a condition that is not recorded, if it is exact beside the law of the base."""
    if quantity not in base.plain.reads or quantity in base.air:
        return None
    able = (e for e in effects() if e.excludes == (quantity,) and e.calls == base.law)
    return next((e for e in able if len(e.parameters) == 1 and base.allows(e)), None)
