"""The diagnosis of a fleet on the terminal."""

from collections.abc import Mapping
from typing import Any

from rich.console import Console, Group, RenderableType
from rich.panel import Panel
from rich.table import Column, Table
from rich.text import Text

from echocal.diagnose.pooling.explain import (
    lead,
    sentence,
    short_sizes,
    sizes_text,
    transfer_text,
)
from echocal.diagnose.pooling.parts import InTable, PooledCause
from echocal.diagnose.pooling.result import PooledDiagnosis
from echocal.diagnose.results.explain import probability_text
from echocal.report.diagnosis import STYLE, listed

_MOST_TABLES = 40  # tables that are listed for each cause
_LEAST = 0.005  # probability of a set that is shown
_SETS = 6

_MOST = 12  # causes, and failed sensors, that are listed
_PAIRS = 5  # pairs of causes that are listed
_ORDER = ("named", "ambiguous", "unknown", "nothing", "failed")


def print_fleet(summary: Mapping[str, Any], console: Console) -> None:
    """Print the summary of a fleet for a person.

    The summary is of schema ``echocal.fleet/1``.
    """
    console.print(_head(summary))
    if summary["causes"]:
        console.print(_causes(summary))
    for kind, found in summary["kinds"].items():
        console.print(_prevalence(kind, found))
    for line in false_names(summary["false_discoveries"]):
        console.print(Text(line))
    for one in summary["together"][:_PAIRS]:
        a, b = one["ids"]
        told = (
            f"{a} and {b} are claimed together in {one['sensors']} sensors; {one['by_chance']:.1f} would be "
            "chance. One of them may be a part of the other; the number of false names does not know this."
        )
        console.print(Text.assemble(("together  ", "yellow"), told))
    if summary["worst"]:
        console.print(_worst(summary))
    failed = summary["failed"]
    for one in failed[:_MOST]:
        console.print(Text.assemble(("failed  ", "red"), f"{one['sensor']}: {one['reason']}"))
    if len(failed) > _MOST:
        console.print(Text(f"and {len(failed) - _MOST} more; the table has all reasons", style="dim"))
    for note in summary["notes"]:
        console.print(Text.assemble(("note  ", "dim"), note))


def false_names(found: Mapping[str, Any]) -> list[str]:
    """Sentences on the names that are expected to be false."""
    lines = []
    for what, text in (("own", "from each sensor alone"), ("fleet", "given the fleet")):
        one = found[what]
        if one["names"]:
            lines.append(
                f"{one['names']} causes have a probability of {found['named_from']:g} or more {text}; "
                f"{one['expected_false']:.1f} of these names are expected to be false "
                f"({100 * one['rate']:.1f} %)."
            )
    longest = found["at_rate"]
    if longest["names"]:
        lines.append(
            f"A list of {longest['names']} names, from a probability of {longest['probability_from']:.3f} "
            f"on, is expected to have at most {100 * longest['rate']:g} % false ones."
        )
    return lines


def _head(summary: Mapping[str, Any]) -> Panel:
    counts = summary["verdicts"]
    words = []
    for verdict in (name for name in _ORDER if name in counts):
        style = STYLE.get(verdict, "red")
        words += [(f"{counts[verdict]} {verdict}", style), (", ", "")]
    rows = summary["rows"]
    text = Text.assemble(*words[:-1])
    text.append(f"\n{summary['sensors']} sensors, {rows['used']} of {rows['total']} rows used; ")
    text.append(f"{summary['seconds']:.1f} s")
    rms = summary["rms_mm"]
    if rms["before"] is not None:
        text.append(
            f"\nmedian RMS error: {rms['before']:.2f} mm with the base, {rms['after']:.2f} mm with the model"
        )
    return Panel(text, title="fleet", title_align="left", expand=False)


def _causes(summary: Mapping[str, Any]) -> Table:
    title = Text("causes; base and gain [mm]: medians where a cause comes first")
    table = listed(title, ["cause"], ["sensors", "named (fleet)", "base", "gain", "size"])
    table.columns[0].min_width, table.columns[0].overflow = 16, "fold"
    for one in summary["causes"][:_MOST]:
        size = "" if one["size"] is None else f"{one['size']:.3g} {one['unit'] if one['unit'] != '1' else ''}"
        table.add_row(
            _or(one["id"], one["alternatives"]),
            str(one["sensors"]),
            f"{one['named']} ({one['named_in_fleet']})",
            _mm(one["rms_before_mm"]),
            _mm(one["gained_mm"]),
            size.strip(),
        )
    return table


