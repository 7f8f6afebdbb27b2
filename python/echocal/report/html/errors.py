"""Figures of the errors of a diagnosis, before and after, that can be moved and read in a browser."""

import numpy as np
import plotly.graph_objects as go
from numpy.typing import NDArray
from plotly.subplots import make_subplots

from echocal.diagnose import Diagnosis
from echocal.diagnose.findings.sentences import shown
from echocal.panels import by_correlation, is_finer, left_out_at, limits
from echocal.report.html.figures import AFTER, BEFORE, MOST, QUIET, styled

__all__ = ["distance_figure", "over_figure", "time_figure", "truth_figure"]

Column = NDArray[np.float64]

_FEW = 500
_TALL, _BOTH = 320, 440
_DAY = 86400.0
_MARK = 0.97  # height of the marks of rows that are left out, in parts of the axis


def _along(diagnosis: Diagnosis) -> tuple[Column, Column, str]:
    """Time or, where it is not recorded, the row: of the used rows, of those left out, and the label."""
    against = diagnosis.traces.against
    out = left_out_at(diagnosis, "time" if "time" in by_correlation(diagnosis) else "row")
    if "time" not in by_correlation(diagnosis):
        return np.asarray(diagnosis.traces.row, dtype=np.float64) + 1.0, out + 1.0, "row"
    start = np.nanmin(against["time"])
    days = bool(np.nanmax(against["time"]) - start > 2 * _DAY)
    unit = _DAY if days else 60.0
    return (against["time"] - start) / unit, (out - start) / unit, f"time [{'d' if days else 'min'}]"


def time_figure(diagnosis: Diagnosis) -> go.Figure:
    """Error over time, or over the rows where no time is recorded, with marks where rows are left out."""
    x, out, label = _along(diagnosis)
    return _errors(diagnosis, x, label, out)


def over_figure(diagnosis: Diagnosis, name: str) -> go.Figure:
    """Error over a recorded column."""
    return _errors(diagnosis, *shown(name, diagnosis.traces.against[name]), np.empty(0))


def distance_figure(diagnosis: Diagnosis) -> go.Figure | None:
    """Distance over time: true, by the base, by the extended model; None where it is not known."""
    true = diagnosis.traces.against.get("distance")
    if true is None:
        return None
    x, _, label = _along(diagnosis)
    figure = _distances(diagnosis, x)
    rows = _some(true)
    figure.add_scatter(
        x=_rounded(x[rows]), y=_rounded(true[rows]), name="true", **_points(QUIET, "x-thin-open")
    )
    figure.update_xaxes(title=label)
    figure.update_yaxes(title="distance [m]")
    return figure


def truth_figure(diagnosis: Diagnosis) -> go.Figure | None:
    """Reading against the true distance, before and after; None where this is not known or does not vary."""
    true = diagnosis.traces.against.get("distance")
    if true is None or "distance" not in by_correlation(diagnosis):
        return None
    figure = _distances(diagnosis, true)
    ends = [float(true.min()), float(true.max())]
    figure.add_scatter(x=ends, y=ends, mode="lines", name="true", line={"color": QUIET, "width": 1})
    figure.update_xaxes(title="true distance [m]")
    figure.update_yaxes(title="reading [m]")
    return figure


def _distances(diagnosis: Diagnosis, x: Column) -> go.Figure:
    traces, figure = diagnosis.traces, go.Figure()
    true = traces.against["distance"]
    for name, error, color in _parts(diagnosis):
        rows = _some(error)
        figure.add_scatter(
            x=_rounded(x[rows]), y=_rounded((true + error)[rows]), name=name, **_points(color, "circle")
        )
    figure.update_layout(legend={"orientation": "h", "y": -0.25, "yanchor": "top"})
    return styled(figure, _TALL)


def _points(color: str, symbol: str) -> dict[str, object]:
    return {"mode": "markers", "marker": {"color": color, "size": 4, "symbol": symbol, "opacity": 0.8}}


def _parts(diagnosis: Diagnosis) -> list[tuple[str, Column, str]]:
    traces = diagnosis.traces
    if np.array_equal(traces.before, traces.after, equal_nan=True):
        return [("base, not extended", traces.before, BEFORE)]
    return [("base", traces.before, BEFORE), ("extended model", traces.after, AFTER)]


def _errors(diagnosis: Diagnosis, x: Column, label: str, out: Column) -> go.Figure:
    """Error of the base and, below it, of the model: at one scale, or at its own where it is much finer."""
    traces, parts = diagnosis.traces, _parts(diagnosis)
    titles = [name for name, _, _ in parts]
    if len(parts) > 1:
        titles[1] += ", at a scale of its own" if is_finer(traces) else ", at the same scale"
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
        low, high = limits(traces, "before" if place == 1 else "after")
        figure.update_yaxes(title="error [mm]", range=[low, high], row=place, col=1)
        if len(out):
            _mark(figure, out, low + _MARK * (high - low), place)
    figure.update_xaxes(title=label, row=len(parts), col=1)
    return styled(figure, _TALL if len(parts) == 1 else _BOTH)


def _mark(figure: go.Figure, out: Column, height: float, place: int) -> None:
    """Marks at the upper edge where rows are left out."""
    chosen = out[_evenly(len(out))]
    figure.add_scatter(
        x=_rounded(chosen),
        y=[height] * len(chosen),
        name="left out",
        mode="markers",
        marker={"symbol": "line-ns-open", "color": "#9b2335", "size": 8},
        hovertemplate="left out<extra></extra>",
        showlegend=False,
        row=place,
        col=1,
    )


def _some(error: Column) -> NDArray[np.int64]:
    """Rows that are drawn: all, or evenly chosen ones, and the largest errors in any case."""
    known = np.flatnonzero(np.isfinite(error))
    if len(known) <= MOST:
        return known
    largest = known[np.argsort(-np.abs(error[known] - np.nanmedian(error)))[: MOST // 20]]
    return np.unique(np.concatenate([known[_evenly(len(known))], largest]))


def _evenly(count: int) -> NDArray[np.int64]:
    return np.unique(np.linspace(0, count - 1, min(count, MOST)).astype(np.int64))


def _rounded(values: Column) -> list[float]:
    """Six digits: the file stays small."""
    return [float(f"{value:.6g}") for value in values]
