"""Figures of the errors of a diagnosis, before and after."""

import numpy as np
from numpy.typing import NDArray

from echocal.charts.columns import ERROR, SIGN, binned_means, by_correlation, is_finer, left_out_at, limits
from echocal.charts.parts import MOST, Axis, Chart, Line, Panel, Points, Rug, evenly, span
from echocal.diagnose import Diagnosis
from echocal.diagnose.findings.sentences import shown, spoken

__all__ = ["column_chart", "distance_chart", "left_out_chart", "over_chart", "time_chart", "truth_chart"]

Column = NDArray[np.float64]

_MINUTE = 60.0  # s
_DAY = 86400.0  # s


def time_chart(diagnosis: Diagnosis) -> Chart:
    """Error over time, or over the rows where no time is recorded, with marks where rows are left out."""
    x, out, axis = _along(diagnosis)
    title = "Row by row" if axis.label == "row" else "Over time"
    return _errors(diagnosis, title, x, axis, out)


def over_chart(diagnosis: Diagnosis, name: str) -> Chart:
    """Error over a recorded column."""
    x, label = shown(name, diagnosis.traces.against[name])
    return _errors(diagnosis, f"Over {spoken(name)}", x, Axis(label, *span([x])), np.empty(0))


def column_chart(diagnosis: Diagnosis, name: str) -> Chart:
    """Error over a column of the traces; over time and rows with marks where rows are left out."""
    return time_chart(diagnosis) if name in ("time", "row") else over_chart(diagnosis, name)


def distance_chart(diagnosis: Diagnosis) -> Chart | None:
    """Distance over time: true, by the base, by the extended model; None where it is not known."""
    true = diagnosis.traces.against.get("distance")
    if true is None:
        return None
    x, _, axis = _along(diagnosis)
    rows = _some(true)
    marks = [*_distances(diagnosis, x), Points("true", "quiet", x[rows], true[rows])]
    return _one("Distance over time", axis, "distance [m]", marks)


def truth_chart(diagnosis: Diagnosis) -> Chart | None:
    """Reading against the true distance, before and after; None where this is not known or does not vary."""
    true = diagnosis.traces.against.get("distance")
    if true is None or "distance" not in by_correlation(diagnosis):
        return None
    ends = np.array([true.min(), true.max()])
    marks = [*_distances(diagnosis, true), Line("true", "quiet", ends, ends)]
    return _one("Reading against truth", Axis("true distance [m]", *span([ends])), "reading [m]", marks)


def left_out_chart(diagnosis: Diagnosis) -> Chart | None:
    """Where the rows are that are left out, a line for each reason."""
    counts = diagnosis.fates.counts
    fate = diagnosis.fates.fate.astype(str)
    panels = []
    for reason, count in counts.items():
        rows = 1.0 + np.flatnonzero(fate == reason).astype(np.float64)
        panels.append(Panel(f"{reason}: {count}", None, [Rug(reason, "out", rows[evenly(count)], count)]))
    return Chart("Rows left out", Axis("row", 0.0, len(fate) + 1.0), panels) if panels else None


def _along(diagnosis: Diagnosis) -> tuple[Column, Column, Axis]:
    """Time or, where it is not recorded, the row: of the used rows, of those left out, and the axis."""
    traces = diagnosis.traces
    out = left_out_at(diagnosis, "time" if "time" in by_correlation(diagnosis) else "row")
    if "time" not in by_correlation(diagnosis):
        x, out, label = np.asarray(traces.row, dtype=np.float64) + 1.0, out + 1.0, "row"
    elif traces.begin is not None:
        x, label = traces.against["time"], "time (UTC)"
    else:
        seconds = traces.against["time"]
        start = np.nanmin(seconds)
        unit = _DAY if np.nanmax(seconds) - start > 2 * _DAY else _MINUTE
        x, out = (seconds - start) / unit, (out - start) / unit
        label = f"time [{'d' if unit == _DAY else 'min'}]"
    return x, out, Axis(label, *span([x, out]), traces.begin if label == "time (UTC)" else None)


def _one(title: str, x: Axis, label: str, marks: list[Points | Line]) -> Chart:
    y = Axis(label, *span([mark.y for mark in marks]))
    return Chart(title, x, [Panel("", y, marks)])


def _distances(diagnosis: Diagnosis, x: Column) -> list[Points | Line]:
    traces = diagnosis.traces
    return [
        _points(name, tone, x, traces.against["distance"] + error, traces.row)
        for name, error, tone in _parts(diagnosis)
    ]


def _points(name: str, tone: str, x: Column, y: Column, row: NDArray[np.int64]) -> Points:
    rows = _some(y)
    return Points(name, tone, x[rows], y[rows], row[rows] + 1)


def _parts(diagnosis: Diagnosis) -> list[tuple[str, Column, str]]:
    traces = diagnosis.traces
    if np.array_equal(traces.before, traces.after, equal_nan=True):
        return [("base, not extended", traces.before, "before")]
    return [("base", traces.before, "before"), ("extended model", traces.after, "after")]


def _errors(diagnosis: Diagnosis, title: str, x: Column, axis: Axis, out: Column) -> Chart:
    """Error of the base and, below it, of the model: at one scale, or at its own where it is much finer."""
    traces, panels = diagnosis.traces, []
    after = "after: extended model, at " + ("a scale of its own" if is_finer(traces) else "the same scale")
    for name, error, tone in _parts(diagnosis):
        known = np.isfinite(error)
        means = Line("mean", "ink", *binned_means(x[known], 1e3 * error[known]))
        marks: list[Points | Line | Rug] = [_points(name, tone, x, 1e3 * error, traces.row), means]
        if len(out):
            marks.append(Rug("left out", "out", out[evenly(len(out))], len(out)))
        y = Axis(ERROR, *limits(traces, tone))
        panels.append(Panel(after if tone == "after" else f"{_before(name)}; {SIGN}", y, marks))
    return Chart(title, axis, panels)


def _before(name: str) -> str:
    return f"before: {name}" if name == "base" else name


def _some(values: Column) -> NDArray[np.int64]:
    """Rows that are drawn: all, or evenly chosen ones, and the most deviating ones in any case."""
    known = np.flatnonzero(np.isfinite(values))
    if len(known) <= MOST:
        return known
    largest = known[np.argsort(-np.abs(values[known] - np.nanmedian(values)))[: MOST // 20]]
    return np.unique(np.concatenate([known[evenly(len(known))], largest]))
