"""Plots of a diagnosis."""

import textwrap
from pathlib import Path

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from echocal.charts.errors import column_chart, drawn_columns
from echocal.charts.results import gain_chart, posterior_chart
from echocal.diagnose import Diagnosis, NextMeasurement
from echocal.diagnose.candidates.unexplained_terms import column_of
from echocal.diagnose.findings.sentences import shown
from echocal.diagnose.results.explain import class_texts, lead, proposal_text
from echocal.model import Shape
from echocal.plots.draw import STYLE, draw_bars, draw_panel, fitted, save_figures

_FAINT = "#8fa0a8"
_TERM_LABEL, _TERM_TITLE = 75, 100  # characters of a line
_MANY = 200  # with more rows, points are transparent

_PANELS = 4
_SUMMARY = 68  # characters of a line above all panels, for each panel across

_WIDTH = 100  # characters of a line of words
_TICK = 0.02  # part of an axis
_SEEN, _PROPOSED = "#a9b6bd", "#b5530f"

TERM = "#7a3b8f"
"""Color of what has no known cause."""

_LABEL, _TITLE = 45, 120  # characters of a line
_ACROSS = 3  # panels beside each other

PICTURES = ("residuals.png", "gain.png", "posterior.png", "next.png", "unexplained.png", "smooth.png")
"""Names of the files that `save_diagnosis` can write; the last two if there is such a function."""

_MOST = 6  # sets of causes that are drawn


def save_diagnosis(diagnosis: Diagnosis, folder: str | Path, form: str = "png") -> list[Path]:
    """Write ``residuals.png``, ``gain.png``, ``posterior.png`` and ``next.png``.

    If there is an unexplained term, ``unexplained.png`` shows it. If a smooth correction is offered,
    ``smooth.png`` shows its parts.

    Folder and format are as in `save_figures`.
    """
    with mpl.rc_context(STYLE):
        figures = [
            residuals_figure(diagnosis),
            _single(diagnosis, plot_gain, (6.0, 2.8)),
            _single(diagnosis, plot_posterior, (8.0, 3.2)),
            next_figure(diagnosis),
            None if diagnosis.unexplained is None else _single(diagnosis, plot_unexplained, (6.5, 3.6)),
            smooth_figure(diagnosis) if diagnosis.smooth is not None and diagnosis.smooth.offered else None,
        ]
    return save_figures(dict(zip(PICTURES, figures, strict=True)), folder, form)


def _single(diagnosis: Diagnosis, plot: object, size: tuple[float, float]) -> Figure:
    figure = Figure(figsize=size, layout="constrained")
    plot(diagnosis, figure.add_subplot())  # type: ignore[operator]
    return figure


def plot_gain(diagnosis: Diagnosis, ax: Axes) -> None:
    """Error on cross-validated or held-out rows, as the causes are added."""
    chart = gain_chart(diagnosis)
    if chart is None:
        ax.text(0.5, 0.5, "the gain was not measured", ha="center", transform=ax.transAxes)
        return
    draw_bars(chart, ax)


def plot_posterior(diagnosis: Diagnosis, ax: Axes) -> None:
    """Probability of the sets of causes; sets that the data cannot separate share a bar."""
    said = lead(diagnosis)
    finding = f"{diagnosis.verdict}: {said[0].lower()}{said[1:]}"
    draw_bars(posterior_chart(diagnosis, _MOST), ax, [finding, *class_texts(diagnosis)])


def smooth_figure(diagnosis: Diagnosis) -> Figure:
    """The functions that a smooth correction is the sum of, a panel each, and its gain."""
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


def next_figure(diagnosis: Diagnosis) -> Figure:
    """Proposed rows among the measured rows, and side measurements in words."""
    sides = [p for p in diagnosis.next_measurements if p.expected_probability is None]
    rows = len(sides) < len(diagnosis.next_measurements)
    lines = [textwrap.fill(proposal_text(p), _WIDTH, subsequent_indent="   ") for p in sides]
    if not rows and not sides:
        lines = ["no further causes are to be separated"]
    text = "\n".join(lines)
    heights = [3.8] * rows + [0.25 + 0.16 * (1 + text.count("\n"))] * bool(lines)
    figure = Figure(figsize=(6.5, sum(heights)), layout="constrained")
    axes = figure.subplots(len(heights), height_ratios=heights, squeeze=False).ravel()
    if rows:
        plot_next(diagnosis, axes[0])
    if lines:
        axes[-1].axis("off")
        axes[-1].text(0.0, 1.0, text, va="top", fontsize=8, transform=axes[-1].transAxes)
    return figure


