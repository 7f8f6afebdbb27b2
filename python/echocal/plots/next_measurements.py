"""Plot of the next measurements."""

import textwrap

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from echocal.diagnose import Diagnosis, NextMeasurement
from echocal.diagnose.findings.sentences import shown
from echocal.diagnose.results.explain import proposal_text

__all__ = ["next_figure", "plot_next"]

_WIDTH = 100  # characters of a line of words
_TICK = 0.02  # part of an axis
_SEEN, _PROPOSED = "#a9b6bd", "#b5530f"


def next_figure(diagnosis: Diagnosis) -> Figure:
    """Proposed rows among the measured rows, and side measurements in words."""
    sides = [p for p in diagnosis.next_measurements if p.expected_probability is None]
    rows = len(sides) < len(diagnosis.next_measurements)
    lines = [textwrap.fill(proposal_text(p), _WIDTH, subsequent_indent="   ") for p in sides]
    if not rows and not sides:
        lines = ["no further causes are to be separated"]
    text = "\n".join(lines)
    heights = [3.8] * rows + [0.25 + 0.16 * (1 + text.count("\n"))] * bool(lines)
    figure = Figure(figsize=(6.5, sum(heights)), layout="constrained")
    axes = figure.subplots(len(heights), height_ratios=heights, squeeze=False).ravel()
    if rows:
        plot_next(diagnosis, axes[0])
    if lines:
        axes[-1].axis("off")
        axes[-1].text(0.0, 1.0, text, va="top", fontsize=8, transform=axes[-1].transAxes)
    return figure


def plot_next(diagnosis: Diagnosis, ax: Axes) -> None:
    """Proposed rows among the measured rows, over the two conditions that the proposal varies.

    Parameters
    ----------
    diagnosis : Diagnosis
    ax : matplotlib.axes.Axes
    """
    plans = [p for p in diagnosis.next_measurements if p.expected_probability is not None]
    if not plans:
        ax.axis("off")
        ax.text(
            0.0,
            1.0,
            "no rows in these ranges would separate the causes",
            va="top",
            transform=ax.transAxes,
        )
        return
    (plan, *_) = plans
    names = [name for name in plan.conditions if name != "rows"][:2]
    for name, axis in zip(names, ("x", "y"), strict=False):
        ax.set(**{f"{axis}label": shown(name, np.zeros(1))[1]})
    _measured(diagnosis, names, ax)
    _places(plan, names, ax)
    for side in (ax.xaxis, ax.yaxis):  # a single place has a range of zero
        low, high = side.get_data_interval()
        room = max(0.15 * (high - low), 0.1 * abs(high))
        side.set_view_interval(low - room, high + room, ignore=True)
    ax.legend(loc="upper left", bbox_to_anchor=(1.0, 1.0), frameon=False, fontsize=8)
    ax.set_title(_title(plan), fontsize=8, loc="left")


def _measured(diagnosis: Diagnosis, names: list[str], ax: Axes) -> None:
    """Measured rows; where one of the two conditions is not recorded, ticks along the other axis."""
    columns = [diagnosis.traces.against.get(name) for name in names]
    known = {name: shown(name, c)[0] for name, c in zip(names, columns, strict=True) if c is not None}
    if len(known) == len(names) == 2:
        ax.plot(*known.values(), "o", color=_SEEN, mew=0, markersize=4, label="measured")
    elif names[0] in known:
        across = ax.get_xaxis_transform()
        ax.vlines(known[names[0]], 0.0, _TICK, _SEEN, transform=across, label="measured")
    elif names[1:2] and names[1] in known:
        along = ax.get_yaxis_transform()
        ax.hlines(known[names[1]], 0.0, _TICK, _SEEN, transform=along, label="measured")


def _places(plan: NextMeasurement, names: list[str], ax: Axes) -> None:
    values = [shown(name, np.array(plan.conditions[name]))[0] for name in names]
    rows = plan.conditions["rows"]
    if len(values) == 1:
        values.append(np.zeros(len(rows)))
        ax.set_yticks([])
    alike = len(set(rows)) == 1  # then the legend says it once
    label = f"to measure, {rows[0]} rows each" if alike else "to measure"
    ax.plot(*values, "D", color=_PROPOSED, markersize=9, label=label)
    for place, (x, y, count) in enumerate(zip(*values, rows, strict=True)):
        if not alike:
            at = (8, 6 if place % 2 else -14)
            ax.annotate(f"{count} rows", (x, y), xytext=at, textcoords="offset points", color=_PROPOSED)


def _title(plan: NextMeasurement) -> str:
    shown_names = ", ".join(plan.separates[:4]) + (", ..." if len(plan.separates) > 4 else "")
    return (
        f"separates: {shown_names}\nprobability of the most probable set of effects: "
        f"{plan.probability_now:.2f} now, {plan.expected_probability:.2f} expected afterwards"
    )
