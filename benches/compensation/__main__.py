"""Which euro and which method buy how many millimeters: docs/compensation.md.

``python benches/compensation --write`` draws devices and weather, writes figures.json, and makes page and
figure anew; without ``--write`` it prints a table only. A quarter of an hour of one processor.
"""

import json
import os
import sys
from collections.abc import Iterator
from concurrent.futures import ProcessPoolExecutor, as_completed
from pathlib import Path
from typing import Annotated

for library in ("OMP", "OPENBLAS", "RAYON"):  # before numpy: a process of ours is one thread
    os.environ.setdefault(f"{library}_NUM_THREADS", "1")
sys.path.insert(0, str(Path(__file__).parents[1]))

import warnings  # noqa: E402

import numpy as np  # noqa: E402
import typer  # noqa: E402
from rich.console import Console  # noqa: E402
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn  # noqa: E402

from compensation import (  # noqa: E402
    campaign,
    page,
)
from compensation.campaign import Record  # noqa: E402
from compensation.summary import Answer, summarize  # noqa: E402

Job = tuple[int, str, tuple[str, ...]]


def one(job: Job) -> tuple[Record, Record, Record]:
    """Run configurations of one training with one device."""
    seed, trained, keys = job
    chosen = [setting for setting in campaign.settings() if setting.key in keys]
    with warnings.catch_warnings(action="ignore"):
        drawn = campaign.draw(seed, trained)
        return *campaign.run(drawn, chosen), campaign.warmth(drawn) if trained == "spring" else {}


def measure(devices: int, processes: int, seed: int, kept: Path | None) -> Record:
    """Draw devices and run everything, with a progress bar; what the file has already is not run again."""
    lines = kept.read_text(encoding="utf-8").splitlines() if kept and kept.exists() else []
    found = [(seed, *answer) for seed, *answer in map(json.loads, lines)]
    jobs = list(_missing(range(seed, seed + devices), found))
    columns = (TextColumn("{task.description}"), BarColumn(), MofNCompleteColumn(), TimeRemainingColumn())
    with Progress(*columns, console=Console(stderr=True)) as progress, ProcessPoolExecutor(processes) as pool:
        bar = progress.add_task("devices and trainings", total=len(jobs))
        waiting = {pool.submit(one, job): job[0] for job in jobs}
        for done in as_completed(waiting):
            found.append((waiting[done], *done.result()))
            if kept:
                with kept.open("a", encoding="utf-8") as file:
                    file.write(json.dumps(found[-1]) + "\n")
            progress.advance(bar)
    return {"seed": seed, **summarize([one for one in found if seed <= one[0] < seed + devices])}


def _missing(seeds: range, found: list[Answer]) -> Iterator[Job]:
    """List what has not been run."""
    for seed in seeds:
        done = {key for own, record, *_ in found if own == seed for key in record}
        for trained in campaign.TRAINED:
            keys = [one.key for one in campaign.settings() if one.trained == trained and one.key not in done]
            if keys:
                yield seed, trained, tuple(keys)


def main(
    devices: Annotated[int, typer.Option(help="Drawn devices, each with its own weather.")] = 20,
    processes: Annotated[int, typer.Option(help="Processes at once, one thread each.")] = 2,
    seed: Annotated[int | None, typer.Option(help="Default: a fresh one.")] = None,
    keep: Annotated[Path | None, typer.Option(help="Add each answer to this file, to go on later.")] = None,
    write: Annotated[bool, typer.Option("--write", help="Write figures.json, page and figure.")] = False,
    draw: Annotated[bool, typer.Option("--draw", help="Only page and figure, from figures.json.")] = False,
) -> None:
    """Draw, run and report."""
    if not draw:
        chosen = int(np.random.SeedSequence().generate_state(1)[0]) % 2**31 if seed is None else seed
        results = measure(devices, processes, chosen, keep)
        print(page.methods(results))
        if write:
            page.save(results)
    if write or draw:
        page.write()


if __name__ == "__main__":
    typer.run(main)
