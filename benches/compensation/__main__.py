"""Which euro and which method buy how many millimeters: docs/compensation.md.

``python benches/compensation --write`` draws devices and weather, writes figures.json, and makes page and
figure anew; without ``--write`` it prints a table only. A quarter of an hour of one processor.
"""

import os
import sys
import warnings
from concurrent.futures import ProcessPoolExecutor, as_completed
from itertools import product
from pathlib import Path
from typing import Annotated

for library in ("OMP", "OPENBLAS", "RAYON"):  # before numpy: a process of ours is one thread
    os.environ.setdefault(f"{library}_NUM_THREADS", "1")
sys.path.insert(0, str(Path(__file__).parents[1]))

import numpy as np  # noqa: E402
import typer  # noqa: E402
from rich.console import Console  # noqa: E402
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn  # noqa: E402

from compensation import campaign, page  # noqa: E402
from compensation.summary import Answer, summarize  # noqa: E402


def one(seed: int, trained: str) -> Answer:
    """Run all configurations of one training with one device."""
    with warnings.catch_warnings(action="ignore"):
        drawn = campaign.draw(seed, trained)
        chosen = [setting for setting in campaign.settings() if setting.trained == trained]
        return seed, *campaign.run(drawn, chosen), campaign.warmth(drawn) if trained == "spring" else {}


def measure(seeds: range, processes: int) -> campaign.Record:
    """Draw devices and run everything, with a progress bar."""
    jobs = list(product(seeds, campaign.TRAINED))
    columns = (TextColumn("{task.description}"), BarColumn(), MofNCompleteColumn(), TimeRemainingColumn())
    with Progress(*columns, console=Console(stderr=True)) as progress, ProcessPoolExecutor(processes) as pool:
        running = [pool.submit(one, *job) for job in jobs]
        done = progress.track(as_completed(running), len(jobs), description="devices and trainings")
        return {"seed": seeds[0], **summarize([job.result() for job in done])}


def main(
    devices: Annotated[int, typer.Option(help="Drawn devices, each with its own weather.")] = 20,
    processes: Annotated[int, typer.Option(help="Processes at once, one thread each.")] = 2,
    seed: Annotated[int | None, typer.Option(help="Default: a fresh one.")] = None,
    write: Annotated[bool, typer.Option("--write", help="Write figures.json, page and figure.")] = False,
    draw: Annotated[bool, typer.Option("--draw", help="Only page and figure, from figures.json.")] = False,
) -> None:
    """Draw, run and report."""
    if not draw:
        chosen = int(np.random.SeedSequence().generate_state(1)[0]) % 2**31 if seed is None else seed
        results = measure(range(chosen, chosen + devices), processes)
        print(page.methods(results))
        if write:
            page.save(results)
    if write or draw:
        page.write()


if __name__ == "__main__":
    typer.run(main)
