"""What no diagnosis could do better on the cases of a benchmark: judges that know how they were drawn."""

import json
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path
from typing import Annotated

import typer
from diagnosis import PAGE, RESULTS, write  # first: it sets the threads, and where the tests are
from hidden_effects.ceiling import ceiling, look
from rich.console import Console
from rich.progress import track


def main(
    records: Annotated[Path, typer.Argument(help="Cases that `diagnosis.py --records` wrote.")],
    processes: Annotated[int, typer.Option(help="Processes at once, one thread each.")] = 1,
    docs: Annotated[
        bool, typer.Option("--docs", help=f"Add to {RESULTS.name} and docs/{PAGE.name}.")
    ] = False,
) -> None:
    """Judge the same cases with all that can be known, and compare."""
    console = Console(width=140)
    outcome = json.loads(records.read_text())
    cases = [r for r in outcome["records"] if "error" not in r and r["design"] != "c"]
    with ProcessPoolExecutor(processes) as pool:
        found = pool.map(look, cases, chunksize=2)
        looks = list(track(found, "judging", total=len(cases), console=console))
    rows = ceiling(cases, looks)
    console.print_json(json.dumps(rows))
    if docs:
        summary = json.loads(RESULTS.read_text(encoding="utf-8"))
        if summary["seed"] != outcome["seed"]:
            raise SystemExit(f"{RESULTS.name} is of seed {summary['seed']}, {records} of {outcome['seed']}")
        write({**summary, "ceiling": rows})


if __name__ == "__main__":
    typer.run(main)
