"""What to measure next, as a picture."""

import numpy as np
from matplotlib.axes import Axes

from echocal.diagnose import Diagnosis, NextMeasurement
from echocal.diagnose.explain import proposal_text
from echocal.diagnose.sentences import shown

__all__ = ["plot_next"]

_SEEN, _PROPOSED = "#b9c4ca", "#b5530f"


def plot_next(diagnosis: Diagnosis, ax: Axes) -> None:
    """Rows proposed among the rows measured, over the two conditions that the proposal varies.

    Parameters
    ----------
    diagnosis : Diagnosis
    ax : matplotlib.axes.Axes
    """
    plans = [p for p in diagnosis.next_measurements if p.expected_probability is not None]
    if not plans:
        ax.axis("off")
        texts = [proposal_text(p) for p in diagnosis.next_measurements] or ["nothing is left to separate"]
        ax.text(0.0, 1.0, "\n".join(texts), va="top", wrap=True, transform=ax.transAxes)
        return
    (plan, *_) = plans
    names = [name for name in plan.conditions if name != "rows"][:2]
    for name, axis in zip(names, ("x", "y"), strict=False):
        ax.set(**{f"{axis}label": shown(name, np.zeros(1))[1]})
    measured = [diagnosis.traces.against.get(name) for name in names]
    if len(names) == 2 and all(column is not None for column in measured):
        seen = [shown(n, c)[0] for n, c in zip(names, measured, strict=True) if c is not None]
        ax.plot(*seen, "o", color=_SEEN, mew=0, markersize=4, label="measured")
    _places(plan, names, ax)
    ax.margins(0.15)
    ax.legend(loc="best", frameon=False)
    ax.set_title(_title(plan), fontsize=8, loc="left")


def _places(plan: NextMeasurement, names: list[str], ax: Axes) -> None:
    values = [shown(name, np.array(plan.conditions[name]))[0] for name in names]
    rows = plan.conditions["rows"]
    if len(values) == 1:
        values.append(np.zeros(len(rows)))
        ax.set_yticks([])
    ax.plot(*values, "D", color=_PROPOSED, markersize=9, label="to measure")
    for x, y, count in zip(*values, rows, strict=True):
        ax.annotate(f"{count} rows", (x, y), xytext=(8, 6), textcoords="offset points", color=_PROPOSED)


def _title(plan: NextMeasurement) -> str:
    shown_names = ", ".join(plan.separates[:4]) + (", ..." if len(plan.separates) > 4 else "")
    return (
        f"tells apart: {shown_names}\nthe right one: {plan.probability_now:.2f} probable now, "
        f"{plan.expected_probability:.2f} expected then"
    )
