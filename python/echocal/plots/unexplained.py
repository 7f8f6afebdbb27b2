"""Plot of the unexplained term."""

import numpy as np
from matplotlib.axes import Axes

from echocal.diagnose import Diagnosis
from echocal.diagnose.candidates.unexplained_terms import column_of
from echocal.diagnose.findings.sentences import shown
from echocal.plots.labels import fitted
from echocal.plots.smooth import TERM

__all__ = ["plot_unexplained"]

_RESIDUAL = "#8fa0a8"
_LABEL, _TITLE = 75, 100  # characters of a line
_MANY = 200  # with more rows, points are transparent


def plot_unexplained(diagnosis: Diagnosis, ax: Axes) -> None:
    """Unexplained term against its column, with its uncertainty, over the residuals of all rows.

    Parameters
    ----------
    diagnosis : Diagnosis
    ax : matplotlib.axes.Axes
    """
    found = diagnosis.unexplained
    if found is None or found.shape is None:
        ax.axis("off")
        ax.text(0.5, 0.5, "no unexplained term", ha="center", transform=ax.transAxes)
        return
    column = column_of(found.against, diagnosis.traces.against)
    residual = 1e3 * diagnosis.traces.after
    values, label = shown(found.against, column)
    opacity = float(np.clip(_MANY / max(len(residual), 1), 0.25, 0.9))
    ax.plot(values, residual, "o", color=_RESIDUAL, mew=0, markersize=3, alpha=opacity, label="residual")
    knots = np.array(found.shape.at)
    at, _ = shown(found.against, knots)
    shift, band = 1e3 * found.shape.of(knots), 1e3 * found.shape.band(knots)
    ax.fill_between(at, shift - 2 * band, shift + 2 * band, color=TERM, alpha=0.25, lw=0, label="95 %")
    ax.plot(at, shift, color=TERM, linewidth=2, label="smooth function")
    ends = np.nanpercentile(residual, [0.5, 99.5])
    low, high = min(ends[0], (shift - 2 * band).min()), max(ends[1], (shift + 2 * band).max())
    ax.set_ylim(low - 0.1 * (high - low), high + 0.1 * (high - low))
    ax.axhline(0.0, color="0.7", linewidth=0.8, zorder=0)
    ax.set(xlabel=fitted(label, _LABEL), ylabel="residual [mm]")
    title = (
        f"no cause of the catalogue explains this residual: {1e3 * found.rms_m:.1f} mm (RMS) against {label}"
    )
    ax.set_title(fitted(title, _TITLE), fontsize=8, loc="left")
    ax.legend(loc="best", frameon=False, fontsize=8)
