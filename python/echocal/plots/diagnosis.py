"""Plots of a diagnosis."""

import textwrap
from pathlib import Path

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

from echocal.diagnose import Diagnosis
from echocal.diagnose.findings.sentences import shown
from echocal.diagnose.results.explain import class_texts
from echocal.diagnose.results.followed import binned, by_correlation
from echocal.errors import writing
from echocal.plots.files import save_figure
from echocal.plots.labels import fitted, title_beside
from echocal.plots.next_measurements import next_figure
from echocal.plots.posterior import plot_posterior
from echocal.plots.smooth import TERM, smooth_figure
from echocal.plots.unexplained import plot_unexplained

__all__ = ["PICTURES", "plot_gain", "plot_posterior", "plot_residuals", "residuals_figure", "save_diagnosis"]

PICTURES = ("residuals.png", "gain.png", "posterior.png", "next.png", "unexplained.png", "smooth.png")
"""Names of the files that `save_diagnosis` can write; the last two if there is such a function."""

_BEFORE, _AFTER, _FLOOR = (
    "#e0862a",
    "#155a75",
    "#8a8a8a",
)  # light and dark: different without color, too
_PANELS = 4
_SUMMARY = 140  # characters of a line above all panels
_LABEL = 55  # characters of a line below a panel
_FEW = 200  # rows that are visible one by one
_ENOUGH = 5  # fewest rows of a mean that is drawn


def save_diagnosis(diagnosis: Diagnosis, folder: str | Path) -> list[Path]:
    """Write ``residuals.png``, ``gain.png``, ``posterior.png`` and ``next.png``.

    If there is an unexplained term, ``unexplained.png`` shows it. If a smooth correction is offered,
    ``smooth.png`` shows its parts.

    Parameters
    ----------
    diagnosis : Diagnosis
    folder : path
        Created if it does not exist.

    Returns
    -------
    list of Path

    Raises
    ------
    UsageError
        If the folder cannot be written.
    """
    folder = Path(folder)
    with mpl.rc_context({"font.size": 9, "axes.spines.top": False, "axes.spines.right": False}):
        figures = [
            residuals_figure(diagnosis),
            _single(diagnosis, plot_gain, (6.0, 2.8)),
            _single(diagnosis, plot_posterior, (8.0, 3.2)),
            next_figure(diagnosis),
            None if diagnosis.unexplained is None else _single(diagnosis, plot_unexplained, (6.5, 3.6)),
            smooth_figure(diagnosis) if diagnosis.smooth is not None and diagnosis.smooth.offered else None,
        ]
        named = zip(PICTURES, figures, strict=True)
        paths = {folder / name: figure for name, figure in named if figure is not None}
        with writing(folder):
            folder.mkdir(parents=True, exist_ok=True)
        for path, figure in paths.items():
            save_figure(figure, path, "diagnose")
    return list(paths)


def _single(diagnosis: Diagnosis, plot: object, size: tuple[float, float]) -> Figure:
    figure = Figure(figsize=size, layout="constrained")
    plot(diagnosis, figure.add_subplot())  # type: ignore[operator]
    return figure


