"""Plots of a diagnosis."""

import textwrap
from pathlib import Path

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from echocal.diagnose import Diagnosis
from echocal.errors import writing
from echocal.plots.files import in_form, save_figure
from echocal.plots.labels import title_beside
from echocal.plots.next_measurements import next_figure
from echocal.plots.posterior import plot_posterior
from echocal.plots.residuals import AFTER, BEFORE, plot_residuals, residuals_figure
from echocal.plots.smooth import TERM, smooth_figure
from echocal.plots.unexplained import plot_unexplained

__all__ = ["PICTURES", "plot_gain", "plot_posterior", "plot_residuals", "residuals_figure", "save_diagnosis"]

PICTURES = ("residuals.png", "gain.png", "posterior.png", "next.png", "unexplained.png", "smooth.png")
"""Names of the files that `save_diagnosis` can write; the last two if there is such a function."""

_FLOOR = "#8a8a8a"


def save_diagnosis(diagnosis: Diagnosis, folder: str | Path, form: str = "png") -> list[Path]:
    """Write ``residuals.png``, ``gain.png``, ``posterior.png`` and ``next.png``.

    If there is an unexplained term, ``unexplained.png`` shows it. If a smooth correction is offered,
    ``smooth.png`` shows its parts.

    Parameters
    ----------
    diagnosis : Diagnosis
    folder : path
        Created if it does not exist.
    form : {"png", "svg", "pdf"}
        Format of the files, which is their ending, too.

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
        named = zip(in_form(PICTURES, form), figures, strict=True)
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
    rungs = [(f"+ {ids[-1]}" if ids else "base", rms, AFTER if ids else BEFORE) for ids, rms in gain.ladder]
    if gain.rms_fixed_speed_m is not None:
        rungs.insert(0, ("one fixed speed", gain.rms_fixed_speed_m, _FLOOR))
    if len(gain.ladder) > 1 and gain.judged_rows != "held-out rows":
        rungs.append(("chosen by each fold", gain.rms_after_m, AFTER))
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
