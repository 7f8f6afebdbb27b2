"""Figures of several tables and of a fleet."""

from collections.abc import Mapping
from typing import Any

import numpy as np

from echocal.charts.parts import Axis, Bar, Bars, Chart, Line, Panel, Points, span
from echocal.diagnose.findings.sentences import readable
from echocal.diagnose.pooling.parts import PooledCause

__all__ = ["counts_chart", "errors_chart", "sizes_chart", "verdicts_chart"]

_INTERVAL = 1.96  # standard uncertainties
_MOST = 15  # causes that are drawn
_BESIDE = 0.12  # of the step between tables


def sizes_chart(cause: PooledCause) -> Chart | None:
    """Sizes of a shared cause in each table, alone and drawn to the mean; None without a free size."""
    free = [p for p in cause.parameters if p.standard_uncertainty > 0.0]
    if not free:
        return None
    ends = Axis("table, in the order of the list below", 0.5, len(cause.tables) + 0.5)
    notes = ("95 % intervals; first: from the table alone; second: in the pool; line: mean of all tables",)
    return Chart(cause.id, ends, [_sizes(cause, p.name) for p in free], notes)


def _sizes(cause: PooledCause, name: str) -> Panel:
    shared = next(p for p in cause.parameters if p.name == name)
    factor, unit = readable(shared.value, shared.unit)
    middle = np.full(2, factor * shared.value)
    marks: list[Points | Line] = [
        Line("mean of all tables", "quiet", np.array([0.5, len(cause.tables) + 0.5]), middle)
    ]
    for place, one in enumerate(cause.tables, start=1):
        for said, parameters, tone, shift in (
            ("alone", one.parameters, "before", -_BESIDE),
            ("in the pool", one.drawn, "after", _BESIDE),
        ):
            for p in (p for p in parameters if p.name == name):
                x, value, half = place + shift, factor * p.value, factor * _INTERVAL * p.standard_uncertainty
                marks.append(Line(one.table, tone, np.full(2, x), np.array([value - half, value + half])))
                marks.append(Points(f"{one.table}, {said}", tone, np.array([x]), np.array([value])))
    label = f"{name.replace('_', ' ')}{f' [{unit}]' if unit else ''}"
    return Panel(label, Axis("", *span([mark.y for mark in marks])), marks)


def verdicts_chart(summary: Mapping[str, Any]) -> Bars:
    """Sensors by their verdict."""
    bars = [Bar(name, count, str(count), "after") for name, count in summary["verdicts"].items()]
    return Bars("", "sensors", bars, summary["sensors"])


def counts_chart(summary: Mapping[str, Any]) -> Bars | None:
    """Sensors in which each cause is claimed, with those in which it is named."""
    bars = [
        Bar(
            one["id"],
            one["sensors"],
            f"{one['sensors']}, named in {one['named_in_fleet']}",
            "after",
            [part for part in (one["named_in_fleet"], one["sensors"] - one["named_in_fleet"]) if part],
        )
        for one in summary["causes"][:_MOST]
    ]
    return Bars("Sensors with each cause", "sensors", bars, summary["sensors"]) if bars else None


def errors_chart(summary: Mapping[str, Any]) -> Bars | None:
    """RMS error with the base and with the model, where a cause comes first."""
    bars = [
        Bar(f"{one['id']}: {said}", one[key], f"{one[key]:.2f} mm", tone)
        for one in summary["causes"][:_MOST]
        if one["rms_before_mm"] is not None
        for said, key, tone in (("base", "rms_before_mm", "before"), ("model", "rms_after_mm", "after"))
    ]
    label = "RMS error [mm], median where the cause comes first"
    return Bars("Error", label, bars, max(bar.value for bar in bars)) if bars else None
