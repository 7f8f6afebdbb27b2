"""What the parts of the benchmark share: processes, a progress bar, intervals, files."""

import json
import os
import sys
from collections.abc import Callable, Sequence
from concurrent.futures import ProcessPoolExecutor, as_completed
from pathlib import Path
from typing import Any

for library in ("OMP", "OPENBLAS", "RAYON"):  # before numpy: a process of ours is one thread
    os.environ.setdefault(f"{library}_NUM_THREADS", "1")

from rich.console import Console  # noqa: E402
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn  # noqa: E402
from scipy.stats import binomtest  # noqa: E402

ROOT = Path(__file__).parents[2]
HERE = Path(__file__).parent
sys.path.insert(0, str(ROOT / "tests"))

SURE = 0.9
"""Probability above which a name is a promise."""

LIKELY = 0.5
"""Probability from which on a cause is counted as found at all."""

Record = dict[str, Any]


def run(tasks: Sequence[Any], work: Callable[[Any], Any], label: str, processes: int) -> list[Any]:
    """Results of all tasks, in their order."""
    columns = (TextColumn("{task.description}"), BarColumn(), MofNCompleteColumn(), TimeRemainingColumn())
    results: list[Any] = [None] * len(tasks)
    with Progress(*columns, console=Console(stderr=True)) as progress:
        bar = progress.add_task(label, total=len(tasks))
        if processes < 2:
            for i, task in enumerate(tasks):
                results[i] = work(task)
                progress.advance(bar)
            return results
        with ProcessPoolExecutor(processes) as pool:
            waiting = {pool.submit(work, task): i for i, task in enumerate(tasks)}
            for done in as_completed(waiting):
                results[waiting[done]] = done.result()
                progress.advance(bar)
    return results


def share(hits: int, count: int) -> Record | None:
    """A proportion with Wilson's interval, 95 %."""
    if not count:
        return None
    interval = binomtest(hits, count).proportion_ci(method="wilson")
    return {
        "value": hits / count,
        "low": float(interval.low),
        "high": float(interval.high),
        "hits": hits,
        "count": count,
    }


def told(causes: Sequence[Record]) -> list[Record]:
    """Effects that a diagnosis names: more probable than 0.9, in the model, without a doubt."""
    return [
        cause
        for cause in causes
        if cause["kind"] == "effect"
        and cause["in_model"]
        and cause["probability"] > SURE
        and not cause["doubt"]
    ]


def save(name: str, record: Record) -> Path:
    """Write the figures of a part beside its script."""
    path = HERE / f"{name}.json"
    path.write_text(json.dumps(record, indent=1) + "\n", encoding="utf-8")
    return path


def text(figure: Record | None) -> str:
    """A proportion for a table."""
    if figure is None:
        return "-"
    return f"{figure['value']:.3f} ({figure['low']:.3f} to {figure['high']:.3f}; {figure['count']})"
