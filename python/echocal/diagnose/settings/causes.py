"""Numbers that decide, each with its value, unit and source; and those of single causes."""

from collections.abc import Collection, Iterable, Iterator, Mapping
from dataclasses import dataclass, field, fields, is_dataclass, replace
from typing import Any, NamedTuple, TypeVar

from echocal.diagnose.findings.facts import CauseFacts
from echocal.errors import UsageError

__all__ = ["CauseSettings", "NoThresholds", "Threshold", "every_threshold", "listed_thresholds"]

T = TypeVar("T")


class Threshold(NamedTuple):
    """One number that decides; its name is the path inside the settings: ``crosstalk.least``."""

    name: str
    value: Any
    unit: str
    source: str


def listed_thresholds(settings: object, name: str = "") -> Iterator[Threshold]:
    """List all numbers of a dataclass of thresholds, including those of the dataclasses inside it."""
    if not is_dataclass(settings):
        return
    for each in fields(settings):
        value, path = getattr(settings, each.name), f"{name}.{each.name}" if name else each.name
        if is_dataclass(value):
            yield from listed_thresholds(value, path)
        elif "unit" in each.metadata:
            yield Threshold(path, value, each.metadata["unit"], each.metadata["source"])


@dataclass(frozen=True)
class NoThresholds:
    """Thresholds of a cause that has none of its own."""


@dataclass(frozen=True)
class CauseSettings:
    """Numbers of single causes that replace the defaults.

    Attributes
    ----------
    priors : mapping of str to float
        Prior probability by id; default: that of the cause's facts.
    thresholds : mapping of str to object
        Thresholds by id, of the class ``Thresholds`` in the file of the cause; default: that class
        without arguments.
    """

    priors: Mapping[str, float] = field(default_factory=dict)
    thresholds: Mapping[str, object] = field(default_factory=dict)

    def prior(self, facts: CauseFacts) -> float:
        """Prior probability that a table has the cause."""
        return self.priors.get(facts.id, facts.prior)

    def facts(self, facts: CauseFacts) -> CauseFacts:
        """Facts of a cause with the prior of these settings."""
        return replace(facts, prior=self.priors[facts.id]) if facts.id in self.priors else facts

    def of(self, facts: CauseFacts, kind: type[T]) -> T:
        """Thresholds of one cause."""
        own = self.thresholds.get(facts.id)
        if own is None:
            return kind()
        if isinstance(own, Mapping):  # as a diagnosis records it
            return kind(**own)
        if not isinstance(own, kind):
            message = (
                f"thresholds of {facts.id} are a {type(own).__name__}; give a {kind.__module__}.Thresholds"
            )
            raise UsageError(message)
        return own

    def refuse_others(self, ids: Collection[str], noun: str) -> None:
        """Refuse numbers of causes that there are not.

        Raises
        ------
        UsageError
        """
        for id_ in (*self.priors, *self.thresholds):
            if id_ not in ids:
                message = f"settings: there is no {noun} '{id_}'; known: {', '.join(sorted(ids))}"
                raise UsageError(message)


def every_threshold(settings: CauseSettings, causes: Iterable[Any]) -> Iterator[Threshold]:
    """List every number that decides about causes of a registry: shared ones, priors, and those of each."""
    yield from listed_thresholds(settings)
    for cause in causes:
        facts = cause.facts
        yield Threshold(f"{facts.id}.prior", settings.prior(facts), "1", facts.prior_source)
        yield from listed_thresholds(settings.of(facts, type(cause.thresholds)), facts.id)
