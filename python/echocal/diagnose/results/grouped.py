"""Sets of causes that the data cannot separate, as one group."""

from collections.abc import Mapping, Sequence, Set
from dataclasses import dataclass, field

from echocal.diagnose.candidates.variant import UNKNOWN
from echocal.diagnose.findings.parts import Cause, Refuted
from echocal.diagnose.results.outcome import Outcome

__all__ = ["LEAST", "Group", "grouped", "has_any", "in_common", "reported", "shown_groups"]

OUTSIDE = "effect outside the catalogue"
"""Name of `UNKNOWN` for people."""

LEAST = 0.005
"""Smallest probability that is shown."""

_SHORT = 2  # members of a class that are listed


@dataclass(frozen=True)
class Group:
    """Sets of causes that differ only by causes that these data cannot separate.

    Attributes
    ----------
    classes : tuple of str
        Name of each class: one cause, or several that these data cannot separate.
    shares : tuple of float
        Probability of each set, most probable first.
    members : dict of str to tuple of str
        All causes of each class whose name does not list them.
    """

    classes: tuple[str, ...]
    shares: tuple[float, ...]
    members: Mapping[str, tuple[str, ...]] = field(default_factory=dict)

    @property
    def probability(self) -> float:
        """Sum over its sets."""
        return sum(self.shares)

    def beyond(self, common: Set[str]) -> str:
        """Its classes beyond those that all groups have, in words."""
        own = [name for name in self.classes if name not in common]
        return " + ".join(own) or ("no further cause" if common else "no effect")


def grouped(diagnosis: Outcome) -> list[Group]:
    """Join the sets of the posterior that the data cannot separate, most probable first."""
    claimed: list[Cause | Refuted] = [*diagnosis.causes, *diagnosis.refuted]
    leader: dict[str, str] = {}
    for cause in claimed:
        for id_ in (cause.id, *cause.indistinguishable_from):
            leader.setdefault(id_, cause.id)
    seen: dict[str, list[str]] = {}
    shares: dict[tuple[str, ...], list[float]] = {}
    for ids, probability in diagnosis.posterior:
        key = tuple(sorted({leader.get(id_, id_) for id_ in ids}))
        shares.setdefault(key, []).append(probability)
        for id_ in ids if probability >= LEAST else ():
            members = seen.setdefault(leader.get(id_, id_), [])
            members += [id_] if id_ not in members else []
    groups = []
    for key, parts in shares.items():
        named = dict(_class(id_, seen.get(id_, [id_])) for id_ in key)
        long = {name: members for name, members in named.items() if len(members) > _SHORT}
        groups.append(Group(tuple(named), tuple(sorted(parts, reverse=True)), long))
    return sorted(groups, key=lambda group: -group.probability)


def reported(diagnosis: Outcome) -> Set[str]:
    """Causes that the verdict reports: effects of the model, and faults and noises."""
    return {cause.id for cause in diagnosis.causes if cause.in_model or cause.kind != "effect"}


def has_any(group: Group, ids: Set[str]) -> bool:
    """Whether one of these causes is in the sets of a group."""
    return any(not ids.isdisjoint(group.members.get(name, name.split(" or "))) for name in group.classes)


def shown_groups(diagnosis: Outcome, most: int) -> list[Group]:
    """The most probable groups; the first one with a reported cause is among them."""
    every = [group for group in grouped(diagnosis) if group.probability >= LEAST]
    chosen, ids = every[:most], reported(diagnosis)
    own = next((group for group in every if has_any(group, ids)), None)
    return chosen if own is None or own in chosen else [*chosen[:-1], own]


def _class(leader: str, members: list[str]) -> tuple[str, tuple[str, ...]]:
    """Name of a class, and its causes: the listed one first."""
    ids = sorted(members, key=lambda id_: id_ != leader)
    ordered = tuple(OUTSIDE if id_ == UNKNOWN else id_ for id_ in ids)
    short = len(ordered) <= _SHORT
    return " or ".join(ordered) if short else f"{ordered[0]} or {len(ordered) - 1} others", ordered


def in_common(groups: Sequence[Group]) -> Set[str]:
    """Classes that every group has; none if there is only one group."""
    return set.intersection(*(set(g.classes) for g in groups)) if len(groups) > 1 else set()
