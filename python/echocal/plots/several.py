"""Plots of a fleet: causes by the number of sensors and by millimeters."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from echocal.charts.results import counts_chart, fleet_errors_chart
from echocal.diagnose.findings.sentences import readable
from echocal.diagnose.pooling.explain import lead
from echocal.diagnose.pooling.parts import PooledCause
from echocal.diagnose.pooling.result import PooledDiagnosis
from echocal.plots.draw import STYLE, draw_bars, save_figures

POOLED_PICTURES = ("sizes.png",)
"""Names of the files that `save_pooled` writes."""

_ALONE, _DRAWN, _MEAN = "#e0862a", "#155a75", "#8a8a8a"
_INTERVAL = 1.96  # standard uncertainties
_NAMED = 60  # tables whose names are written
_WIDEST = 4.0  # times the spread of the other intervals, beyond which one is cut off

PICTURES = ("fleet.png",)
"""Names of the files that `save_fleet` writes."""


def save_fleet(summary: Mapping[str, Any], folder: str | Path, form: str = "png") -> list[Path]:
    """Write ``fleet.png``: in how many sensors each cause is, and what it costs there.

    The summary is of schema ``echocal.fleet/1``; folder and format are as in `save_figures`.
    """
    charts = [chart for chart in (counts_chart(summary), fleet_errors_chart(summary)) if chart is not None]
    height = 1.6 + 0.3 * max([1, *(len(chart.bars) for chart in charts)])
    with mpl.rc_context(STYLE):
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
    return save_figures(dict.fromkeys(PICTURES, figure), folder, form)


def save_pooled(pooled: PooledDiagnosis, folder: str | Path, form: str = "png") -> list[Path]:
    """Write ``sizes.png``: the sizes of the shared causes in each table.

    Folder and format are as in `save_figures`.
    """
    panels = [
        (cause, p.name) for cause in pooled.causes for p in cause.parameters if p.standard_uncertainty > 0.0
    ]
    height = 1.6 + 0.22 * min(len(pooled.tables), _NAMED)
    with mpl.rc_context(STYLE):
        figure = Figure(figsize=(6.5, height * max(len(panels), 1)), layout="constrained")
        axes = figure.subplots(max(len(panels), 1), 1, squeeze=False).ravel()
        for ax, (cause, name) in zip(axes, panels, strict=False):
            plot_sizes(cause, name, ax)
        if not panels:
            axes[0].text(0.5, 0.5, "no sizes that the tables share", ha="center", transform=axes[0].transAxes)
            axes[0].axis("off")
        figure.suptitle(f"{pooled.verdict}: {lead(pooled)}", fontsize=9)
    return save_figures(dict.fromkeys(POOLED_PICTURES, figure), folder, form)


def plot_sizes(cause: PooledCause, name: str, ax: Axes) -> None:
    """Size of a shared cause in each table, alone and drawn to the mean, with the mean of all."""
    shared = next(p for p in cause.parameters if p.name == name)
    factor, unit = readable(shared.value, shared.unit)
    middle = factor * shared.value
    band = factor * float(np.hypot(shared.between_tables, shared.standard_uncertainty))
    ax.axvspan(middle - band, middle + band, color=_MEAN, alpha=0.25, lw=0)
    ax.axvline(middle, color=_MEAN, linewidth=1.2)
    drawn = []
    for place, one in enumerate(cause.tables):
        for parameters, color, shift, label in (
            (one.parameters, _ALONE, -0.14, "from the table alone"),
            (one.drawn, _DRAWN, 0.14, "in the pool"),
        ):
            for p in (p for p in parameters if p.name == name):
                value, half = factor * p.value, factor * _INTERVAL * p.standard_uncertainty
                drawn.append((value - half, value + half))
                seen = ax.get_legend_handles_labels()[1]
                shown = label if label not in seen else "_nolegend_"
                ax.errorbar(value, place + shift, xerr=half, fmt="o", ms=3.5, color=color, label=shown)
        if not one.parameters:
            ax.text(middle, place, one.role, va="center", ha="center", fontsize=7, color="0.4")
    _limit(ax, drawn, middle, band)
    names = [one.table for one in cause.tables]
    ax.set_yticks(range(len(names)) if len(names) <= _NAMED else [], names if len(names) <= _NAMED else [])
    ax.set_ylim(len(names) - 0.5, -0.5)
    ax.set_xlabel(f"{cause.id}: {name.replace('_', ' ')}{f' [{unit}]' * bool(unit)}")
    ax.set_title(
        f"95 % intervals; line and band: mean of all tables, {middle:.4g} {unit}, and standard "
        "deviation of a table",
        fontsize=8,
        loc="left",
    )
    if drawn:
        ax.legend(loc="best", frameon=False, fontsize=8)


def _limit(ax: Axes, drawn: list[tuple[float, float]], middle: float, band: float) -> None:
    """Cut off intervals of tables that hardly show the cause, so that the others stay visible."""
    if not drawn:
        return
    ends = np.abs(np.array(drawn) - middle).max(axis=1)
    most = min(float(ends.max()), max(_WIDEST * float(np.median(ends)), 2 * band))
    ax.set_xlim(middle - 1.08 * most, middle + 1.08 * most)
