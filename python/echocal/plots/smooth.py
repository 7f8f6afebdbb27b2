"""Plot of the smooth correction."""

import textwrap

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from echocal.diagnose import Diagnosis
from echocal.diagnose.findings.sentences import shown
from echocal.model import Shape
from echocal.plots.labels import fitted

__all__ = ["TERM", "plot_term", "smooth_figure"]

TERM = "#7a3b8f"
"""Color of what has no known cause."""

_LABEL, _TITLE = 45, 120  # characters of a line
_ACROSS = 3  # panels beside each other


def smooth_figure(diagnosis: Diagnosis) -> Figure:
    """The functions that a smooth correction is the sum of, a panel each, and its gain.

    Parameters
    ----------
    diagnosis : Diagnosis
        With a smooth correction that is offered.
    """
    found = diagnosis.smooth
    terms = () if found is None or found.smooth is None else found.smooth.terms
    rows = max(1, -(-len(terms) // _ACROSS))
    figure = Figure(figsize=(9.0, 0.6 + 2.5 * rows), layout="constrained")
    axes = figure.subplots(rows, min(_ACROSS, max(1, len(terms))), squeeze=False, sharey=True).ravel()
    for ax, term in zip(axes, terms, strict=False):
        plot_term(term, ax)
    for ax in axes[len(terms) :]:
        ax.axis("off")
    if found is not None and found.rms_before_m is not None and found.rms_after_m is not None:
        said = (
            "smooth correction without a known cause: the sum of these functions, inside of their ranges. "
            f"RMS error on {found.held_out_rows} rows that neither its choice nor its fit has seen: "
            f"{1e3 * found.rms_before_m:.2f} mm without it, {1e3 * found.rms_after_m:.2f} mm with it"
        )
        figure.suptitle(textwrap.fill(said, _TITLE), fontsize=9)
    return figure


def plot_term(term: Shape, ax: Axes) -> None:
    """One function of one column, with its uncertainty."""
    at = np.array(term.at)
    if term.against == "hour_angle":
        values, label = 12.0 + 12.0 * at / np.pi, "hour of day [h]"
    else:
        values, label = shown(term.against, at)
    shift, band = 1e3 * np.array(term.shift), 2e3 * np.array(term.standard_uncertainty)
    ax.fill_between(values, shift - band, shift + band, color=TERM, alpha=0.25, linewidth=0)
    ax.plot(values, shift, color=TERM, linewidth=2)
    ax.axhline(0.0, color="0.7", linewidth=0.8, zorder=0)
    ax.set(xlabel=fitted(label, _LABEL), ylabel="shift of the reading [mm]")
