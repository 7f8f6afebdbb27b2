"""What no diagnosis could do better on the cases of a benchmark: judges that know how they were drawn."""

import json
import os
import sys
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path
from typing import Annotated, Any

for library in ("OMP", "OPENBLAS", "RAYON"):  # before numpy: a process of ours is one thread
    os.environ.setdefault(f"{library}_NUM_THREADS", "1")

import typer  # noqa: E402
from rich.console import Console  # noqa: E402
from rich.progress import track  # noqa: E402

ROOT = Path(__file__).parents[1]
sys.path.insert(0, str(ROOT / "tests"))

from hidden_effects.ceiling import ceiling, look  # noqa: E402
from hidden_effects.page import page  # noqa: E402

PAGE = ROOT / "docs" / "diagnosis-benchmark.md"
RESULTS = ROOT / "benches" / "diagnosis.json"
Record = dict[str, Any]


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
        summary["ceiling"] = rows
        text = json.dumps(summary, indent=1) + "\n"
        RESULTS.write_text(text, encoding="utf-8")
        PAGE.write_text(page(json.loads(text)), encoding="utf-8")


if __name__ == "__main__":
    typer.run(main)
