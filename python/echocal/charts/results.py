"""Figures of a calibration, a verification, an inspection, a diagnosis, several tables and a fleet."""

from collections.abc import Mapping, Set
from typing import Any

import numpy as np
import pandas as pd

from echocal.calibrate import Calibration
from echocal.charts.parts import Axis, Bar, Bars, Chart, Line, Panel, Points, evenly, span
from echocal.diagnose import Diagnosis
from echocal.diagnose.findings.sentences import readable
from echocal.diagnose.pooling.parts import PooledCause
from echocal.diagnose.results.grouped import LEAST, Group, has_any, in_common, reported, shown_groups
from echocal.observations.inspection import ColumnFacts, Inspection
from echocal.verify import Verification

_MM = 1e3  # mm in a meter
_INTERVAL = 1.96  # standard uncertainties
_MOST = 15  # causes that are drawn
_BESIDE = 0.12  # of the step between tables
_GROUPS = 8


def residual_chart(found: Calibration) -> Chart:
    """Residuals over the rows."""
    used = np.flatnonzero(np.isfinite(found.residuals))
    rows = used[evenly(len(used))]
    residual = Points("residual", "after", rows + 1.0, found.residuals[rows])
    y = Axis("observed minus predicted [unit of the response]", *span([residual.y]))
    return Chart("Residuals", Axis("row", 0.0, len(found.residuals) + 1.0), [Panel("", y, [residual])])


def errors_chart(found: Verification) -> Bars:
    """Magnitude of the errors beside the maximum permissible error."""
    texts = {
        "largest": (found.maximum_error, "+"),
        "mean": (found.mean_error, "+"),
        "RMS": (found.rms_error, ""),
    }
    bars = [
        Bar(
            name,
            _MM * abs(error),
            f"{_MM * error:{sign}.3g} mm",
            "out" if abs(error) > found.maximum_permissible_error else "after",
        )
        for name, (error, sign) in texts.items()
    ]
    bound = _MM * found.maximum_permissible_error
    bars.append(Bar("maximum permissible", bound, f"{bound:.3g} mm", "quiet"))
    return Bars("Errors", "magnitude of the error [mm]", bars, max(bar.value for bar in bars))


def columns_chart(found: Inspection) -> Chart | None:
    """Each column of numbers over the rows; None where there is none."""
    panels = [_column(found.table, one) for one in found.columns if one.median is not None]
    return Chart("", Axis("row", 0.0, found.rows + 1.0), panels) if panels else None


def _column(table: pd.DataFrame, one: ColumnFacts) -> Panel:
    values = pd.to_numeric(table[one.name], errors="coerce").to_numpy(dtype=np.float64, na_value=np.nan)
    known = np.flatnonzero(np.isfinite(values) & ~np.isin(values, one.codes))
    rows = known[evenly(len(known))]
    unit = f" [{one.unit}]" if one.unit else ""
    y = Axis("", *span([values[rows]]))
    return Panel(f"{one.name}{unit}", y, [Points(one.name, "after", rows + 1.0, values[rows])])


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


def fleet_errors_chart(summary: Mapping[str, Any]) -> Bars | None:
    """RMS error with the base and with the model, where a cause comes first."""
    bars = [
        Bar(f"{one['id']}: {said}", one[key], f"{one[key]:.2f} mm", tone)
        for one in summary["causes"][:_MOST]
        if one["rms_before_mm"] is not None
        for said, key, tone in (("base", "rms_before_mm", "before"), ("model", "rms_after_mm", "after"))
    ]
    label = "RMS error [mm], median where the cause comes first"
    return Bars("Error", label, bars, max(bar.value for bar in bars)) if bars else None


def gain_chart(diagnosis: Diagnosis) -> Bars | None:
    """Error on rows that take no part in the fit, as causes are added."""
    gain = diagnosis.gain
    if gain is None:
        return None
    rungs = [
        (f"+ {ids[-1]}" if ids else "base", rms, "after" if ids else "before") for ids, rms in gain.ladder
    ]
    if gain.rms_fixed_speed_m is not None:
        rungs.insert(0, ("one fixed speed", gain.rms_fixed_speed_m, "quiet"))
    if len(gain.ladder) > 1 and gain.judged_rows != "held-out rows":
        rungs.append(("chosen by each fold", gain.rms_after_m, "after"))
    smooth = diagnosis.smooth
    if smooth is not None and smooth.offered and smooth.rms_after_m is not None:
        rungs.append(("+ smooth correction", smooth.rms_after_m, "term"))
    rungs.append(("all columns could reach", gain.rms_floor_m, "quiet"))
    rows = f"{gain.held_out_rows} {gain.judged_rows} ({gain.scheme})"
    after = f" to {1e3 * gain.rms_after_m:.2f}" if len(gain.ladder) > 1 else ""
    notes = [f"RMS error on {rows}: {1e3 * gain.rms_before_m:.2f}{after} mm"]
    if len(gain.ladder) > 1:
        low, high = (1e3 * end for end in gain.interval_95)
        least, most = (100 * end for end in gain.variance_removed_interval_95)
        notes.append(
            f"the model removes {100 * gain.variance_removed:.0f} % of the mean square error ({least:.0f} to "
            f"{most:.0f} %) on rows that neither its choice nor its fit has seen: the RMS error is {low:.2f} "
            f"to {high:.2f} mm smaller (95 % intervals)"
        )
    else:
        notes.append("no effect extends the base")
    if smooth is not None and smooth.offered and smooth.rms_after_m is not None:
        notes.append("the smooth correction has no known cause")
    bars = [Bar(name, 1e3 * rms, f"{1e3 * rms:.2f} mm", tone) for name, rms, tone in rungs]
    label = f"RMS error on {gain.judged_rows} [mm]"
    return Bars("Error", label, bars, max(bar.value for bar in bars), notes)


def posterior_chart(diagnosis: Diagnosis, most: int = _GROUPS) -> Bars:
    """Probability of the sets of causes; sets that the data cannot separate share a bar. It ends at 1."""
    groups = shown_groups(diagnosis, most)
    common, claimed = in_common(groups), reported(diagnosis)
    bars = [
        Bar(
            _label(group, common),
            group.probability,
            f"{group.probability:.3f}",
            "after" if has_any(group, claimed) else "quiet",
            group.shares,
        )
        for group in groups
    ]
    notes = _remarks(groups, common, claimed)
    return Bars("Probabilities", "probability that exactly these causes act", bars, 1.0, notes)


def _label(group: Group, common: Set[str]) -> str:
    """What acts beyond the causes of all sets; the set without more is these causes themselves."""
    more = f"{'+ ' * bool(common)}{group.beyond(common)}"
    return more if set(group.classes) - common else " + ".join(group.classes) or "no effect"


def _remarks(groups: list[Group], common: Set[str], claimed: Set[str]) -> list[str]:
    remarks = []
    if common:
        remarks.append(f"in every set: {', '.join(sorted(common))}")
    if len({has_any(group, claimed) for group in groups}) > 1:
        remarks.append("in color: sets with a cause that the verdict reports")
    if any(len(group.shares) > 1 and group.shares[1] >= LEAST for group in groups):
        remarks.append("the parts of a bar are sets that these data cannot separate")
    for name, members in {name: m for group in groups for name, m in group.members.items()}.items():
        remarks.append(f"{name}: {', '.join(members[1:])}")
    return remarks
