"""Figures of a diagnosis that can be moved and read in a browser."""

import textwrap
from collections.abc import Sequence
from typing import Any

import numpy as np
import plotly.graph_objects as go
from numpy.typing import NDArray
from plotly.subplots import make_subplots

from echocal.diagnose import Diagnosis
from echocal.diagnose.findings.sentences import shown
from echocal.diagnose.results.followed import by_correlation
from echocal.diagnose.results.grouped import LEAST, grouped, in_common

__all__ = ["gain_figure", "left_out_figure", "over_figure", "posterior_figure", "styled", "time_figure"]

Column = NDArray[np.float64]

BEFORE, AFTER, QUIET = "#c8500a", "#155a75", "#8a8f94"
_MOST = 4000  # points of a trace; a phone draws more slowly than a reader waits
_FEW = 500
_GROUPS = 8
_BAR = 34  # pixels
_ROOM = 1.4  # of the longest bar, for its number
_TALL, _BOTH = 320, 440
_DAY = 86400.0


def time_figure(diagnosis: Diagnosis) -> go.Figure:
    """Error over time, or over the rows where no time is recorded."""
    traces = diagnosis.traces
    if "time" in by_correlation(diagnosis):
        seconds = traces.against["time"] - np.nanmin(traces.against["time"])
        days = bool(np.nanmax(seconds) > 2 * _DAY)
        x: Column = seconds / (_DAY if days else 60.0)
        label = f"time [{'d' if days else 'min'}]"
    else:
        x = np.asarray(traces.row, dtype=np.float64) + 1.0
        label = "row"
    return _errors(diagnosis, x, label)


def over_figure(diagnosis: Diagnosis, name: str) -> go.Figure:
    """Error over a recorded column."""
    return _errors(diagnosis, *shown(name, diagnosis.traces.against[name]))


def _errors(diagnosis: Diagnosis, x: Column, label: str) -> go.Figure:
    """Error of the base and, below it with a scale of its own, of the model; one of them where both agree."""
    traces = diagnosis.traces
    parts = [("base", traces.before, BEFORE), ("extended model", traces.after, AFTER)]
    if np.array_equal(traces.before, traces.after, equal_nan=True):
        parts = [("base, not extended", traces.before, BEFORE)]
    titles = [name for name, _, _ in parts]
    figure = make_subplots(
        rows=len(parts), cols=1, shared_xaxes=True, vertical_spacing=0.12, subplot_titles=titles
    )
    figure.update_annotations(x=0, xanchor="left", font_size=13)
    for place, (name, error, color) in enumerate(parts, start=1):
        rows = _some(error)
        figure.add_scatter(
            x=_rounded(x[rows]),
            y=_rounded(1e3 * error[rows]),
            customdata=(traces.row[rows] + 1).tolist(),
            name=name,
            mode="markers",
            marker={"color": color, "size": 4, "opacity": 0.6 if len(rows) > _FEW else 0.9},
            hovertemplate="row %{customdata}<br>%{x}<br>%{y:.2f} mm<extra></extra>",
            showlegend=False,
            row=place,
            col=1,
        )
        low, high = 1e3 * np.nanpercentile(error, [0.5, 99.5])
        room = 0.2 * (high - low) + 1e-3
        figure.update_yaxes(title="error [mm]", range=[low - room, high + room], row=place, col=1)
    figure.update_xaxes(title=label, row=len(parts), col=1)
    return styled(figure, _TALL if len(parts) == 1 else _BOTH)


def gain_figure(diagnosis: Diagnosis) -> go.Figure | None:
    """Error on rows that take no part in the fit, as causes are added."""
    gain = diagnosis.gain
    if gain is None:
        return None
    rungs = [(f"+ {ids[-1]}" if ids else "base", rms, AFTER if ids else BEFORE) for ids, rms in gain.ladder]
    if gain.rms_fixed_speed_m is not None:
        rungs.insert(0, ("one fixed speed", gain.rms_fixed_speed_m, QUIET))
    if len(gain.ladder) > 1 and gain.judged_rows != "held-out rows":
        rungs.append(("chosen by each fold", gain.rms_after_m, AFTER))
    smooth = diagnosis.smooth
    if smooth is not None and smooth.offered and smooth.rms_after_m is not None:
        rungs.append(("+ smooth correction", smooth.rms_after_m, AFTER))
    rungs.append(("all columns could reach", gain.rms_floor_m, QUIET))
    figure = _bars([r[0] for r in rungs], [1e3 * r[1] for r in rungs], [r[2] for r in rungs], "%{x:.2f} mm")
    largest = 1e3 * max(rms for _, rms, _ in rungs)
    figure.update_xaxes(title="RMS error [mm]", range=[0, _ROOM * largest])
    return figure


