"""Figures of a diagnosis that can be moved and read in a browser."""

import textwrap
from collections.abc import Sequence
from typing import Any

import numpy as np
import plotly.graph_objects as go
from numpy.typing import NDArray

from echocal.diagnose import Diagnosis
from echocal.diagnose.results.grouped import has_any, in_common, reported, shown_groups

__all__ = ["gain_figure", "left_out_figure", "posterior_figure", "styled"]

Column = NDArray[np.float64]

BEFORE, AFTER, QUIET = "#c8500a", "#155a75", "#8a8f94"
MOST = 4000  # points of a trace; a phone draws more slowly than a reader waits
_GROUPS = 8
_BAR = 34  # pixels
_ROOM = 1.4  # of the longest bar, for its number


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
    groups = shown_groups(diagnosis, _GROUPS)
    if len(groups) == 1:
        return None
    common = in_common(groups)
    names = [_wrapped(group.beyond(common)) for group in groups]
    claimed = reported(diagnosis)
    colors = [AFTER if has_any(group, claimed) else QUIET for group in groups]
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


def _evenly(count: int) -> NDArray[np.int64]:
    return np.unique(np.linspace(0, count - 1, min(count, MOST)).astype(np.int64))


def _wrapped(text: str, width: int = 24) -> str:
    return "<br>".join(textwrap.wrap(text, width)) or text
