"""Plot of the errors before and after a model, against what they follow and over time."""

import textwrap

from matplotlib.axes import Axes
from matplotlib.figure import Figure

from echocal.charts.columns import drawn_columns
from echocal.charts.errors import column_chart
from echocal.diagnose import Diagnosis
from echocal.diagnose.results.explain import class_texts
from echocal.plots.draw import draw_panel

__all__ = ["plot_residuals", "residuals_figure"]

_PANELS = 4
_SUMMARY = 68  # characters of a line above all panels, for each panel across


def residuals_figure(diagnosis: Diagnosis) -> Figure:
    """Draw the errors against the columns that they follow most, before above after, and over time."""
    charts = [column_chart(diagnosis, name) for name in drawn_columns(diagnosis, _PANELS)]
    high = max(len(chart.panels) for chart in charts)
    across = min(2, len(charts))
    blocks = -(-len(charts) // across)
    figure = Figure(figsize=(5.0 * across, 0.6 + (2.1 if high > 1 else 2.6) * high * blocks))
    figure.set_layout_engine("constrained")
    axes = figure.subplots(blocks * high, across, squeeze=False)
    for ax in axes.ravel():
        ax.axis("off")
    for place, chart in enumerate(charts):
        own = axes[high * (place // across) : high * (place // across + 1), place % across]
        for panel, ax in zip(chart.panels, own, strict=True):
            ax.axis("on")
            draw_panel(panel, chart.x, ax)
        for ax in own[:-1]:
            ax.sharex(own[-1])
            ax.xaxis.label.set_visible(False)
            ax.tick_params(labelbottom=False)
    figure.suptitle(_summary(diagnosis, _SUMMARY * across), fontsize=10)
    return figure


def _summary(diagnosis: Diagnosis, width: int = 2 * _SUMMARY) -> str:
    gain = diagnosis.gain
    if gain is None:
        return "errors of the readings, against the columns that they follow most"
    text = f"RMS error on {gain.judged_rows}: {1e3 * gain.rms_before_m:.2f} mm with the base"
    if len(gain.ladder) > 1:
        text += f", {1e3 * gain.rms_after_m:.2f} mm with the extended model"
    lines = [f"{text}; the column with the clearest trend first", *class_texts(diagnosis)]
    return "\n".join(textwrap.fill(line, width) for line in lines)


def plot_residuals(diagnosis: Diagnosis, ax: Axes, against: str, which: str = "before") -> None:
    """Errors of the base or of the extended model against one column, with the means of thirty bins.

    Both have the same scale, so that a worse model looks worse. Where the model leaves less than a fifth of
    the error, its scale is its own, and the title says so.

    Parameters
    ----------
    diagnosis : Diagnosis
    ax : matplotlib.axes.Axes
    against : str
        A name in ``diagnosis.traces.against``.
    which : {"before", "after"}
        Before is the base, after the extended model.
    """
    chart = column_chart(diagnosis, against)
    draw_panel(chart.panels[0 if which == "before" else -1], chart.x, ax)
