"""The figure of the page: each design a line, each world a color."""

from typing import Any

import matplotlib as mpl

mpl.use("Agg")
import matplotlib.pyplot as plt
from matplotlib.axes import Axes
from matplotlib.figure import Figure as Plot

from hidden_effects.bench.page import LOGS, PLACEMENTS

Summary = dict[str, Any]

_IDEAL, _COMPARATOR = "bench, ideal detector", "bench, comparator"
_WORLDS = {"equations": ("C2", "o"), _IDEAL: ("C0", "s"), _COMPARATOR: ("C1", "D"), "real": ("k", "^")}
_PANELS = (
    ("one cause: named", "part of tables"),
    ("false alarms", "part of tables"),
    ("names above 0.9 that are right", "part of names"),
    ("share removed", "part of the mean square"),
)


def beside_plot(s: Summary) -> Plot:
    """Four figures by design, with intervals."""
    lines = ["equations b", *PLACEMENTS, "real placements", "equations c", *LOGS, "real logs"]
    places = {line: -i - (1 if i > len(PLACEMENTS) + 1 else 0) for i, line in enumerate(lines)}
    plot, axes = plt.subplots(1, len(_PANELS), figsize=(13, 6.2), sharey=True)
    for ax, (name, unit) in zip(axes, _PANELS, strict=True):
        for line, at in places.items():
            for world, figure, offset in _points(s, name, line):
                _draw(ax, at + offset, figure, world)
        ax.set(title=name, xlabel=unit, xlim=(-0.03, 1.03))
        ax.grid(axis="x", color="0.9")
    axes[0].set_yticks(list(places.values()), list(places))
    handles = [
        plt.Line2D([], [], color=color, marker=marker, linestyle="-", label=world)
        for world, (color, marker) in _WORLDS.items()
    ]
    told = plt.Line2D([], [], color="0.4", marker="|", markersize=11, linestyle="", label="share as told")
    plot.legend(handles=[*handles, told], loc="lower center", ncols=5, frameon=False)
    plot.tight_layout(rect=(0, 0.06, 1, 1))
    return plot


def _points(s: Summary, name: str, line: str) -> list[tuple[str, Summary, float]]:
    """Worlds, figures and vertical offsets of one line of one panel."""
    kind, _, rest = line.partition(" ")
    if kind == "equations":
        found = (s.get("equations") or {"figures": {}})["figures"]
        return _some("equations", found.get(_row(name, ideal=True), {}).get(rest))
    if kind == "real":
        found = s["real"]["figures"].get(_row(name, ideal=False), {})
        return _some("real", found.get("log" if rest == "logs" else rest))
    rows = {_IDEAL: (_row(name, ideal=True), 0.17), _COMPARATOR: (_row(name, ideal=False), -0.17)}
    if len({row for row, _ in rows.values()}) == 1:
        rows = {_IDEAL: (rows[_IDEAL][0], 0.0)}
    return [p for world, (row, off) in rows.items() for p in _some(world, s["figures"][row].get(line), off)]


def _row(name: str, *, ideal: bool) -> str:
    """Row of the summary that a panel shows."""
    if name in ("one cause: named", "false alarms"):
        return f"{name}, {'ideal detector' if ideal else 'comparator'}"
    return f"{name}, another campaign" if name == "share removed" else name


def _some(world: str, figure: Summary | None, offset: float = 0.0) -> list[tuple[str, Summary, float]]:
    return [] if figure is None else [(world, figure, offset)]


def _draw(ax: Axes, at: float, figure: Summary, world: str) -> None:
    color, marker = _WORLDS[world]
    ax.plot([figure["low"], figure["high"]], [at, at], color=color, linewidth=1.5)
    ax.plot(figure["value"], at, marker, color=color, markersize=6)
