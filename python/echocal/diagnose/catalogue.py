"""All causes: the registry of effects on the mean, and those of faults and noises."""

from echocal.diagnose.faults import gross_faults, row_faults
from echocal.diagnose.findings.facts import CauseFacts
from echocal.diagnose.noises import noises
from echocal.registry import Effect, effects, found

__all__ = ["causes", "find_cause", "irregularities"]


def irregularities() -> tuple[CauseFacts, ...]:
    """Causes that are not effects on the mean: gross faults, faults of rows, noises."""
    return (*gross_faults(), *row_faults(), *noises())


def causes() -> tuple[Effect | CauseFacts, ...]:
    """Every cause of both registries."""
    every: list[Effect | CauseFacts] = [*effects(), *irregularities()]
    return tuple(every)


def find_cause(id_: str) -> Effect | CauseFacts:
    """Return the facts of a cause of any registry.

    Raises
    ------
    UsageError
        If there is none of this id; the text suggests the nearest.
    """
    return found(id_, {facts.id: facts for facts in causes()}, "cause")
