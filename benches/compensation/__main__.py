"""Which euro and which method buy how many millimeters: docs/compensation.md.

``python benches/compensation --write`` draws devices and weather, writes figures.json, and makes page and
figure anew; without ``--write`` it prints a table only. A quarter of an hour of one processor.
"""

import json
import os
import sys
from collections import Counter
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
from compensation.campaign import Record, Setting  # noqa: E402

_RESAMPLED = 4000
_FITTED = {"fixed_delay", "clock_error"}  # by `calibrate`, before the diagnosis
_BASELINE = Setting(campaign.BEST, method="line").key


Job = tuple[int, str, tuple[str, ...]]
Answer = tuple[Record, Record, Record]


def one(job: Job) -> Answer:
    """Run configurations of one training with one device."""
    seed, trained, keys = job
    chosen = [setting for setting in campaign.settings() if setting.key in keys]
    with warnings.catch_warnings(action="ignore"):
        drawn = campaign.draw(seed, trained)
        return *campaign.run(drawn, chosen), campaign.warmth(drawn) if trained == "spring" else {}


def summarize(found: list[tuple[int, Record, Record, Record]]) -> Record:
    """Means over devices with bootstrap intervals, wins against a line through all marks, named causes."""
    devices: dict[int, Record] = {}
    causes: Record = {}
    warmth = list({seed: warm for seed, *_, warm in found if warm}.values())
    for seed, record, named, _ in found:
        devices.setdefault(seed, {}).update(record)
        for key, effects in named.items():
            added = set(effects) - (_FITTED if "/both/" in key else set())
            causes.setdefault(key, Counter()).update(added or [campaign.NOTHING])
    runs = [devices[seed] for seed in sorted(devices)]
    figures = {key: _figures([run[key] for run in runs]) for key in runs[0]}
    wins = {key: _wins([run[key] for run in runs], [run[_BASELINE] for run in runs]) for key in runs[0]}
    kelvin = {
        name: {test: _short(np.mean([one[name][test] for one in warmth]) ** 0.5) for test in campaign.TESTED}
        for name in warmth[0]
    }
    each = {key: sorted(_short(_elsewhere(run[key])) for run in runs) for key in runs[0]}
    further = {"wins": wins, "each": each, "causes": causes, "kelvin": kelvin}
    return {"devices": len(runs), "figures": figures, **further}


def _short(number: float) -> float:
    return float(f"{number:.4g}")


def _figures(runs: list[Record]) -> Record:
    tests = {name: [run[name] for run in runs] for name in campaign.TESTED}
    summary = {name: {band: _means([r[band] for r in own]) for band in own[0]} for name, own in tests.items()}
    both = [[(run["summer"][band], run["winter"][band]) for run in runs] for band in runs[0]["summer"]]
    summary["other"] = {
        band: _means([{name: (a[name] + b[name]) / 2 for name in a} for a, b in pairs])
        for band, pairs in zip(runs[0]["summer"], both, strict=True)
    }
    return summary


def _means(values: list[Record]) -> Record:
    """RMS [mm], 95 % quantile [mm] and share within 3 mm, each with its interval of 95 %."""
    rows = np.random.default_rng(0).integers(0, len(values), (_RESAMPLED, len(values)))
    found: Record = {}
    for name, shown in {
        "mean_square": "rms",
        "high": "high",
        "within": "within",
        "missing": "missing",
    }.items():
        own = np.array([value[name] for value in values])
        power = 0.5 if name == "mean_square" else 1.0
        drawn = np.quantile(own[rows].mean(axis=1) ** power, [0.025, 0.975])
        found[shown] = [_short(number) for number in (own.mean() ** power, *drawn)]
    return found


def _elsewhere(run: Record) -> float:
    """RMS in other weather [mm]."""
    return float((run["summer"]["all"]["mean_square"] + run["winter"]["all"]["mean_square"]) / 2) ** 0.5


def _wins(runs: list[Record], baseline: list[Record]) -> int:
    """Of how many devices the error in other weather is lower than with the line."""
    return sum(_elsewhere(run) < _elsewhere(other) for run, other in zip(runs, baseline, strict=True))


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


def _missing(seeds: range, found: list[tuple[int, Record, Record, Record]]) -> Iterator[Job]:
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
