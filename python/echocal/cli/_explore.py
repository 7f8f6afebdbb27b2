"""``echocal firmware --explore``: the choices between flash, time and error, as table, JSON and picture."""

import json
from pathlib import Path
from typing import Any

from rich.markup import escape
from rich.table import Table

from echocal.cli._console import Console
from echocal.errors import writing
from echocal.explore import Choice, Progress, explore
from echocal.model import Model
from echocal.outputs import replace_text

SCHEMA = "echocal.firmware_choices/1"
FILES = ("choices.json", "choices.png")


def run(model: Model, target: str, out: Path, progress: Progress, **request: Any) -> tuple[str, Table]:
    """Explore, write ``choices.json`` and ``choices.png``, and return the JSON and the table."""
    choices = explore(model, target, progress=progress, **request)
    rows = [choice.to_dict() for choice in choices]
    text = json.dumps({"schema": SCHEMA, "target": target, "choices": rows}, indent=2) + "\n"
    with writing(out):
        out.mkdir(parents=True, exist_ok=True)
    listed, drawn = (out / name for name in FILES)
    replace_text(listed, text)
    _draw(rows, drawn)
    return text, _table(choices)


def _draw(rows: list[dict[str, Any]], path: Path) -> None:
    from matplotlib.figure import Figure

    from echocal.plots.choices import plot_choices
    from echocal.plots.draw import save_figure

    figure = Figure(figsize=(8.0, 5.0), layout="constrained")
    plot_choices(rows, figure.add_subplot())
    save_figure(figure, path, "firmware")


def _table(choices: list[Choice]) -> Table:
    cores = sorted({choice.core for choice in choices if choice.core})
    source = f"measured on {', '.join(cores)}" if cores else "by the cost model, not measured"
    table = Table(title=f"Pareto front of flash, time and error ({source})")
    for name in ("flash [B]", choices[0].unit, "error [mm]"):
        table.add_column(escape(name), justify="right")
    table.add_column("form")
    for choice in choices:
        note = "" if choice.core or not cores else " (cost model)"
        figures = (f"{choice.flash}", f"{choice.steps}", f"{choice.error * 1e3:.4f}")
        table.add_row(*figures, choice.form + note)
    return table


def show(console: Console, table: Table, notes: list[str], out: Path) -> None:
    """Print the table, its notes, and the paths of the files."""
    console.print(table)
    for note in notes:
        console.print(f"[yellow]note[/] {escape(note)}")
    paths = (escape(str(out / name)) for name in ("choices.json", "choices.png"))
    console.print("written " + ", ".join(f"[cyan]{path}[/]" for path in paths))
