"""Plot of flash, time and error of firmware."""

from collections.abc import Mapping, Sequence
from typing import Any

import matplotlib.pyplot as plt
from matplotlib.axes import Axes
from matplotlib.colors import LogNorm
from matplotlib.lines import Line2D
from matplotlib.ticker import LogLocator, NullFormatter, ScalarFormatter

_NEAR = 1.15  # points closer than this in both axes share a label
_MARKERS = ("o", "s", "^", "D", "v", "P", "X")
_KINDS = ("polynomial", "product", "square", "segments", "linear between", "table", "speed factor")
_NAMES = {
    "product": "product of two lines",
    "linear between": "interpolated table",
    "speed factor": "one speed",
}


def plot_choices(choices: Sequence[Mapping[str, Any]], ax: Axes | None = None) -> Axes:
    """Draw flash against time of the Pareto front. Color and label show the proven error.

    The choices are what `echocal.explore.Choice.to_dict` gives; without axes a new figure is made.
    """
    if ax is None:
        ax = plt.figure(figsize=(8.0, 5.0), layout="constrained").add_subplot()
    errors = [choice["error_proven_m"] * 1e3 for choice in choices]
    norm = LogNorm(min(errors), max(max(errors), 1.01 * min(errors)))
    names = sorted({_short(choice["form"]) for choice in choices})
    marks = dict(zip(names, _MARKERS * len(names), strict=False))
    labeled: list[tuple[int, int]] = []
    for choice, error in zip(choices, errors, strict=True):
        place = (choice["flash_bytes"], choice["steps"])
        marker = marks[_short(choice["form"])]
        drawn = ax.scatter(
            *place, c=[error], norm=norm, cmap="viridis", s=60, marker=marker, edgecolor="0.2", zorder=3
        )
        if not any(_near(place, other) for other in labeled):
            labeled.append(place)
            ax.annotate(
                f"{error:.2g}", place, (0, 7), textcoords="offset points", ha="center", fontsize=7, zorder=4
            )
    ax.figure.colorbar(drawn, ax=ax, label="largest error, proven [mm]")
    measured = {choice["core"] for choice in choices if choice["core"]}
    unit = choices[0]["unit"]
    whole = all(choice["core"] for choice in choices)
    source = f"measured on {', '.join(sorted(measured))}" if whole else "by the cost model, not measured"
    ax.set(xscale="log", yscale="log", xlabel="flash [byte]", ylabel=f"{unit} per call")
    ax.set_title(f"Pareto front of flash, time and error: costs {source}", fontsize="medium")
    for axis in (ax.xaxis, ax.yaxis):
        axis.set_major_locator(LogLocator(subs=(1.0, 2.0, 3.0, 5.0)))
        axis.set_major_formatter(ScalarFormatter())
        axis.set_minor_formatter(NullFormatter())
    keys = [
        Line2D([], [], ls="none", marker=marker, label=name, mfc="none", mec="0.2")
        for name, marker in marks.items()
    ]
    ax.legend(handles=keys, fontsize="small", frameon=False)
    ax.grid(alpha=0.3, which="major")
    ax.margins(0.08)
    return ax


def _near(place: tuple[int, int], other: tuple[int, int]) -> bool:
    return all(max(a, b) <= _NEAR * min(a, b) for a, b in zip(place, other, strict=True))


def _short(form: str) -> str:
    """Return the kind of a form, in a word or two; the first part of a joined one."""
    base, joined, _ = form.partition(" plus the humidity")
    kind = next((kind for kind in _KINDS if kind in base), base)
    name = _NAMES.get(kind, kind)
    return f"{name} + humidity" if joined else name
