"""Plots of sweeps."""

from itertools import pairwise
from typing import Any

import matplotlib.pyplot as plt
import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.colors import Normalize
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from numpy.typing import NDArray

from echocal.quantities import QUANTITIES
from echocal.quantities.units import printed

# what a person reads: unit on paper, and its size in the unit of the grid
_SHOWN = {
    "error": ("mm", 1e-3),
    "time_of_flight": ("ms", 1e-3),
    "speed_of_sound": ("m/s", 1.0),
    "indication": ("m", 1.0),
}
_NAMES = {name: name.replace("_", " ") for name in _SHOWN} | {"time_of_flight": "echo time"}
_LEGEND = 6  # more lines than this are read from a color bar
_ROUNDING = 1e-9  # a nanosecond, a nanometer: less is nothing to see
_DASHES = ("-", "--", ":", "-.")


def plot_sweep(grid: xr.Dataset, variable: str = "error", ax: Axes | None = None) -> Axes:
    """Draw one variable of a sweep: its longest dimension along x, one line for each of the rest.

    The next dimension that matters gives the lines their color, the one after it their dashes.

    Parameters
    ----------
    grid : xarray.Dataset
        Result of `echocal.sweep`, with at least one dimension.
    variable : str
        Name of a variable of the grid.
    ax : matplotlib axes, optional
        Where to draw; a new figure by default.

    Returns
    -------
    matplotlib axes
        The axes that were drawn on.

    Examples
    --------
    >>> import echocal
    >>> from echocal.plots.sweep import plot_sweep
    >>> ax = plot_sweep(echocal.sweep("cramer", temperature=(0, 50, 2)), "speed_of_sound")
    >>> ax.get_ylabel()
    'speed of sound [m/s]'
    """
    ax = plt.subplots(layout="constrained")[1] if ax is None else ax
    along, *rest = sorted(grid.sizes, key=lambda name: -grid.sizes[name])
    unit, size = _SHOWN[variable]
    values = grid[variable] / size
    others = [name for name in rest if _varies_along(grid[variable], str(name))]
    values = values.isel(dict.fromkeys(set(rest) - set(others), 0))
    lines = values.stack(line=others) if others else values.expand_dims("line")
    styles = _styles(grid, others)
    few = lines.sizes["line"] <= _LEGEND
    for number in range(lines.sizes["line"]):
        line = lines.isel(line=number)
        color, dash = styles[number]
        marker = "o" if grid.sizes[along] <= 60 and few else ""
        ax.plot(grid[along], line, dash, color=color, lw=1.6, marker=marker, markersize=3)
    ax.set_xlabel(_label(grid, str(along)))
    ax.set_ylabel(f"{_NAMES[variable]} [{unit}]")
    ax.grid(alpha=0.25)
    ax.spines[["top", "right"]].set_visible(False)
    ax.margins(x=0.02)
    if variable == "error":
        ax.axhline(0.0, color="0.4", lw=0.8, zorder=0)
    _explain(grid, others, ax)
    return ax


def _varies_along(values: xr.DataArray, name: str) -> bool:
    return float((values.max(name) - values.min(name)).max()) > _ROUNDING


def _styles(grid: xr.Dataset, others: list[Any]) -> list[tuple[Any, str]]:
    """Color and dash of every line: the first dimension gives the color, the second the dash."""
    if not others:
        return [(_shades(1)[0], "-")]
    shades = _shades(grid.sizes[others[0]])
    places = np.ndindex(*(grid.sizes[name] for name in others))
    return [(shades[place[0]], _DASHES[(place[1:] or (0,))[0] % len(_DASHES)]) for place in places]


def _shades(count: int) -> NDArray[np.float64]:
    # the lines stop at 0.85 of the map, where yellow is still legible on white
    return np.asarray(plt.get_cmap("viridis")(np.linspace(0.0, 0.85, count) if count > 1 else [0.3]))


def _explain(grid: xr.Dataset, others: list[Any], ax: Axes) -> None:
    """Say what colors and dashes mean: a legend, or a color bar where the colors are many."""
    handles: list[Line2D] = []
    if others and grid.sizes[others[0]] > _LEGEND:
        _color_bar(grid, str(others[0]), ax)
    elif others:
        shades, values = _shades(grid.sizes[others[0]]), grid[others[0]]
        texts = [_value(grid, str(others[0]), value) for value in values]
        handles += [
            Line2D([], [], color=shade, label=text) for shade, text in zip(shades, texts, strict=True)
        ]
    if len(others) > 1 and grid.sizes[others[1]] <= len(_DASHES):
        texts = [_value(grid, str(others[1]), value) for value in grid[others[1]]]
        handles += [
            Line2D([], [], color="0.3", ls=dash, label=text)
            for dash, text in zip(_DASHES, texts, strict=False)
        ]
    if handles:
        ax.legend(
            handles=handles, frameon=False, fontsize="small", loc="upper left", bbox_to_anchor=(1.0, 1.0)
        )


def sweep_figure(grid: xr.Dataset) -> Figure:
    """Draw what changes over a sweep, one panel for each variable.

    The grid is a result of `echocal.sweep` with at least one dimension.
    """
    shown = [name for name in ("speed_of_sound", "time_of_flight", "error") if _varies(grid[name].values)]
    shown = shown or ["indication"]
    figure = Figure(figsize=(7.0, 0.8 + 2.5 * len(shown)), layout="constrained")  # pyplot would keep it
    axes = figure.subplots(len(shown), sharex=True, squeeze=False)
    for name, ax in zip(shown, axes[:, 0], strict=True):
        plot_sweep(grid, name, ax)
        ax.label_outer()
    fixed = [_value(grid, str(name), grid[name]) for name in grid.coords if not grid[name].ndim]
    figure.suptitle("; ".join([grid.attrs["model"], *fixed]), fontsize="medium")
    figure.align_ylabels()
    for above, ax in pairwise(axes[:, 0]):  # the second legend would be the same
        if _entries(ax) and _entries(ax) == _entries(above):
            ax.get_legend().set_visible(False)
    return figure


def _entries(ax: Axes) -> list[str]:
    legend = ax.get_legend()
    return [text.get_text() for text in legend.get_texts()] if legend else []


def _varies(values: NDArray[np.float64]) -> bool:
    """Whether the values vary by more than rounding."""
    return float(np.ptp(values)) > _ROUNDING


def _label(grid: xr.Dataset, name: str) -> str:
    attributes = grid[name].attrs
    unit = _unit(grid, name)
    return f"{attributes['long_name']} [{unit}]" if unit else str(attributes["long_name"])


def _value(grid: xr.Dataset, name: str, value: Any) -> str:
    unit = _unit(grid, name)
    return f"{grid[name].attrs['long_name']} {float(value):g} {unit}".rstrip()


def _unit(grid: xr.Dataset, name: str) -> str:
    facts = QUANTITIES.get(name)
    return str(grid[name].attrs["units"]) if facts is None else printed(facts.unit)


def _color_bar(grid: xr.Dataset, name: str, ax: Axes) -> None:
    values = grid[name].values
    top = values.min() + np.ptp(values) / 0.85
    mapped = ScalarMappable(Normalize(values.min(), top), "viridis")
    bar = ax.figure.colorbar(mapped, ax=ax, label=_label(grid, name))
    bar.ax.set_ylim(values.min(), values.max())