def _prevalence(kind: str, found: Mapping[str, Any]) -> Table:
    title = f"how common causes are among {found['sensors']} sensors" + (f" of kind {kind}" if kind else "")
    table = listed(title, ["cause"], ["part of the sensors [%]", "standard uncertainty [%]"])
    for one in found["causes"][:_MOST]:
        table.add_row(one["id"], f"{100 * one['share']:.1f}", f"{100 * one['standard_uncertainty']:.1f}")
    return table


def _worst(summary: Mapping[str, Any]) -> Table:
    table = listed("largest errors", ["sensor", "verdict", "cause"], ["base [mm]", "model [mm]"])
    for one in summary["worst"]:
        errors = (_mm(one["rms_before_mm"]), _mm(one["rms_after_mm"]))
        table.add_row(str(one["sensor"]), one["verdict"], one["cause"] or "", *errors)
    return table


def _or(cause: str, alternatives: list[str]) -> Text:
    """A cause, and what some of its sensors cannot separate from it."""
    text = Text(cause)
    if alternatives:
        more = f" or {len(alternatives) - 1} more" if len(alternatives) > 1 else ""
        text.append(f" or {alternatives[0]}{more}", style="dim")
    return text


def _mm(value: float | None) -> str:
    return "" if value is None else f"{value:.2f}"


def print_pooled(pooled: PooledDiagnosis, console: Console) -> None:
    """Print a pooled diagnosis for a person."""
    said = lead(pooled)
    rows = sum(table.diagnosis.rows["used"] for table in pooled.tables.values())
    head = [
        Text.assemble((pooled.verdict, STYLE[pooled.verdict]), f": {said[0].lower()}{said[1:]}"),
        Text(f"{len(pooled.tables)} tables, {rows} rows used; {pooled.seconds:.2f} s"),
    ]
    console.print(Panel(Group(*head), title="pooled diagnosis", title_align="left", expand=False))
    for cause in pooled.causes:
        console.print(_cause(cause))
    console.print(_tables(pooled))
    console.print(Text(transfer_text(pooled)))
    console.print(_posterior(pooled))
    for one in pooled.skipped:
        count = "" if one.rows is None else f" ({one.rows} rows)"
        console.print(Text.assemble(("left out  ", "yellow"), f"{one.name}{count}: {one.reason}"))
    for note in pooled.notes:
        console.print(Text.assemble(("note  ", "dim"), note))


def _cause(cause: PooledCause) -> RenderableType:
    lines: list[RenderableType] = [
        Text.assemble((cause.id, "bold"), f"  {sizes_text(cause)}  ", (probability_text(cause), "green")),
        Text(f"  {sentence(cause)}"),
        Text(f"  {cause.because}", style="italic"),
    ]
    if cause.doubt:
        lines.append(Text(f"  doubt: {cause.doubt}", style="yellow"))
    if cause.indistinguishable_from:
        lines.append(
            Text(f"  no table separates it from: {', '.join(cause.indistinguishable_from)}", "yellow")
        )
    table = Table("table", Column("log Bayes factor", justify="right"), "alone", "in the pool")
    for one in cause.tables[:_MOST_TABLES]:
        table.add_row(one.table, *_row(one))
    lines.append(table)
    if len(cause.tables) > _MOST_TABLES:
        lines.append(
            Text(f"  and {len(cause.tables) - _MOST_TABLES} more tables: the JSON has all", style="dim")
        )
    return Group(*lines, Text())


def _row(one: InTable) -> tuple[str, str, str]:
    if one.role == "not tested":
        return one.role, one.why, ""
    return f"{one.log_bayes:+.1f}", short_sizes(one.parameters), short_sizes(one.drawn)


def _tables(pooled: PooledDiagnosis) -> RenderableType:
    """Each table by itself, and the model of the others on it."""
    title = "each table alone, and the model of the other tables on it"
    table = listed(title, ["table", "alone", "causes of its own"], ["base [mm]", "others [mm]"])
    for name, result in list(pooled.tables.items())[:_MOST_TABLES]:
        other = result.transfer
        errors = (f"{1e3 * rms:.2f}" for rms in (other.rms_before_m, other.rms_after_m))
        table.add_row(name, result.diagnosis.verdict, ", ".join(result.own_causes), *errors)
    return table


def _posterior(pooled: PooledDiagnosis) -> RenderableType:
    table = Table(title="probability of each set of shared causes", title_justify="left", show_header=False)
    for ids, probability in pooled.posterior[:_SETS]:
        if probability >= _LEAST:
            table.add_row(" + ".join(ids) or "no shared cause", f"{probability:.3f}")
    return table
