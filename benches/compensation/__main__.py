"""Which euro and which method buy how many millimeters: docs/compensation.md.

``python benches/compensation --write`` draws devices and weather, writes figures.json, and makes page and
figure anew; without ``--write`` it prints a table only. Half an hour on one processor.
"""

import os
import sys
from collections import Counter
from concurrent.futures import ProcessPoolExecutor, as_completed
from pathlib import Path
from typing import Annotated

for library in ("OMP", "OPENBLAS", "RAYON"):  # before numpy: a process of ours is one thread
    os.environ.setdefault(f"{library}_NUM_THREADS", "1")
sys.path.insert(0, str(Path(__file__).parent))

import warnings  # noqa: E402

import campaign  # noqa: E402
import numpy as np  # noqa: E402
import page  # noqa: E402
import typer  # noqa: E402
from campaign import Record, Setting  # noqa: E402
from rich.console import Console  # noqa: E402
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn  # noqa: E402

_RESAMPLED = 4000
_BASELINE = Setting(campaign.BEST, method="line").key


def one(job: tuple[int, str]) -> tuple[int, Record, Record, Record]:
    """Run all configurations of one training with one device."""
    seed, trained = job
    chosen = [setting for setting in campaign.settings() if setting.trained == trained]
    with warnings.catch_warnings(action="ignore"):
        drawn = campaign.draw(seed, trained)
        return seed, *campaign.run(drawn, chosen), campaign.warmth(drawn) if trained == "spring" else {}


def summarize(found: list[tuple[int, Record, Record, Record]]) -> Record:
    """Means over devices with bootstrap intervals, wins against a line through all marks, named causes."""
    devices: dict[int, Record] = {}
    causes: Record = {}
    warmth = [warm for *_, warm in found if warm]
    for seed, record, named, _ in found:
        devices.setdefault(seed, {}).update(record)
        for key, effects in named.items():
            causes.setdefault(key, Counter()).update([*effects, "models"])
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


def measure(devices: int, processes: int, seed: int) -> Record:
    """Draw devices and run everything, with a progress bar."""
    jobs = [(seed + device, trained) for device in range(devices) for trained in campaign.TRAINED]
    columns = (TextColumn("{task.description}"), BarColumn(), MofNCompleteColumn(), TimeRemainingColumn())
    found = []
    with Progress(*columns, console=Console(stderr=True)) as progress, ProcessPoolExecutor(processes) as pool:
        bar = progress.add_task("devices and trainings", total=len(jobs))
        for done in as_completed([pool.submit(one, job) for job in jobs]):
            found.append(done.result())
            progress.advance(bar)
    return {"seed": seed, **summarize(found)}


def main(
    devices: Annotated[int, typer.Option(help="Drawn devices, each with its own weather.")] = 24,
    processes: Annotated[int, typer.Option(help="Processes at once, one thread each.")] = 2,
    seed: Annotated[int | None, typer.Option(help="Default: a fresh one.")] = None,
    write: Annotated[bool, typer.Option("--write", help="Write figures.json, page and figure.")] = False,
    draw: Annotated[bool, typer.Option("--draw", help="Only page and figure, from figures.json.")] = False,
) -> None:
    """Draw, run and report."""
    if not draw:
        chosen = int(np.random.SeedSequence().generate_state(1)[0]) % 2**31 if seed is None else seed
        results = measure(devices, processes, chosen)
        print(page.methods(results))
        if write:
            page.save(results)
    if write or draw:
        page.write()


if __name__ == "__main__":
    typer.run(main)
