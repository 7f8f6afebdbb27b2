"""Plots of a diagnosis."""

from pathlib import Path

import matplotlib as mpl
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from echocal.charts.diagnosis import gain_chart, posterior_chart
from echocal.diagnose import Diagnosis
from echocal.diagnose.results.explain import class_texts, lead
from echocal.errors import writing
from echocal.plots.draw import draw_bars
from echocal.plots.files import in_form, save_figure
from echocal.plots.next_measurements import next_figure
from echocal.plots.residuals import plot_residuals, residuals_figure
from echocal.plots.smooth import smooth_figure
from echocal.plots.unexplained import plot_unexplained

__all__ = ["PICTURES", "plot_gain", "plot_posterior", "plot_residuals", "residuals_figure", "save_diagnosis"]

PICTURES = ("residuals.png", "gain.png", "posterior.png", "next.png", "unexplained.png", "smooth.png")
"""Names of the files that `save_diagnosis` can write; the last two if there is such a function."""

_MOST = 6  # sets of causes that are drawn


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
    chart = gain_chart(diagnosis)
    if chart is None:
        ax.text(0.5, 0.5, "the gain was not measured", ha="center", transform=ax.transAxes)
        return
    draw_bars(chart, ax)


def plot_posterior(diagnosis: Diagnosis, ax: Axes) -> None:
    """Probability of the sets of causes; sets that the data cannot separate share a bar.

    Parameters
    ----------
    diagnosis : Diagnosis
    ax : matplotlib.axes.Axes
    """
    said = lead(diagnosis)
    finding = f"{diagnosis.verdict}: {said[0].lower()}{said[1:]}"
    draw_bars(posterior_chart(diagnosis, _MOST), ax, [finding, *class_texts(diagnosis)])