def plot_next(diagnosis: Diagnosis, ax: Axes) -> None:
    """Proposed rows among the measured rows, over the two conditions that the proposal varies."""
    plans = [p for p in diagnosis.next_measurements if p.expected_probability is not None]
    if not plans:
        ax.axis("off")
        ax.text(
            0.0,
            1.0,
            "no rows in these ranges would separate the causes",
            va="top",
            transform=ax.transAxes,
        )
        return
    (plan, *_) = plans
    names = [name for name in plan.conditions if name != "rows"][:2]
    for name, axis in zip(names, ("x", "y"), strict=False):
        ax.set(**{f"{axis}label": shown(name, np.zeros(1))[1]})
    _measured(diagnosis, names, ax)
    _places(plan, names, ax)
    for side in (ax.xaxis, ax.yaxis):  # a single place has a range of zero
        low, high = side.get_data_interval()
        room = max(0.15 * (high - low), 0.1 * abs(high))
        side.set_view_interval(low - room, high + room, ignore=True)
    ax.legend(loc="upper left", bbox_to_anchor=(1.0, 1.0), frameon=False, fontsize=8)
    ax.set_title(_title(plan), fontsize=8, loc="left")


def _measured(diagnosis: Diagnosis, names: list[str], ax: Axes) -> None:
    """Measured rows; where one of the two conditions is not recorded, ticks along the other axis."""
    columns = [diagnosis.traces.against.get(name) for name in names]
    known = {name: shown(name, c)[0] for name, c in zip(names, columns, strict=True) if c is not None}
    if len(known) == len(names) == 2:
        ax.plot(*known.values(), "o", color=_SEEN, mew=0, markersize=4, label="measured")
    elif names[0] in known:
        across = ax.get_xaxis_transform()
        ax.vlines(known[names[0]], 0.0, _TICK, _SEEN, transform=across, label="measured")
    elif names[1:2] and names[1] in known:
        along = ax.get_yaxis_transform()
        ax.hlines(known[names[1]], 0.0, _TICK, _SEEN, transform=along, label="measured")


def _places(plan: NextMeasurement, names: list[str], ax: Axes) -> None:
    values = [shown(name, np.array(plan.conditions[name]))[0] for name in names]
    rows = plan.conditions["rows"]
    if len(values) == 1:
        values.append(np.zeros(len(rows)))
        ax.set_yticks([])
    alike = len(set(rows)) == 1  # then the legend says it once
    label = f"to measure, {rows[0]} rows each" if alike else "to measure"
    ax.plot(*values, "D", color=_PROPOSED, markersize=9, label=label)
    for place, (x, y, count) in enumerate(zip(*values, rows, strict=True)):
        if not alike:
            at = (8, 6 if place % 2 else -14)
            ax.annotate(f"{count} rows", (x, y), xytext=at, textcoords="offset points", color=_PROPOSED)


def _title(plan: NextMeasurement) -> str:
    shown_names = ", ".join(plan.separates[:4]) + (", ..." if len(plan.separates) > 4 else "")
    return (
        f"separates: {shown_names}\nprobability of the most probable set of effects: "
        f"{plan.probability_now:.2f} now, {plan.expected_probability:.2f} expected afterwards"
    )


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


def plot_unexplained(diagnosis: Diagnosis, ax: Axes) -> None:
    """Unexplained term against its column, with its uncertainty, over the residuals of all rows."""
    found = diagnosis.unexplained
    if found is None or found.shape is None:
        ax.axis("off")
        ax.text(0.5, 0.5, "no unexplained term", ha="center", transform=ax.transAxes)
        return
    column = column_of(found.against, diagnosis.traces.against)
    residual = 1e3 * diagnosis.traces.after
    values, label = shown(found.against, column)
    opacity = float(np.clip(_MANY / max(len(residual), 1), 0.25, 0.9))
    ax.plot(values, residual, "o", color=_FAINT, mew=0, markersize=3, alpha=opacity, label="residual")
    knots = np.array(found.shape.at)
    at, _ = shown(found.against, knots)
    shift, band = 1e3 * found.shape.of(knots), 1e3 * found.shape.band(knots)
    ax.fill_between(at, shift - 2 * band, shift + 2 * band, color=TERM, alpha=0.25, lw=0, label="95 %")
    ax.plot(at, shift, color=TERM, linewidth=2, label="smooth function")
    ends = np.nanpercentile(residual, [0.5, 99.5])
    low, high = min(ends[0], (shift - 2 * band).min()), max(ends[1], (shift + 2 * band).max())
    ax.set_ylim(low - 0.1 * (high - low), high + 0.1 * (high - low))
    ax.axhline(0.0, color="0.7", linewidth=0.8, zorder=0)
    ax.set(xlabel=fitted(label, _TERM_LABEL), ylabel="residual [mm]")
    title = (
        f"no cause of the catalogue explains this residual: {1e3 * found.rms_m:.1f} mm (RMS) against {label}"
    )
    ax.set_title(fitted(title, _TERM_TITLE), fontsize=8, loc="left")
    ax.legend(loc="best", frameon=False, fontsize=8)
