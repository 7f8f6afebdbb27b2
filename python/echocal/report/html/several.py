"""Pages of several tables and of a fleet."""

from collections.abc import Mapping
from typing import Any

from echocal.charts.results import counts_chart, fleet_errors_chart, sizes_chart, verdicts_chart
from echocal.diagnose.pooling.explain import in_table_text, lead, sentence, sizes_text, transfer_text
from echocal.diagnose.pooling.parts import PooledCause
from echocal.diagnose.pooling.result import PooledDiagnosis
from echocal.diagnose.results.explain import probability_text
from echocal.report.html.document import Head, Section, notes_of, sections_page
from echocal.report.several import false_names


def pooled_page(pooled: PooledDiagnosis, heading: str = "several tables", made_by: str = "") -> str:
    """A diagnosis of several tables as an HTML document that needs no other file and no network."""
    used = sum(table.diagnosis.rows["used"] for table in pooled.tables.values())
    facts = [("tables", str(len(pooled.tables))), ("rows used", str(used))]
    tables = [
        (
            name,
            result.diagnosis.verdict,
            ", ".join(result.own_causes),
            _mm(result.transfer.rms_before_m),
            _mm(result.transfer.rms_after_m),
        )
        for name, result in pooled.tables.items()
    ]
    left_out = [f"{one.name}: {one.reason}." for one in pooled.skipped]
    sections = [
        *(_cause(cause) for cause in pooled.causes),
        Section(
            "Each table alone, and the model of the other tables on it",
            [f"{transfer_text(pooled)}."],
            columns=("table", "verdict alone", "causes of its own", "base [mm]", "others [mm]"),
            rows=tables,
        ),
        Section("Tables left out", left_out),
        notes_of(pooled.notes),
    ]
    head = Head("Pooled diagnosis", heading, lead(pooled), pooled.verdict, facts)
    return sections_page("diagnose", head, sections, made_by)


def _cause(cause: PooledCause) -> Section:
    texts = [sentence(cause), probability_text(cause), f"{cause.because}."]
    if cause.doubt:
        texts.append(f"Doubt: {cause.doubt}.")
    if cause.indistinguishable_from:
        texts.append(f"No table separates it from {', '.join(cause.indistinguishable_from)}.")
    chart = sizes_chart(cause)
    return Section(
        f"{cause.id}: {sizes_text(cause)}",
        texts,
        [] if chart is None else [chart],
        ("", "table", "what it says"),
        [(str(place), one.table, in_table_text(one)) for place, one in enumerate(cause.tables, start=1)],
    )


def fleet_page(summary: Mapping[str, Any], heading: str = "fleet", made_by: str = "") -> str:
    """The diagnosis of a fleet as an HTML document that needs no other file and no network.

    The summary is of schema ``echocal.fleet/1``.
    """
    verdicts = ", ".join(f"{count} {name}" for name, count in summary["verdicts"].items())
    rows, rms = summary["rows"], summary["rms_mm"]
    facts = [("sensors", str(summary["sensors"])), ("rows used", f"{rows['used']} of {rows['total']}")]
    if rms["before"] is not None:
        facts += [("median RMS error, base", _shown(rms["before"]))]
        facts += [("median RMS error, model", _shown(rms["after"]))]
    together = [
        f"{' and '.join(one['ids'])} are claimed together in {one['sensors']} sensors; "
        f"{one['by_chance']:.1f} would be chance. One of them may be a part of the other."
        for one in summary["together"]
    ]
    shares = [
        (kind, one["id"], f"{100 * one['share']:.1f} %", f"{100 * one['standard_uncertainty']:.1f} %")
        for kind, found in summary["kinds"].items()
        for one in found["causes"]
    ]
    worst = [
        (
            str(one["sensor"]),
            one["verdict"],
            one["cause"] or "",
            _shown(one["rms_before_mm"]),
            _shown(one["rms_after_mm"]),
        )
        for one in summary["worst"]
    ]
    charts = [one for one in (counts_chart(summary), fleet_errors_chart(summary)) if one is not None]
    sections = [
        Section("Verdicts", charts=[verdicts_chart(summary)]),
        Section("Causes", [*false_names(summary["false_discoveries"]), *together], charts),
        Section("Largest errors", columns=("sensor", "verdict", "cause", "base", "model"), rows=worst),
        Section(
            "How common causes are",
            columns=("kind", "cause", "part of the sensors", "standard uncertainty"),
            rows=shares,
        ),
        Section("Failed", [f"{one['sensor']}: {one['reason']}." for one in summary["failed"]]),
        notes_of(summary["notes"]),
    ]
    return sections_page("diagnose", Head("Diagnosis", heading, verdicts, "", facts), sections, made_by)


def _mm(meters: float) -> str:
    return f"{1e3 * meters:.2f}"


def _shown(millimeters: float | None) -> str:
    return "" if millimeters is None else f"{millimeters:.2f} mm"
