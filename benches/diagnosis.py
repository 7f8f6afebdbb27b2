"""Judge the diagnosis on fresh hidden effects: every row of the table of targets, with intervals."""

import json
import os
import sys
from concurrent.futures import ProcessPoolExecutor, as_completed
from pathlib import Path
from typing import Annotated, Any

for library in ("OMP", "OPENBLAS", "RAYON"):  # before numpy: a process of ours is one thread
    os.environ.setdefault(f"{library}_NUM_THREADS", "1")

import numpy as np  # noqa: E402
import typer  # noqa: E402
from rich.console import Console  # noqa: E402
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn  # noqa: E402
from rich.table import Table  # noqa: E402

ROOT = Path(__file__).parents[1]
sys.path.insert(0, str(ROOT / "tests"))

from hidden_effects.answers import ask, known  # noqa: E402
from hidden_effects.cases import Spec  # noqa: E402
from hidden_effects.menu import menu  # noqa: E402
from hidden_effects.page import page, reliability_plot  # noqa: E402
from hidden_effects.summary import summarize  # noqa: E402

PAGE = ROOT / "docs" / "diagnosis-benchmark.md"
RESULTS = ROOT / "benches" / "diagnosis.json"
BENCH = ROOT / "benches" / "diagnosis_bench.json"
COLORS = {"met": "green", "missed": "red", "open": "yellow"}
Record = dict[str, Any]


def run(specs: list[Spec], processes: int, console: Console) -> list[Record]:
    """Ask about every case, in the order given."""
    columns = (TextColumn("{task.description}"), BarColumn(), MofNCompleteColumn(), TimeRemainingColumn())
    records: list[Record | None] = [None] * len(specs)
    with Progress(*columns, console=console) as progress, ProcessPoolExecutor(processes) as pool:
        task = progress.add_task("hidden effects", total=len(specs))
        waiting = {pool.submit(ask, spec): i for i, spec in enumerate(specs)}
        for done in as_completed(waiting):
            records[waiting[done]] = done.result()
            progress.advance(task)
    return [record for record in records if record is not None]


def show(summary: Record, console: Console) -> None:
    """Print the table of targets."""
    designs = list(summary["cases"])
    table = Table("figure", *designs, title=f"hidden effects, seed {summary['seed']}")
    for row in summary["targets"]:
        cells = []
        for design in designs:
            figure = row["figures"][design]
            text = f"{figure['value']:.3f} ({figure['low']:.3f}-{figure['high']:.3f})" if figure else "-"
            cells.append(f"[{COLORS.get(row['verdict'][design], 'white')}]{text}[/]")
        table.add_row(row["name"], *cells)
    console.print(table)
    for key, (wrong, count) in summary["confident_wrong"]["counts"].items():
        console.print(f"confident wrong names, {key}: {wrong} in {count} cases")


def write(summary: Record) -> None:
    """Write the page, what it is made from, and its plot."""
    text = json.dumps(summary, indent=1) + "\n"
    RESULTS.write_text(text, encoding="utf-8")
    bench = json.loads(BENCH.read_text(encoding="utf-8")) if BENCH.exists() else None
    PAGE.write_text(page(json.loads(text), bench), encoding="utf-8")
    reliability_plot(summary).savefig(PAGE.with_suffix(".png"), dpi=110)


def main(
    cases: Annotated[int, typer.Option(help="Cases per design, besides those the engine lacks.")] = 400,
    designs: Annotated[str, typer.Option(help="Designs, by comma.")] = "a,b,c",
    seed: Annotated[int | None, typer.Option(help="Default: a fresh one.")] = None,
    processes: Annotated[int, typer.Option(help="Processes at once, one thread each.")] = 1,
    records: Annotated[Path | None, typer.Option(help="Write every case here, as JSON.")] = None,
    read: Annotated[Path | None, typer.Option(help="Report on cases written before; ask nothing.")] = None,
    docs: Annotated[
        bool, typer.Option("--docs", help=f"Write docs/{PAGE.name}, its plot and {RESULTS.name}.")
    ] = False,
) -> None:
    """Draw fresh cases, diagnose them, and report."""
    console = Console(width=140)
    chosen = int(np.random.SeedSequence().generate_state(1)[0]) if seed is None else seed
    if read:
        outcome = json.loads(read.read_text())
    else:
        console.print(f"seed {chosen}")
        engine = sorted(known())
        answers = run(menu(designs.split(","), cases, engine, chosen), processes, console)
        outcome = {"seed": chosen, "engine": engine, "records": answers}
    if records:
        records.write_text(json.dumps(outcome, indent=1) + "\n", encoding="utf-8")
    summary = summarize(outcome["records"], outcome["engine"], outcome["seed"])
    show(summary, console)
    if docs:
        write(summary)


if __name__ == "__main__":
    typer.run(main)
