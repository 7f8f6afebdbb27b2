"""Measure every case side by side and write results.json and docs/speed.md.

The machine may be busy: the cases take turns, the best time of each is kept, and only ratios
within one run are quoted.
"""

import json
import os
import platform
from collections.abc import Mapping
from pathlib import Path
from timeit import Timer

import numpy as np
import render
from cases import calls, columns

from echocal import _core

HERE = Path(__file__).parent
ROWS = 4_000_000


def best(timers: Mapping[str, Timer], turns: int, repeat: int) -> dict[str, list[float]]:
    """Seconds a call in each turn, by case; `repeat` calls are timed together."""
    times: dict[str, list[float]] = {name: [] for name in timers}
    for timer in timers.values():
        timer.timeit(1)
    for _ in range(turns):
        for name, timer in timers.items():
            times[name].append(timer.timeit(repeat) / repeat)
    return times


def processor() -> str:
    """Model of the processor, where the system tells it."""
    info = Path("/proc/cpuinfo")
    lines = info.read_text().splitlines() if info.exists() else []
    models = [line.split(":", 1)[1].strip() for line in lines if line.startswith("model name")]
    return models[0] if models else platform.processor()


def main() -> None:
    """Measure and write."""
    load = os.getloadavg()[0]
    results: dict[str, dict[str, float]] = {}
    noise = 0.0
    for kind in (np.float64, np.float32):
        timers = {name: Timer(case) for name, case in columns(ROWS, kind).items()}
        times = best(timers, turns=15, repeat=1)
        results[kind.__name__] = {name: round(min(t) * 1e9 / ROWS, 3) for name, t in times.items()}
        roof = times["memory of five, 1 thread"]
        noise = max(noise, float(np.median(roof)) / min(roof) - 1)
    statements, names = calls()
    short = {name: Timer(statement, globals=names) for name, statement in statements.items()}
    single = {name: round(min(t) * 1e9, 1) for name, t in best(short, turns=200, repeat=200).items()}
    document = {
        "machine": {
            "processor": processor(),
            "logical_processors": os.cpu_count(),
            "instruction_set": _core.instruction_sets()[-1],
            "load_before": round(load, 1),
            "noise": round(noise, 3),
        },
        "rows": ROWS,
        "ns_per_row": results,
        "ns_per_call": single,
    }
    (HERE / "results.json").write_text(json.dumps(document, indent=1) + "\n")
    (HERE.parent / "docs" / "speed.md").write_text(render.page(document))


if __name__ == "__main__":
    main()