def posterior_figure(diagnosis: Diagnosis) -> go.Figure | None:
    """Probability of each group of sets of causes."""
    groups = [group for group in grouped(diagnosis) if group.probability >= LEAST][:_GROUPS]
    if len(groups) == 1:
        return None
    common = in_common(groups)
    names = [_wrapped(group.beyond(common)) for group in groups]
    colors = [AFTER] + [QUIET] * (len(groups) - 1)
    figure = _bars(names, [group.probability for group in groups], colors, "%{x:.3f}")
    figure.update_xaxes(title="probability of exactly these", range=[0, _ROOM])
    return figure


def left_out_figure(diagnosis: Diagnosis) -> go.Figure | None:
    """Where the rows are that are left out, a line for each reason."""
    counts = diagnosis.fates.counts
    if not counts:
        return None
    figure = go.Figure()
    fate = diagnosis.fates.fate.astype(str)
    for reason in counts:
        rows = np.flatnonzero(fate == reason) + 1
        chosen = rows[_evenly(len(rows))]
        name = _wrapped(reason)
        figure.add_scatter(
            x=chosen.tolist(),
            y=[name] * len(chosen),
            mode="markers",
            marker={"symbol": "line-ns-open", "color": BEFORE, "size": 12},
            hovertemplate="row %{x}<extra></extra>",
            showlegend=False,
        )
    figure.update_xaxes(title="row", range=[0, len(fate) + 1])
    figure.update_yaxes(automargin=True)
    return styled(figure, 130 + _BAR * len(counts))


def _bars(names: Sequence[str], values: Sequence[float], colors: Sequence[str], text: str) -> go.Figure:
    figure = go.Figure()
    figure.add_bar(
        x=[float(f"{value:.6g}") for value in values],
        y=list(range(len(names))),
        orientation="h",
        marker_color=list(colors),
        texttemplate=text,
        textposition="outside",
        cliponaxis=False,
        hoverinfo="skip",
    )
    height = 110 + _BAR * len(names) + 12 * sum(name.count("<br>") for name in names)
    places = list(range(len(names)))
    styled(figure, height).update_yaxes(
        tickvals=places, ticktext=list(names), autorange="reversed", zeroline=False
    )
    return figure


def styled(figure: go.Figure, height: int) -> go.Figure:
    """Give a figure the colors and margins of the page, and a height in pixels."""
    grid: dict[str, Any] = {"gridcolor": "#e6e8ea", "zerolinecolor": "#b8bcc0", "linecolor": "#8a8f94"}
    figure.update_layout(
        height=height,
        margin={"l": 10, "r": 20, "t": 48, "b": 10},
        plot_bgcolor="white",
        paper_bgcolor="white",
        font={"family": "system-ui, sans-serif", "size": 13, "color": "#22282c"},
        dragmode="pan",
        hovermode="closest",
    )
    figure.update_xaxes(automargin=True, **grid)
    figure.update_yaxes(automargin=True, **grid)
    return figure


def _some(error: Column) -> NDArray[np.int64]:
    """Rows that are drawn: all, or evenly chosen ones, and the largest errors in any case."""
    known = np.flatnonzero(np.isfinite(error))
    if len(known) <= _MOST:
        return known
    largest = known[np.argsort(-np.abs(error[known] - np.nanmedian(error)))[: _MOST // 20]]
    return np.unique(np.concatenate([known[_evenly(len(known))], largest]))


def _evenly(count: int) -> NDArray[np.int64]:
    return np.unique(np.linspace(0, count - 1, min(count, _MOST)).astype(np.int64))


def _rounded(values: Column) -> list[float]:
    """Six digits: the file stays small."""
    return [float(f"{value:.6g}") for value in values]


def _wrapped(text: str, width: int = 24) -> str:
    return "<br>".join(textwrap.wrap(text, width)) or text
