"""Measure every case side by side and write results.json and docs/speed.md.

The machine may be busy: the cases take turns, the best time of each is kept, and only ratios within one run
are quoted. Of one thread the processor time counts, of several the time that passes.
"""

import json
import os
import platform
from collections.abc import Mapping
from pathlib import Path
from time import perf_counter, process_time
from timeit import Timer

import numpy as np
import render
from cases import IN_CACHE, LARGE, Case, calls, instruction_sets, models, ours, rivals

from echocal import _core

HERE = Path(__file__).parent
MODEL_ROWS = 100_000
TOGETHER = 20_000  # rows that are timed together, at least


def best(cases: Mapping[str, Case], rows: int, turns: int) -> dict[str, list[float]]:
    """Seconds a row in each turn, by case."""
    repeat = max(1, TOGETHER // rows)
    times: dict[str, list[float]] = {name: [] for name in cases}
    for turn in range(turns + 1):
        for name, case in cases.items():
            _core.set_instruction_set(case.instruction_set)
            clock = process_time if case.threads == 1 else perf_counter
            start = clock()
            for _ in range(repeat):
                case.run()
            elapsed = clock() - start
            if turn:  # the first one warms up
                times[name].append(elapsed / repeat / rows)
    _core.set_instruction_set(None)
    return times


def nanoseconds(times: Mapping[str, list[float]]) -> dict[str, float]:
    """The shortest time of each case [ns]."""
    return {name: round(min(each) * 1e9, 4) for name, each in times.items()}


def short_calls() -> dict[str, float]:
    """Calls with little data [ns]."""
    statements, names = calls()
    timers = {
        name: Timer(statement, timer=process_time, globals=names) for name, statement in statements.items()
    }
    times: dict[str, list[float]] = {name: [] for name in timers}
    for _ in range(300):
        for name, timer in timers.items():
            times[name].append(timer.timeit(100) / 100)
    return {name: round(min(each) * 1e9, 1) for name, each in times.items()}


def processor() -> str:
    """Model of the processor, where the system tells it."""
    info = Path("/proc/cpuinfo")
    lines = info.read_text().splitlines() if info.exists() else []
    models = [line.split(":", 1)[1].strip() for line in lines if line.startswith("model name")]
    return models[0] if models else platform.processor()


def main() -> None:
    """Measure and write."""
    load = os.getloadavg()[0]
    large: dict[str, dict[str, float]] = {}
    cached: dict[str, dict[str, dict[str, float]]] = {}
    noise = 0.0
    for kind in (np.float64, np.float32):
        times = best(ours(LARGE, kind, (1, 2)), LARGE, turns=40)
        roof = times["memory of five, 1 thread"]
        noise = max(noise, float(np.median(roof)) / min(roof) - 1)
        large[kind.__name__] = nanoseconds(times) | nanoseconds(best(rivals(LARGE, kind), LARGE, turns=3))
        cached[kind.__name__] = {
            str(rows): nanoseconds(best(ours(rows, kind, (1,)), rows, turns=200)) for rows in IN_CACHE
        }
    document = {
        "machine": {
            "processor": processor(),
            "logical_processors": os.cpu_count(),
            "instruction_sets": instruction_sets(),
            "load_before": round(load, 1),
            "noise": round(noise, 3),
        },
        "rows": LARGE,
        "ns_per_row": large,
        "ns_per_row_in_cache": cached,
        "model_rows": MODEL_ROWS,
        "ns_per_row_of_models": nanoseconds(best(models(MODEL_ROWS), MODEL_ROWS, turns=40)),
        "ns_per_call": short_calls(),
    }
    (HERE / "results.json").write_text(json.dumps(document, indent=1) + "\n")
    (HERE.parent / "docs" / "speed.md").write_text(render.page(document))


if __name__ == "__main__":
    main()
