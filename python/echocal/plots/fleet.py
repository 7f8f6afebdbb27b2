"""Plots of a fleet: causes by the number of sensors and by millimeters."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from echocal.errors import writing
from echocal.plots.files import in_form, save_figure

__all__ = ["PICTURES", "plot_counts", "plot_errors", "save_fleet"]

PICTURES = ("fleet.png",)
"""Names of the files that `save_fleet` writes."""

_MOST = 15  # causes that are drawn
_CLAIMED, _NAMED, _BEFORE, _AFTER = "#c9d8de", "#155a75", "#e0862a", "#155a75"


def save_fleet(summary: Mapping[str, Any], folder: str | Path, form: str = "png") -> list[Path]:
    """Write ``fleet.png``: in how many sensors each cause is, and what it costs there.

    Parameters
    ----------
    summary : mapping
        Schema ``echocal.fleet/1``.
    folder : path
        Created if it does not exist.
    form : {"png", "svg", "pdf"}
        Format of the file, which is its ending, too.

    Returns
    -------
    list of Path

    Raises
    ------
    UsageError
        If the folder cannot be written.
    """
    folder = Path(folder)
    causes = summary["causes"][:_MOST]
    height = 1.6 + 0.3 * max(len(causes), 1)
    with mpl.rc_context({"font.size": 9, "axes.spines.top": False, "axes.spines.right": False}):
        figure = Figure(figsize=(9.0, height), layout="constrained")
        left, right = figure.subplots(1, 2, sharey=True)
        if causes:
            plot_counts(causes, left)
            plot_errors(causes, right)
        else:
            left.text(0.5, 0.5, "no cause is claimed in any sensor", ha="center", transform=left.transAxes)
            left.axis("off")
            right.axis("off")
        verdicts = ", ".join(f"{count} {verdict}" for verdict, count in summary["verdicts"].items())
        figure.suptitle(f"{summary['sensors']} sensors: {verdicts}", fontsize=9)
        with writing(folder):
            folder.mkdir(parents=True, exist_ok=True)
        (path,) = (folder / name for name in in_form(PICTURES, form))
        save_figure(figure, path, "diagnose")
    return [path]


def plot_counts(causes: list[Mapping[str, Any]], ax: Axes) -> None:
    """Sensors in which each cause is claimed, and those in which it is named given the fleet.

    Parameters
    ----------
    causes : list of mapping
        Of a summary.
    ax : matplotlib.axes.Axes
    """
    places = np.arange(len(causes))
    ax.barh(places, [one["sensors"] for one in causes], color=_CLAIMED, label="claimed")
    ax.barh(
        places, [one["named_in_fleet"] for one in causes], 0.45, color=_NAMED, label="named, given the fleet"
    )
    ax.set_yticks(places, [one["id"] for one in causes])
    ax.invert_yaxis()
    ax.set_xlabel("sensors")
    ax.xaxis.set_major_locator(MaxNLocator(integer=True))
    ax.legend(loc="lower center", bbox_to_anchor=(0.5, 1.0), ncols=2, frameon=False, fontsize=8)


def plot_errors(causes: list[Mapping[str, Any]], ax: Axes) -> None:
    """RMS error with the base and with the model, of the sensors in which a cause comes first.

    Parameters
    ----------
    causes : list of mapping
        Of a summary.
    ax : matplotlib.axes.Axes
    """
    first = True
    for place, one in enumerate(causes):
        before, after = one["rms_before_mm"], one["rms_after_mm"]
        if before is None:
            continue
        ax.plot([after, before], [place, place], color="0.7", linewidth=1.5, zorder=1)
        ax.plot(before, place, "o", color=_BEFORE, label="base" if first else "_nolegend_")
        ax.plot(after, place, "o", color=_AFTER, label="model" if first else "_nolegend_")
        first = False
    ax.set_xlim(left=0.0)
    ax.set_xlabel("RMS error [mm], median where the cause comes first")
    if ax.get_legend_handles_labels()[0]:
        ax.legend(loc="lower center", bbox_to_anchor=(0.5, 1.0), ncols=2, frameon=False, fontsize=8)
