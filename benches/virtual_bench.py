"""Measure how many readings a second the virtual bench makes; `--write` puts them into docs/virtual-bench.md.

The machine may be busy. One core: readings by the time that the processor spent on them. Two processes: by
the time that passed, which is what a user waits. The best of several turns counts.
"""

import re
import sys
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path
from time import perf_counter, process_time

import numpy as np
from measure import processor

from echocal.virtual_bench import Scene, Sensor, Target, measure

PAGE = Path(__file__).resolve().parents[1] / "docs" / "virtual-bench.md"
READINGS, TURNS = 40_000, 7
CASES = ("a wall", "a tilted plate over a floor", "noise near the threshold", "an own temperature each")


def scene_of(case: str, random: np.random.Generator) -> tuple[Scene, Sensor]:
    """Scene and sensor of a case; distances from 0.1 to 3.5 m."""
    distance = random.uniform(0.1, 3.5, READINGS)
    tilt = random.normal(0.0, 0.05, READINGS)
    if case == "a tilted plate over a floor":
        return Scene(distance, target=Target(tilt=tilt, half_width=0.1), floor=0.3), Sensor()
    if case == "noise near the threshold":
        return Scene(distance, target=Target(tilt=tilt)), Sensor(noise=0.3 * Sensor().comparator.threshold)
    if case == "an own temperature each":
        return Scene(distance, temperature=random.uniform(0, 40, READINGS)), Sensor()
    return Scene(distance), Sensor()


def processor_time(case: str) -> float:
    """Time of the processor [s] that the readings of a case take."""
    random = np.random.default_rng(1)
    scene, sensor = scene_of(case, random)
    start = process_time()
    measure(scene, sensor, random, threads=1)
    return process_time() - start


def rates(case: str, pool: ProcessPoolExecutor) -> tuple[float, float]:
    """Readings a second and core, and with two processes."""
    alone = min(processor_time(case) for _ in range(TURNS))
    passed = []
    for _ in range(TURNS):
        start = perf_counter()
        list(pool.map(processor_time, [case, case]))
        passed.append(perf_counter() - start)
    return READINGS / alone, 2 * READINGS / min(passed)


def table() -> str:
    """Rows of all cases."""
    lines = ["| readings of | a second of one core | a second, two processes |", "|---|---:|---:|"]
    with ProcessPoolExecutor(2) as pool:
        list(pool.map(processor_time, CASES[:1] * 2))  # imports are paid
        for case in CASES:
            one, two = rates(case, pool)
            lines.append(f"| {case} | {one:,.0f} | {two:,.0f} |")
    made = f"`python benches/virtual_bench.py --write`: {READINGS:,} readings, best of {TURNS} turns"
    return f"{made},\n{processor()}.\n\n" + "\n".join(lines) + "\n"


if __name__ == "__main__":
    fresh = table()
    if "--write" in sys.argv:
        text = PAGE.read_text(encoding="utf-8")
        marked = r"(<!-- speed -->\n).*?(<!-- /speed -->)"
        PAGE.write_text(re.sub(marked, rf"\1\n{fresh}\n\2", text, flags=re.DOTALL), encoding="utf-8")
    print(fresh)
