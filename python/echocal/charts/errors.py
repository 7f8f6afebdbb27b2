"""Figures of the errors of a diagnosis, before and after."""

import numpy as np
from numpy.typing import NDArray

from echocal.arrays import Column
from echocal.charts.parts import MOST, Axis, Chart, Line, Panel, Points, Rug, evenly, span
from echocal.diagnose import Diagnosis
from echocal.diagnose.findings.parts import Traces
from echocal.diagnose.findings.sentences import Recorded, most_correlated, shown, spoken
from echocal.diagnose.preprocess.hold_out import HELD_OUT_ROW
from echocal.diagnose.results.fates import USED

ERROR = "reading minus reference [mm]"
"""What an error is: the label of its axis. The level stands for a reference that is not known."""

SIGN = "above 0, it reads too far"
"""What the sign of an error means."""

_BINS = 30
_FEW = 200  # rows that are visible one by one
_ENOUGH = 5  # fewest rows of a mean that is drawn
_SAME = 1e-6  # m, far below the resolution of such sensors
_REPEATED = 0.999  # correlation with a column that is drawn, beyond which a further panel shows nothing new
_FINER = 0.2  # part of the error, below which a scale of its own is needed to see it
_MIDDLE = (0.5, 99.5)  # percentiles between which the errors are drawn
_ROOM = 0.25

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


def by_correlation(diagnosis: Diagnosis) -> list[str]:
    """Columns that vary, those first that the change by the model (or the residual) follows most.

    The first one is the column that a sentence about the whole change would name.
    """
    traces = diagnosis.traces
    changed = traces.before - traces.after
    signal = changed if np.nanstd(changed) > _SAME else traces.before
    known = np.isfinite(signal)
    varied = {name: column[known] for name, column in traces.against.items() if _varies(column)}
    first = most_correlated(signal[known], Recorded(varied))
    return sorted(varied, key=lambda name: (name != first, -_explained_variance(varied[name], signal[known])))


def drawn_columns(diagnosis: Diagnosis, most: int) -> list[str]:
    """The first columns by correlation, without repeated ones; time wherever it is recorded."""
    against = diagnosis.traces.against
    every = by_correlation(diagnosis)
    if "time" in every and "row" in every:
        every.remove("row")  # the same order
    kept: list[str] = []
    for name in every:
        if name == "time" or not any(_repeats(against[name], against[other]) for other in kept):
            kept.append(name)
    chosen = kept[:most]
    if "time" in kept and "time" not in chosen:
        chosen[-1] = "time"
    return chosen


def _repeats(one: Column, other: Column) -> bool:
    return abs(float(np.corrcoef(one, other)[0, 1])) > _REPEATED


def is_finer(traces: Traces) -> bool:
    """Whether the errors after are so much smaller than those before that they need a scale of their own."""
    before, after = (np.ptp(_middle(error)) for error in (traces.before, traces.after))
    return bool(after < _FINER * before)


def limits(traces: Traces, which: str) -> tuple[float, float]:
    """Range of the axis of the errors before or after [mm]: one range for both, or one for each."""
    own = [traces.before if which == "before" else traces.after]
    ends = np.concatenate([_middle(e) for e in (own if is_finer(traces) else (traces.before, traces.after))])
    low, high = 1e3 * min(ends.min(), 0.0), 1e3 * max(ends.max(), 0.0)
    room = _ROOM * (high - low) + 1e-3
    return low - room, high + room


def _middle(error: Column) -> Column:
    return np.asarray(np.nanpercentile(error, _MIDDLE))


def left_out_at(diagnosis: Diagnosis, name: str) -> Column:
    """Where rows are left out: as positions in the source, or on an axis of time, by the rows around them."""
    out = np.flatnonzero(~np.isin(diagnosis.fates.fate.astype(str), (USED, HELD_OUT_ROW))).astype(np.float64)
    if name == "row":
        return out
    if name != "time":
        return np.empty(0)
    traces = diagnosis.traces
    order = np.argsort(traces.row)
    return np.interp(out, traces.row[order], traces.against[name][order])


def binned_means(x: Column, y: Column) -> tuple[Column, Column]:
    """Means of bins with about equally many rows; of many rows, bins with few rows are left out."""
    if not len(x):
        return x, y
    bins = _binned(x)
    rows = np.bincount(bins)
    filled = rows >= (1 if len(x) <= _FEW else min(_ENOUGH, rows.max()))
    means = [np.bincount(bins, weights=values)[filled] / rows[filled] for values in (x, y)]
    return means[0], means[1]


def _binned(x: Column) -> NDArray[np.int64]:
    """Bin of each value: about equally many rows in each, or one for each value where these are few."""
    count = min(_BINS, max(2, len(x) // 3))
    distinct, bins = np.unique(x, return_inverse=True)
    if len(distinct) > count:
        edges = np.unique(np.quantile(x, np.linspace(0, 1, count + 1)))
        bins = np.clip(np.searchsorted(edges, x, side="right") - 1, 0, max(len(edges) - 2, 0))
    return np.asarray(bins, dtype=np.int64)


def _explained_variance(x: Column, y: Column) -> float:
    """Part of the variance of y that the means of bins of x explain."""
    bins = _binned(x)
    rows = np.bincount(bins)
    filled = rows > 0
    means = np.bincount(bins, weights=y)[filled] / rows[filled]
    return float(rows[filled] @ (means - y.mean()) ** 2 / max(len(y) * y.var(), 1e-300))


def _varies(column: Column) -> bool:
    return bool(np.isfinite(column).all() and np.ptp(column) > 0)
