"""A pooled diagnosis on the terminal."""

from rich.console import Console, Group, RenderableType
from rich.panel import Panel
from rich.table import Table
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
from echocal.report.diagnosis import STYLE

__all__ = ["print_pooled"]

_MOST = 40  # tables that are listed for each cause
_LEAST = 0.005  # probability of a set that is shown
_SETS = 6


def print_pooled(pooled: PooledDiagnosis, console: Console) -> None:
    """Print a pooled diagnosis for a person.

    Parameters
    ----------
    pooled : PooledDiagnosis
    console : rich.console.Console
    """
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
    table = Table()
    for name, side in (
        ("table", "left"),
        ("log Bayes factor", "right"),
        ("alone", "left"),
        ("in the pool", "left"),
    ):
        table.add_column(name, justify=side)  # type: ignore[arg-type]
    for one in cause.tables[:_MOST]:
        table.add_row(one.table, *_row(one))
    lines.append(table)
    if len(cause.tables) > _MOST:
        lines.append(Text(f"  and {len(cause.tables) - _MOST} more tables: the JSON has all", style="dim"))
    return Group(*lines, Text())


def _row(one: InTable) -> tuple[str, str, str]:
    if one.role == "not tested":
        return one.role, one.why, ""
    return f"{one.log_bayes:+.1f}", short_sizes(one.parameters), short_sizes(one.drawn)


def _tables(pooled: PooledDiagnosis) -> RenderableType:
    """Each table by itself, and the model of the others on it."""
    table = Table(title="each table alone, and the model of the other tables on it", title_justify="left")
    table.add_column("table")
    table.add_column("alone")
    table.add_column("causes of its own")
    for text in ("base [mm]", "others [mm]"):
        table.add_column(Text(text), justify="right")  # a unit is no markup
    for name, result in list(pooled.tables.items())[:_MOST]:
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
