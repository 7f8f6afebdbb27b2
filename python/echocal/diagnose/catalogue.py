"""Both registries under one roof: effects on the mean, and everything else."""

from functools import cache

from echocal.diagnose.facts import CauseFacts
from echocal.diagnose.faults import gross_faults, row_faults
from echocal.diagnose.noises import noises
from echocal.registry import Effect, find_effect

__all__ = ["find_cause", "irregularities"]


@cache
def irregularities() -> tuple[CauseFacts, ...]:
    """Causes that are no effect on the mean: gross faults, faults of rows, noises."""
    return (*gross_faults(), *row_faults(), *noises())


def find_cause(id_: str) -> Effect | CauseFacts:
    """Return what is known about a cause of either registry.

    Raises
    ------
    UsageError
        If there is none of this id.
    """
    known = {facts.id: facts for facts in irregularities()}
    return known[id_] if id_ in known else find_effect(id_)
