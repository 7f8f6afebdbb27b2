"""Plot of the probabilities of sets of causes."""

import textwrap
from collections.abc import Set

from matplotlib.axes import Axes

from echocal.diagnose import Diagnosis
from echocal.diagnose.results.explain import class_texts, lead
from echocal.diagnose.results.grouped import LEAST, Group, has_any, in_common, reported, shown_groups
from echocal.plots.labels import title_beside

__all__ = ["plot_posterior"]

_COLOR, _OTHER = "#155a75", "#a9b6bd"  # sets with a cause that the verdict reports, and the others
_MOST = 6  # bars
_FEWEST = 2  # bars that there is always room for, so that a single one is not too high
_WIDTH = 46  # characters of a label's line


def plot_posterior(diagnosis: Diagnosis, ax: Axes) -> None:
    """Probability of the sets of causes; sets that the data cannot separate share a bar.

    Parameters
    ----------
    diagnosis : Diagnosis
    ax : matplotlib.axes.Axes
    """
    claimed = reported(diagnosis)
    groups = shown_groups(diagnosis, _MOST)
    common = in_common(groups)
    labels = []
    for place, group in enumerate(groups):
        labels.append(textwrap.fill(_label(group, common), _WIDTH))
        color = _COLOR if has_any(group, claimed) else _OTHER
        left = 0.0
        for share in group.shares:
            ax.barh(place, share, left=left, height=0.6, color=color, edgecolor="white", linewidth=0.8)
            left += share
        ax.text(left + 0.015, place, f"{left:.3f}", va="center")
    ax.set_yticks(range(len(groups)), labels)
    ax.set_ylim(max(len(groups), _FEWEST) - 0.5, -0.5)
    ax.set(
        xlim=(0.0, 1.15),
        xticks=[0.0, 0.25, 0.5, 0.75, 1.0],
        xlabel="probability that exactly these causes act",
    )
    said = lead(diagnosis)
    finding = f"{diagnosis.verdict}: {said[0].lower()}{said[1:]}"
    width = title_beside(labels, ax)
    told = (finding, *class_texts(diagnosis), *_remarks(groups, common, claimed))
    lines = [textwrap.fill(text, width) for text in told]
    ax.set_title("\n".join(lines), fontsize=8, loc="left")


def _label(group: Group, common: Set[str]) -> str:
    """What acts beyond the causes of all sets; the set without more is these causes themselves."""
    more = f"{'+ ' * bool(common)}{group.beyond(common)}"
    return more if set(group.classes) - common else " + ".join(group.classes) or "no effect"


def _remarks(groups: list[Group], common: Set[str], claimed: Set[str]) -> list[str]:
    remarks = []
    if common:
        remarks.append(f"in every set: {', '.join(sorted(common))}")
    if len({has_any(group, claimed) for group in groups}) > 1:
        remarks.append("dark: sets with a cause that the verdict reports")
    if any(len(group.shares) > 1 and group.shares[1] >= LEAST for group in groups):
        remarks.append("the parts of a bar are sets that these data cannot separate")
    for name, members in {name: m for group in groups for name, m in group.members.items()}.items():
        remarks.append(f"{name}: {', '.join(members[1:])}")
    return remarks
