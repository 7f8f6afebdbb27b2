"""Plot of the errors before and after a model, against what they follow and over time."""

import textwrap

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

from echocal.diagnose import Diagnosis
from echocal.diagnose.findings.sentences import shown
from echocal.diagnose.results.explain import class_texts
from echocal.panels import (
    ERROR,
    SIGN,
    binned,
    drawn_columns,
    is_finer,
    left_out_at,
    limits,
)
from echocal.plots.labels import fitted

__all__ = ["AFTER", "BEFORE", "plot_residuals", "residuals_figure"]

BEFORE, AFTER = "#e0862a", "#155a75"  # light and dark: different without color, too
_LEFT_OUT = "#9b2335"
_PANELS = 4
_SUMMARY = 68  # characters of a line above all panels, for each panel across
_LABEL = 55  # characters of a line below a panel
_FEW = 200  # rows that are visible one by one
_ENOUGH = 5  # fewest rows of a mean that is drawn
_MARK = 0.97  # height of the marks of rows that are left out, in parts of the axis


def residuals_figure(diagnosis: Diagnosis) -> Figure:
    """Draw the errors against the columns that they follow most, before above after, and over time."""
    against = drawn_columns(diagnosis, _PANELS)
    extended = not _same(diagnosis)
    across = min(2, max(1, len(against)))
    blocks = max(1, -(-len(against) // across))
    high = 2 if extended else 1
    figure = Figure(figsize=(5.0 * across, 0.6 + (2.1 if extended else 2.6) * high * blocks))
    figure.set_layout_engine("constrained")
    axes = figure.subplots(blocks * high, across, squeeze=False)
    for place in range(blocks * across):
        own = axes[high * (place // across) : high * (place // across) + high, place % across]
        if place >= len(against):
            for ax in own:
                ax.axis("off")
        elif extended:
            plot_residuals(diagnosis, own[0], against[place], "before")
            plot_residuals(diagnosis, own[1], against[place], "after")
            own[0].sharex(own[1])
            own[0].xaxis.label.set_visible(False)
            own[0].tick_params(labelbottom=False)
        else:
            plot_residuals(diagnosis, own[0], against[place], "before")
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
    traces = diagnosis.traces
    values, label = shown(against, traces.against[against])
    residual, color = (traces.before, BEFORE) if which == "before" else (traces.after, AFTER)
    finite = np.isfinite(residual)
    x, y = values[finite], 1e3 * residual[finite]
    few = len(x) <= _FEW
    ax.plot(x, y, "o", color=color, mew=0, markersize=5 if few else 2.5, alpha=_opacity(len(x)))
    ax.plot(*_binned(x, y), "-", color="0.15", linewidth=1.6)
    ax.set_ylim(*limits(traces, which))
    ax.axhline(0.0, color="0.7", linewidth=0.8, zorder=0)
    ax.set(xlabel=fitted(label, _LABEL), ylabel=ERROR.replace(" minus ", " minus\n"))
    ax.set_title(_title(diagnosis, which), loc="left", fontsize=9, color=color)
    _mark_left_out(diagnosis, ax, against)


def _title(diagnosis: Diagnosis, which: str) -> str:
    if which == "before":
        return f"{'base, not extended' if _same(diagnosis) else 'before: base'}; {SIGN}"
    finer = is_finer(diagnosis.traces)
    return "after: extended model, " + ("at a scale of its own" if finer else "at the same scale")


def _mark_left_out(diagnosis: Diagnosis, ax: Axes, against: str) -> None:
    """Marks where rows are left out: along an axis of time or rows, which is known of these, too."""
    at = left_out_at(diagnosis, against)
    if len(at):
        places, _ = shown(against, at)
        height = np.full(len(places), _MARK)
        across = ax.get_xaxis_transform()
        ax.plot(places, height, "|", color=_LEFT_OUT, ms=7, transform=across, label=f"{len(at)} left out")
        ax.legend(loc="lower right", bbox_to_anchor=(1.0, 0.98), frameon=False, fontsize=8, borderpad=0.0)


def _same(diagnosis: Diagnosis) -> bool:
    return np.array_equal(diagnosis.traces.before, diagnosis.traces.after, equal_nan=True)


def _opacity(rows: int) -> float:
    """Lower with more points: few points stay visible, and many do not hide the mean."""
    return float(np.clip(200 / max(rows, 1), 0.12, 0.9))


def _binned(
    x: NDArray[np.float64], y: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Means of bins with about equally many rows; of many rows, bins with few rows are left out."""
    bins = binned(x)
    rows = np.bincount(bins)
    filled = rows >= (1 if len(x) <= _FEW else min(_ENOUGH, rows.max()))
    means = [np.bincount(bins, weights=values)[filled] / rows[filled] for values in (x, y)]
    return means[0], means[1]
