"""The study on a terminal."""

from collections.abc import Iterable

from rich import box
from rich.console import Console, Group, RenderableType
from rich.panel import Panel
from rich.rule import Rule
from rich.table import Table
from rich.text import Text

from echocal.study import DEFINITION, Study
from echocal.study.origin import CAUSES
from echocal.study.verdict import Cell, Finding, Verdict

__all__ = ["MARKS", "show"]

MARKS = {Verdict.REPRODUCED: "✓", Verdict.NOT_REPRODUCED: "✗", Verdict.PHYSICALLY_WRONG: "≠"}
COLORS = {Verdict.REPRODUCED: "green", Verdict.NOT_REPRODUCED: "red", Verdict.PHYSICALLY_WRONG: "magenta"}
BAR = 60  # characters


def show(study: Study, console: Console) -> None:
    """Print everything that was found.

    Parameters
    ----------
    study : Study
        Results.
    console : Console
        Where to.
    """
    console.print(_first_table(study), "", _second_table(study))
    for group in dict.fromkeys(finding.claim.group for finding in study.findings):
        console.print("", _claims(group, [f for f in study.findings if f.claim.group == group]))
    console.print("", Rule("what the tables show and the study does not say", style="cyan", align="left"))
    for number, discovery in enumerate(study.discoveries, 1):
        console.print(Text(f"{number}. {discovery.title}", style="bold"))
        console.print(Text(discovery.text, style="dim"))
    console.print("", _alternatives(study), "", _summary(study))


def _summary(study: Study) -> RenderableType:
    bar, counts = Text(), Text()
    total = len(study.findings)
    for verdict in Verdict:
        count = study.verdicts[verdict.value]
        bar.append("█" * round(BAR * count / total), style=COLORS[verdict])
        counts.append(f"{MARKS[verdict]} {count} {verdict.value}   ", style=f"bold {COLORS[verdict]}")
    text = Text(DEFINITION, style="dim")
    title = f"[bold]the study, recomputed[/]: {total} claims"
    return Panel(Group(bar, counts, "", text), title=title, title_align="left", border_style="cyan")


def _grid(title: str, columns: Iterable[str]) -> Table:
    table = Table(
        title=title, title_justify="left", title_style="bold", box=box.SIMPLE_HEAD, padding=(0, 1, 0, 0)
    )
    for column in columns:
        table.add_column(column, justify="right")
    return table


def _cell(cell: Cell) -> Text:
    return Text(f"{cell.printed} {MARKS[cell.verdict]}", style=COLORS[cell.verdict])


def _number(value: float | None, digits: int) -> Text:
    return Text("" if value is None else f"{value:.{digits}f}", style="dim")


def _first_table(study: Study) -> Table:
    names = ("table1-speed", "table1-time", "table1-distance", "table1-error", "table1-sign")
    speed, time, distance, error, sign = (study[name].cells for name in names)
    table = _grid(
        "Table 1 as printed, with 331.4 + 0.6 T (stated) and air at 50 % RH (true)",
        ("°C", "speed", "stated", "true", "time", "distance", "true", "error %", "signed"),
    )
    for row in range(len(speed)):
        table.add_row(
            f"{speed[row].temperature:g}",
            _cell(speed[row]),
            _number(speed[row].recomputed, 3),
            _number(speed[row].physical, 2),
            _cell(time[row]),
            _cell(distance[row]),
            _number(distance[row].physical, 3),
            _cell(error[row]),
            Text(f"{sign[row].recomputed:+.2f} {MARKS[sign[row].verdict]}", style=COLORS[sign[row].verdict]),
        )
    return table


def _second_table(study: Study) -> Table:
    calculation, tinkercad = study["table2-calculation"].cells, study["table2-tinkercad"].cells
    table = _grid(
        "Table 2 as printed, with 331.4 + 0.6 T; Tinkercad: within ±3 mm of the calculation?",
        ("°C", "calculation", "stated", "true", "Tinkercad", "difference mm"),
    )
    for left, right in zip(calculation, tinkercad, strict=True):
        difference = (float(right.printed) - right.recomputed) * 1e3
        table.add_row(
            f"{left.temperature:g}",
            _cell(left),
            _number(left.recomputed, 3),
            _number(left.physical, 3),
            _cell(right),
            _number(difference, 0),
        )
    return table


def _claims(group: str, findings: list[Finding]) -> Table:
    table = Table(
        title=group,
        title_justify="left",
        title_style="bold",
        box=box.SIMPLE_HEAD,
        padding=(0, 1),
        expand=True,
    )
    for name, ratio in (("", 1), ("claim", 24), ("printed", 8), ("recomputed", 9), ("in true air", 12)):
        table.add_column(name, ratio=ratio, justify="left" if name in {"", "claim"} else "right")
    for finding in findings:
        verdict, claim = finding.verdict, finding.claim
        said = Text(claim.claim)
        if verdict is not Verdict.REPRODUCED:
            said.append(f"\n{finding.because}", style="dim")
        table.add_row(
            Text(MARKS[verdict], style=f"bold {COLORS[verdict]}"),
            said,
            f"{claim.printed} {claim.unit}".strip(),
            Text(finding.recomputed, style=COLORS[verdict]),
            Text(finding.physical, style="dim"),
        )
    return table


def _alternatives(study: Study) -> Table:
    table = _grid(
        "Single changes that explain the Tinkercad column", ("change", "parameter", "value", "residual")
    )
    table.columns[0].justify = table.columns[1].justify = "left"
    for alternative in study.alternatives:
        leaves = f"{alternative.residual_standard_deviation * 1e3:.2f} mm"
        table.add_row(CAUSES[alternative.cause], alternative.cause, str(alternative), leaves)
    return table
