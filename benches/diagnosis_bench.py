"""Judge the diagnosis on tables of the virtual bench, beside equation-made tables and real records."""

import json
import os
import sys
from concurrent.futures import ProcessPoolExecutor, as_completed
from dataclasses import asdict
from pathlib import Path
from typing import Annotated, Any

for library in ("OMP", "OPENBLAS", "RAYON"):  # before numpy: a process of ours is one thread
    os.environ.setdefault(f"{library}_NUM_THREADS", "1")

import numpy as np  # noqa: E402
import typer  # noqa: E402
from rich.console import Console  # noqa: E402
from rich.progress import (  # noqa: E402
    BarColumn,
    MofNCompleteColumn,
    Progress,
    TextColumn,
    TimeRemainingColumn,
    track,
)

ROOT = Path(__file__).parents[1]
sys.path.insert(0, str(ROOT / "tests"))

from hidden_effects.bench.answers import ask, judge_again  # noqa: E402
from hidden_effects.bench.equations import equations  # noqa: E402
from hidden_effects.bench.figure import beside_plot  # noqa: E402
from hidden_effects.bench.menu import menu  # noqa: E402
from hidden_effects.bench.page import beside  # noqa: E402
from hidden_effects.bench.real import real  # noqa: E402
from hidden_effects.bench.summary import summarize  # noqa: E402
from hidden_effects.bench.world import Spec  # noqa: E402
from hidden_effects.page import page  # noqa: E402

from echocal.virtual_bench import DESIGNS  # noqa: E402

PAGE = ROOT / "docs" / "diagnosis-benchmark.md"
RESULTS = ROOT / "benches" / "diagnosis_bench.json"
EQUATIONS = ROOT / "benches" / "diagnosis.json"
Record = dict[str, Any]


def _key(record: Record) -> tuple[Any, ...]:
    return (record["design"], record["stratum"], tuple(record["causes"]), record["detector"], record["seed"])


def run(specs: list[Spec], seed: int, processes: int, path: Path, console: Console) -> None:
    """Ask about each spec that the file of records does not have yet, and add a line each.

    In an order of chance, so that a run that is stopped has some of all.
    """
    done = {_key(record) for record in read(path)} if path.exists() else set()
    left = [spec for spec in specs if _key(asdict(spec)) not in done]
    columns = (TextColumn("{task.description}"), BarColumn(), MofNCompleteColumn(), TimeRemainingColumn())
    with (
        Progress(*columns, console=console) as progress,
        ProcessPoolExecutor(processes) as pool,
        path.open("a", encoding="utf-8") as lines,
    ):
        task = progress.add_task("tables of the bench", total=len(specs), completed=len(specs) - len(left))
        order = np.random.default_rng(seed).permutation(len(left))
        waiting = [pool.submit(ask, left[i]) for i in order]
        try:
            for answered in as_completed(waiting):
                lines.write(json.dumps({"run": seed, **answered.result()}) + "\n")
                lines.flush()
                progress.advance(task)
        except BaseException:
            pool.shutdown(wait=False, cancel_futures=True)  # else the error is told after the last table
            raise


def read(path: Path) -> list[Record]:
    """All records of a file."""
    return [json.loads(line) for line in path.read_text(encoding="utf-8").splitlines() if line]


def write(summary: Record, console: Console) -> None:
    """Write the summary, the page and its figure."""
    parts = (f'"{name}": {json.dumps(part)}' for name, part in summary.items())
    text = "{\n" + ",\n".join(parts) + "\n}\n"
    RESULTS.write_text(text, encoding="utf-8")
    made = json.loads(EQUATIONS.read_text(encoding="utf-8"))
    PAGE.write_text(page(made, json.loads(text)), encoding="utf-8")
    beside_plot(json.loads(text)).savefig(PAGE.with_name("diagnosis-benchmark-bench.png"), dpi=110)
    console.print(f"wrote {RESULTS.name}, {PAGE.name} and its figure")


def main(
    count: Annotated[int, typer.Option(help="Tables over all designs.")] = 1200,
    designs: Annotated[str, typer.Option(help="Designs of the bench, by comma.")] = ",".join(DESIGNS),
    seed: Annotated[int | None, typer.Option(help="Default: a fresh one.")] = None,
    processes: Annotated[int, typer.Option(help="Processes at once, one thread each.")] = 2,
    records: Annotated[
        Path, typer.Option(help="A line of JSON for each table; a run that was stopped goes on with it.")
    ] = Path("bench-records.jsonl"),
    only_read: Annotated[bool, typer.Option("--read", help="Report on these records; ask nothing.")] = False,
    again: Annotated[
        bool, typer.Option("--judge-again", help="Judge the answers of these records as the judge is now.")
    ] = False,
    made: Annotated[
        Path | None, typer.Option(help="Records that `diagnosis.py --records` wrote, to stand beside.")
    ] = None,
    docs: Annotated[
        bool, typer.Option("--docs", help=f"Write docs/{PAGE.name}, its figure and {RESULTS.name}.")
    ] = False,
) -> None:
    """Draw tables of the bench, diagnose them, and report."""
    console = Console(width=140)
    if not only_read:
        chosen = int(np.random.SeedSequence().generate_state(1)[0]) if seed is None else seed
        console.print(f"seed {chosen}")
        run(menu(designs.split(","), count, chosen), chosen, processes, records, console)
    answered = read(records)
    if again:
        with ProcessPoolExecutor(processes) as pool:
            judged = pool.map(judge_again, answered, chunksize=4)
            answered = list(track(judged, "judging", total=len(answered), console=console))
        records.write_text("".join(json.dumps(one) + "\n" for one in answered), encoding="utf-8")
    summary = summarize(answered)
    if made:
        summary["equations"] = equations(json.loads(made.read_text(encoding="utf-8")))
    elif RESULTS.exists():
        summary["equations"] = json.loads(RESULTS.read_text(encoding="utf-8")).get("equations")
    summary["real"] = real()
    console.print("\n".join(beside(summary)))
    if docs:
        write(summary, console)


if __name__ == "__main__":
    typer.run(main)