def residuals_figure(diagnosis: Diagnosis) -> Figure:
    """Draw the residuals against the most telling columns, before and after."""
    against = by_correlation(diagnosis)[:_PANELS]
    rows = max(1, -(-len(against) // 2))
    figure = Figure(figsize=(10.0, 0.4 + 2.7 * rows), layout="constrained")
    axes = figure.subplots(rows, min(2, max(1, len(against))), squeeze=False).ravel()
    for ax, name in zip(axes, against, strict=False):
        plot_residuals(diagnosis, ax, name)
    for ax in axes[len(against) :]:
        ax.axis("off")
    if against:
        axes[0].legend(loc="best", frameon=False)
    figure.suptitle(_summary(diagnosis), fontsize=10)
    return figure


def _summary(diagnosis: Diagnosis) -> str:
    gain = diagnosis.gain
    if gain is None:
        return "residuals, against the columns that they follow most"
    text = f"RMS error on {gain.judged_rows}: {1e3 * gain.rms_before_m:.2f} mm with the base"
    if len(gain.ladder) > 1:
        text += f", {1e3 * gain.rms_after_m:.2f} mm with the extended model"
    lines = [f"{text}; the column with the clearest trend first", *class_texts(diagnosis)]
    return "\n".join(textwrap.fill(line, _SUMMARY) for line in lines)


def plot_residuals(diagnosis: Diagnosis, ax: Axes, against: str) -> None:
    """Residuals against one column, of the base and of the model, with the means of thirty bins.

    Parameters
    ----------
    diagnosis : Diagnosis
    ax : matplotlib.axes.Axes
    against : str
        A name in ``diagnosis.traces.against``.
    """
    traces = diagnosis.traces
    same = np.array_equal(traces.before, traces.after, equal_nan=True)
    values, label = shown(against, traces.against[against])
    for residual, color, width, name in (
        (
            traces.before,
            _BEFORE,
            *((1.6, "base, not extended") if same else (3.2, "base")),
        ),  # wide, so that it is visible below the other
        (traces.after, _AFTER, 1.6, "extended model"),
    )[: 1 if same else 2]:
        finite = np.isfinite(residual)
        x, y = values[finite], 1e3 * residual[finite]
        few = len(x) <= _FEW
        ax.plot(x, y, "o", color=color, mew=0, markersize=5 if few else 2.5, alpha=_opacity(len(x)))
        ax.plot(*_binned(x, y), "-", color=color, linewidth=width, label=name)
    middle = 1e3 * np.nanpercentile(np.concatenate([traces.before, traces.after]), [0.5, 99.5])
    room = 0.25 * np.ptp(middle) + 1e-3
    ax.set_ylim(middle[0] - room, middle[1] + room)
    ax.axhline(0.0, color="0.7", linewidth=0.8, zorder=0)
    ax.set(xlabel=fitted(label, _LABEL), ylabel="residual [mm]")


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


def plot_gain(diagnosis: Diagnosis, ax: Axes) -> None:
    """Error on cross-validated or held-out rows, as the causes are added.

    Parameters
    ----------
    diagnosis : Diagnosis
    ax : matplotlib.axes.Axes
    """
    gain = diagnosis.gain
    if gain is None:
        ax.text(0.5, 0.5, "the gain was not measured", ha="center", transform=ax.transAxes)
        return
    rungs = [(f"+ {ids[-1]}" if ids else "base", rms, _AFTER if ids else _BEFORE) for ids, rms in gain.ladder]
    if gain.rms_fixed_speed_m is not None:
        rungs.insert(0, ("one fixed speed", gain.rms_fixed_speed_m, _FLOOR))
    if len(gain.ladder) > 1 and gain.judged_rows != "held-out rows":
        rungs.append(("chosen by each fold", gain.rms_after_m, _AFTER))
    smooth = diagnosis.smooth
    if smooth is not None and smooth.offered and smooth.rms_after_m is not None:
        rungs.append(("+ smooth correction", smooth.rms_after_m, TERM))
    names, values, colors = zip(*rungs, strict=True)
    bars = ax.barh(range(len(names)), 1e3 * np.array(values), color=colors, height=0.6)
    ax.bar_label(bars, fmt="%.2f mm", padding=3)
    ax.axvline(1e3 * gain.rms_floor_m, color="0.3", linestyle=":")
    ax.set_yticks(range(len(names)), names)
    ax.invert_yaxis()
    ax.margins(x=0.18)
    ax.set_xlabel(f"RMS error on {gain.judged_rows} [mm]")
    after = (
        f" to {1e3 * gain.rms_after_m:.2f} mm" if len(gain.ladder) > 1 else " mm; no effect extends the base"
    )
    rows = f"{gain.held_out_rows} {gain.judged_rows} ({gain.scheme})"
    error = f"RMS error on {rows}: {1e3 * gain.rms_before_m:.2f}{after}"
    width = title_beside(names, ax)
    lines = [error, *_removed(diagnosis), "dotted line: error that all recorded columns together could reach"]
    ax.set_title("\n".join(textwrap.fill(line, width) for line in lines), fontsize=8, loc="left")


def _removed(diagnosis: Diagnosis) -> list[str]:
    """Part of the error that the model removes; and the error with a smooth correction, if it is offered."""
    gain, smooth = diagnosis.gain, diagnosis.smooth
    lines = []
    if gain is not None and len(gain.ladder) > 1:
        low, high = (100 * end for end in gain.variance_removed_interval_95)
        lines.append(
            f"the model removes {100 * gain.variance_removed:.0f} % of the mean square error "
            f"({low:.0f} to {high:.0f} %, 95 % interval)"
        )
    if smooth is not None and smooth.offered and smooth.rms_after_m is not None:
        lines.append(
            f"with the smooth correction, which has no known cause: {1e3 * smooth.rms_after_m:.2f} mm"
        )
    return lines
