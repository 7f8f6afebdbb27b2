"""Sets of causes that the data cannot tell apart, as one."""

from collections.abc import Mapping, Sequence, Set
from dataclasses import dataclass, field

from echocal.diagnose.findings.parts import Cause, Refuted
from echocal.diagnose.results.outcome import Outcome

__all__ = ["LEAST", "Group", "grouped", "in_common"]

LEAST = 0.005
"""Probability that is worth a line."""

_SHORT = 2  # members of a class that are listed


@dataclass(frozen=True)
class Group:
    """Sets of causes that differ only in what these data cannot tell apart.

    Attributes
    ----------
    classes : tuple of str
        Each cause, or those that it might be instead.
    shares : tuple of float
        Probability of each set, most probable first.
    members : dict of str to tuple of str
        Behind each class that is too long to be listed in its name: all it might be.
    """

    classes: tuple[str, ...]
    shares: tuple[float, ...]
    members: Mapping[str, tuple[str, ...]] = field(default_factory=dict)

    @property
    def probability(self) -> float:
        """Of all its sets together."""
        return sum(self.shares)

    def beyond(self, common: Set[str]) -> str:
        """What it has beside what every group has, in words."""
        own = [name for name in self.classes if name not in common]
        return " + ".join(own) or ("nothing else" if common else "nothing")


def grouped(diagnosis: Outcome) -> list[Group]:
    """Join the sets of the posterior that the data cannot tell apart, most probable first."""
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


def _class(leader: str, members: list[str]) -> tuple[str, tuple[str, ...]]:
    """Name of a class, and what it holds: the name that the causes have, first."""
    ordered = tuple(sorted(members, key=lambda id_: id_ != leader))
    short = len(ordered) <= _SHORT
    return " or ".join(ordered) if short else f"{ordered[0]} or {len(ordered) - 1} others", ordered


def in_common(groups: Sequence[Group]) -> Set[str]:
    """Classes that stand in every group; none where there is one group only."""
    return set.intersection(*(set(g.classes) for g in groups)) if len(groups) > 1 else set()
