"""The figure of the page: each design a line, each world a color."""

from typing import Any

import matplotlib as mpl

mpl.use("Agg")
import matplotlib.pyplot as plt
from matplotlib.axes import Axes
from matplotlib.figure import Figure as Plot
from matplotlib.lines import Line2D

from hidden_effects.bench.world import LOGS, PLACEMENTS

Summary = dict[str, Any]

_IDEAL, _COMPARATOR = "bench, ideal detector", "bench, comparator"
_MEANS = "bench, ideal detector, a row a placement"
_WORLDS = {
    "equations": ("C2", "o"),
    _IDEAL: ("C0", "s"),
    _COMPARATOR: ("C1", "D"),
    _MEANS: ("C4", "v"),
    "real": ("k", "^"),
}
_BOTH = {
    "one cause: named": "one cause: named, {}",
    "false alarms": "false alarms, {}",
    "share removed": "share removed in another campaign, {}",
}
_OF_MEANS = {
    "one cause: named": "a row a placement, ideal detector: one cause named",
    "false alarms": "a row a placement, ideal detector: false alarms",
}
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
    plot, axes = plt.subplots(1, len(_PANELS), figsize=(13, 7.2), sharey=True)
    for ax, (name, unit) in zip(axes, _PANELS, strict=True):
        for line, at in places.items():
            for world, figure, offset in _points(s, name, line):
                _draw(ax, at + offset, figure, world)
        ax.set(title=name, xlabel=unit, xlim=(-0.03, 1.03))
        ax.set_ylim(min(places.values()) - 0.6, 0.6)
        ax.grid(axis="x", color="0.9")
    axes[0].set_yticks(list(places.values()), list(places))
    handles = [
        Line2D([], [], color=color, marker=marker, linestyle="-", label=world)
        for world, (color, marker) in _WORLDS.items()
    ]
    told = Line2D([], [], color="0.4", marker="|", markersize=11, linestyle="", label="share removed as told")
    plot.legend(handles=[*handles, told], loc="lower center", ncols=3, frameon=False)
    plot.tight_layout(rect=(0, 0.09, 1, 1))
    return plot


def _points(s: Summary, name: str, line: str) -> list[tuple[str, Summary, float]]:
    """Worlds, figures and vertical offsets of one line of one panel; the figure told stands in `told`."""
    kind, _, rest = line.partition(" ")
    if kind == "equations":
        held = (s.get("equations") or {"figures": {}})["figures"]
        return _some("equations", held, name, rest, "ideal detector")
    if kind == "real":
        return _some("real", s["real"]["figures"], name, "log" if rest == "logs" else rest, "comparator")
    if name not in _BOTH:
        return _some(_IDEAL, s["figures"], name, line, "")
    ideal = _some(_IDEAL, s["figures"], name, line, "ideal detector", 0.2)
    walks = _some(_COMPARATOR, s["figures"], name, line, "comparator", -0.2)
    return [*ideal, *walks, *_some(_MEANS, s["figures"], _OF_MEANS.get(name, ""), line, "", 0.0)]


def _some(
    world: str, figures: Summary, name: str, where: str, detector: str, offset: float = 0.0
) -> list[tuple[str, Summary, float]]:
    """The figure of one place, if it is there."""
    row = _BOTH[name].format(detector) if name in _BOTH else name
    found = figures.get(row, {}).get(where)
    if found is None and name == "share removed":  # real records have only what is told
        found = figures.get(row.replace("in another campaign", "as told"), {}).get(where)
        return [] if found is None else [(world, {"told": found["value"]}, offset)]
    told = figures.get(row.replace("in another campaign", "as told"), {}).get(where)
    return [] if found is None else [(world, {**found, "told": told and told["value"]}, offset)]


def _draw(ax: Axes, at: float, figure: Summary, world: str) -> None:
    color, marker = _WORLDS[world]
    if "value" in figure:
        ax.plot([figure["low"], figure["high"]], [at, at], color=color, linewidth=1.5)
        ax.plot(figure["value"], at, marker, color=color, markersize=6)
    if figure["told"] is not None and figure["told"] != figure.get("value"):
        ax.plot(figure["told"], at, "|", color=color, markersize=12, markeredgewidth=2)
