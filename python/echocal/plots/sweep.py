"""Plots of sweeps."""

from typing import Any

import matplotlib.pyplot as plt
import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.colors import Normalize
from matplotlib.figure import Figure
from numpy.typing import NDArray

__all__ = ["plot_sweep", "sweep_figure"]

# what a person reads: unit on paper, and its size in the unit of the grid
_SHOWN = {
    "error": ("mm", 1e-3),
    "time_of_flight": ("ms", 1e-3),
    "speed_of_sound": ("m/s", 1.0),
    "indication": ("m", 1.0),
}
_NAMES = {name: name.replace("_", " ") for name in _SHOWN} | {"time_of_flight": "echo time"}
_UNITS = {"degC": "°C", "m s-1": "m/s", "W m-2": "W/m²", "1": ""}
_LEGEND = 6  # more lines than this are read from a color bar


def plot_sweep(grid: xr.Dataset, variable: str = "error", ax: Axes | None = None) -> Axes:
    """Draw one variable of a sweep: its longest dimension along x, one line for each of the rest.

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
    along, *others = sorted(grid.sizes, key=lambda name: -grid.sizes[name])
    unit, size = _SHOWN[variable]
    values = grid[variable] / size
    lines = values.stack(line=others) if others else values.expand_dims("line")
    count = lines.sizes["line"]
    shades = plt.get_cmap("viridis")(np.linspace(0.0, 0.85, count) if count > 1 else [0.3])
    for number in range(count):
        line = lines.isel(line=number)
        marker = "o" if grid.sizes[along] <= 60 and count <= _LEGEND else ""
        ax.plot(
            grid[along],
            line,
            color=shades[number],
            lw=1.6,
            label=_title(grid, others, line),
            marker=marker,
            markersize=3,
        )
    ax.set_xlabel(_label(grid, str(along)))
    ax.set_ylabel(f"{_NAMES[variable]} [{unit}]")
    ax.grid(alpha=0.25)
    ax.spines[["top", "right"]].set_visible(False)
    ax.margins(x=0.02)
    if variable == "error":
        ax.axhline(0.0, color="0.4", lw=0.8, zorder=0)
    if 1 < count <= _LEGEND:
        ax.legend(frameon=False, fontsize="small")
    elif len(others) == 1:
        _color_bar(grid, str(others[0]), ax)
    return ax


def sweep_figure(grid: xr.Dataset) -> Figure:
    """Draw what changes over a sweep, one panel for each variable.

    Parameters
    ----------
    grid : xarray.Dataset
        Result of `echocal.sweep`, with at least one dimension.
    """
    shown = [name for name in ("speed_of_sound", "time_of_flight", "error") if _varies(grid[name].values)]
    shown = shown or ["indication"]
    figure, axes = plt.subplots(
        len(shown), figsize=(7.0, 0.8 + 2.5 * len(shown)), sharex=True, layout="constrained", squeeze=False
    )
    for name, ax in zip(shown, axes[:, 0], strict=True):
        plot_sweep(grid, name, ax)
        ax.label_outer()
    fixed = [_value(grid, str(name), grid[name]) for name in grid.coords if not grid[name].ndim]
    figure.suptitle("; ".join([grid.attrs["model"], *fixed]), fontsize="medium")
    figure.align_ylabels()
    for ax in axes[1:, 0]:  # one legend is enough
        if legend := ax.get_legend():
            legend.remove()
    return figure


def _varies(values: NDArray[np.float64]) -> bool:
    """Whether there is more to see than rounding: a nanosecond, a nanometer."""
    return float(np.ptp(values)) > 1e-9


def _label(grid: xr.Dataset, name: str) -> str:
    attributes = grid[name].attrs
    unit = _UNITS.get(attributes["units"], attributes["units"])
    return f"{attributes['long_name']} [{unit}]" if unit else str(attributes["long_name"])


def _value(grid: xr.Dataset, name: str, value: Any) -> str:
    unit = _UNITS.get(grid[name].attrs["units"], grid[name].attrs["units"])
    return f"{grid[name].attrs['long_name']} {float(value):g} {unit}".rstrip()


def _title(grid: xr.Dataset, others: list[Any], line: xr.DataArray) -> str:
    return ", ".join(_value(grid, str(name), line[name]) for name in others)


def _color_bar(grid: xr.Dataset, name: str, ax: Axes) -> None:
    values = grid[name].values
    # the lines stop at 0.85 of the map, where yellow is still legible on white
    top = values.min() + np.ptp(values) / 0.85
    mapped = ScalarMappable(Normalize(values.min(), top), "viridis")
    bar = ax.figure.colorbar(mapped, ax=ax, label=_label(grid, name))
    bar.ax.set_ylim(values.min(), values.max())
