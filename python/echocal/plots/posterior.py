"""How probable the sets of causes are, as a picture."""

import textwrap
from dataclasses import dataclass

from matplotlib.axes import Axes

from echocal.diagnose import Cause, Diagnosis, Refuted

__all__ = ["Group", "grouped", "plot_posterior"]

_COLOR = "#1f6f8b"
_MOST = 6  # bars
_LEAST = 0.005  # probability worth a bar
_WIDTH = 46  # characters of a label's line
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
    """

    classes: tuple[str, ...]
    shares: tuple[float, ...]

    @property
    def probability(self) -> float:
        """Of all its sets together."""
        return sum(self.shares)


def grouped(diagnosis: Diagnosis) -> list[Group]:
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
        for id_ in ids if probability >= _LEAST else ():
            members = seen.setdefault(leader.get(id_, id_), [])
            members += [id_] if id_ not in members else []
    groups = [
        Group(tuple(_class(seen.get(id_, [id_])) for id_ in key), tuple(sorted(parts, reverse=True)))
        for key, parts in shares.items()
    ]
    return sorted(groups, key=lambda group: -group.probability)


def _class(members: list[str]) -> str:
    if len(members) <= _SHORT:
        return " or ".join(members)
    return f"{members[0]} or {len(members) - 1} others"


def plot_posterior(diagnosis: Diagnosis, ax: Axes) -> None:
    """Probability of the sets of causes, those that cannot be told apart in one bar.

    Parameters
    ----------
    diagnosis : Diagnosis
    ax : matplotlib.axes.Axes
    """
    groups = [group for group in grouped(diagnosis) if group.probability >= _LEAST][:_MOST]
    common = set.intersection(*(set(group.classes) for group in groups)) if len(groups) > 1 else set()
    labels = []
    for place, group in enumerate(groups):
        own = [name for name in group.classes if name not in common]
        labels.append(textwrap.fill(" + ".join(own) or ("nothing else" if common else "nothing"), _WIDTH))
        left = 0.0
        for share in group.shares:
            ax.barh(place, share, left=left, height=0.6, color=_COLOR, edgecolor="white", linewidth=0.8)
            left += share
        ax.text(left + 0.015, place, f"{left:.3f}", va="center")
    ax.set_yticks(range(len(groups)), labels)
    ax.invert_yaxis()
    ax.set(xlim=(0.0, 1.15), xticks=[0.0, 0.25, 0.5, 0.75, 1.0], xlabel="probability")
    ax.set_title("\n".join(_remarks(groups, common)), fontsize=8, loc="right")


def _remarks(groups: list[Group], common: set[str]) -> list[str]:
    remarks = []
    if common:
        remarks.append(textwrap.fill(f"in every set: {', '.join(sorted(common))}", 2 * _WIDTH))
    if any(len(group.shares) > 1 and group.shares[1] >= _LEAST for group in groups):
        remarks.append("the parts of a bar are sets that these data cannot tell apart")
    return remarks
