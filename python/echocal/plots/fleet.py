"""Plots of a fleet: causes by the number of sensors and by millimeters."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import matplotlib as mpl
from matplotlib.figure import Figure

from echocal.charts.several import counts_chart, errors_chart
from echocal.errors import writing
from echocal.plots.draw import draw_bars
from echocal.plots.files import in_form, save_figure

__all__ = ["PICTURES", "save_fleet"]

PICTURES = ("fleet.png",)
"""Names of the files that `save_fleet` writes."""


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
    charts = [chart for chart in (counts_chart(summary), errors_chart(summary)) if chart is not None]
    height = 1.6 + 0.3 * max([1, *(len(chart.bars) for chart in charts)])
    with mpl.rc_context({"font.size": 9, "axes.spines.top": False, "axes.spines.right": False}):
        figure = Figure(figsize=(9.0, height), layout="constrained")
        axes = figure.subplots(1, max(len(charts), 1), squeeze=False).ravel()
        for ax, chart in zip(axes, charts, strict=False):
            draw_bars(chart, ax)
        if not charts:
            axes[0].text(
                0.5, 0.5, "no cause is claimed in any sensor", ha="center", transform=axes[0].transAxes
            )
            axes[0].axis("off")
        verdicts = ", ".join(f"{count} {verdict}" for verdict, count in summary["verdicts"].items())
        figure.suptitle(f"{summary['sensors']} sensors: {verdicts}", fontsize=9)
        with writing(folder):
            folder.mkdir(parents=True, exist_ok=True)
        (path,) = (folder / name for name in in_form(PICTURES, form))
        save_figure(figure, path, "diagnose")
    return [path]
