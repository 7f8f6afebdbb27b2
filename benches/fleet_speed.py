"""Time the diagnosis of a fleet: sensors drawn anew, two processes with one processor each.

python benches/fleet_speed.py                   # 1,000 sensors of 1,000 and of 3,000 rows
python benches/fleet_speed.py --sensors 50      # a sample

A third of the sensors look at a target that does not move, with an unknown distance; the others at stations
or at any distance. A third have nothing wrong with them.
"""

import os
import warnings
from collections.abc import Iterator
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import current_process
from time import perf_counter, process_time
from typing import Annotated

for library in ("OMP", "OPENBLAS", "RAYON"):  # before numpy: a process of ours is one thread
    os.environ.setdefault(f"{library}_NUM_THREADS", "1")

import numpy as np  # noqa: E402
import typer  # noqa: E402

import echocal  # noqa: E402

ROWS = {1_000: 45.0, 3_000: 70.0}  # with the time that 1,000 sensors may take [s]
PROCESSES = 2
CAUSES = ("nothing", "nothing", "fixed_delay", "temperature_offset", "drift", "cycle_slip")
SCENES = ("constant", "stations", "any distance")

Table = dict[str, np.ndarray]


def sensor(rows: int, seed: int) -> tuple[Table, bool]:
    """A log of one sensor, and whether its distance is constant and unknown."""
    random = np.random.default_rng(seed)
    cause, scene = CAUSES[seed % len(CAUSES)], SCENES[seed // len(CAUSES) % len(SCENES)]
    time = np.arange(rows) * 600.0
    day = np.sin(2 * np.pi * (time / 86400 + random.uniform()))
    temperature = random.uniform(5, 20) + 7 * day + random.normal(0, 0.2, rows)
    humidity = np.clip(0.6 - 0.2 * day + random.normal(0, 0.03, rows), 0.05, 1.0)
    distance = {
        "constant": np.full(rows, random.uniform(0.5, 3.5)),
        "stations": np.repeat(np.linspace(0.5, 3.5, 6), -(-rows // 6))[:rows],
        "any distance": random.uniform(0.4, 3.9, rows),
    }[scene]
    air = temperature + (random.uniform(1, 3) if cause == "temperature_offset" else 0.0)
    true = distance + (random.uniform(5e-3, 20e-3) * time / time[-1] if cause == "drift" else 0.0)
    echo = 2 * true / echocal.speed_of_sound(air, humidity) + random.normal(0, 6e-6, rows)
    echo += random.uniform(15e-6, 60e-6) if cause == "fixed_delay" else 0.0
    echo += 25e-6 * (random.random(rows) < 0.1) if cause == "cycle_slip" else 0.0
    table = {
        "echo_s": echo,
        "temperature_C": temperature,
        "humidity_percent": 100 * humidity,
        "time_s": time,
    }
    constant = scene == "constant"
    return table if constant else {**table, "distance_m": distance}, constant


def diagnosed(given: tuple[int, int]) -> tuple[str, float]:
    """Verdict on one sensor, and the seconds of a processor that it took."""
    table, constant = sensor(*given)
    start = process_time()
    found = echocal.diagnose(table, base="cramer", constant_distance=constant)
    return found.verdict, process_time() - start


def one_processor() -> None:
    """Give a process its own processor, and diagnose once: imports are no part of the time."""
    warnings.simplefilter("ignore")
    if hasattr(os, "sched_setaffinity"):
        own = sorted(os.sched_getaffinity(0))
        os.sched_setaffinity(0, {own[current_process()._identity[-1] % len(own)]})
    diagnosed((200, 0))


def timed(rows: int, seeds: range) -> Iterator[str]:
    """Lines on a fleet."""
    with ProcessPoolExecutor(PROCESSES, initializer=one_processor) as pool:
        list(pool.map(diagnosed, [(200, seed) for seed in seeds[:PROCESSES]]))
        start = perf_counter()
        found = list(pool.map(diagnosed, [(rows, seed) for seed in seeds], chunksize=5))
        whole = perf_counter() - start
    each = [seconds for _, seconds in found]
    yield f"{len(seeds):,} sensors of {rows:,} rows: {whole:.1f} s, {1e3 * whole / len(seeds):.0f} ms each"
    yield (
        f"  goal {ROWS[rows] * len(seeds) / 1000:.1f} s; "
        f"processor time of a diagnosis {1e3 * np.mean(each):.0f} ms "
        f"(median {1e3 * np.median(each):.0f} ms, 95 % in {1e3 * np.quantile(each, 0.95):.0f} ms)"
    )
    words = [word for word, _ in found]
    yield "  " + ", ".join(f"{words.count(word)} {word}" for word in sorted(set(words)))


def main(
    sensors: Annotated[int, typer.Option(help="Sensors of each fleet.")] = 1_000,
    seed: Annotated[int | None, typer.Option(help="Seed of the first one; default: a fresh one.")] = None,
) -> None:
    """Diagnose fleets and tell how long it took."""
    first = int.from_bytes(os.urandom(4), "little") if seed is None else seed
    print(f"seed {first}")
    for rows in ROWS:
        for line in timed(rows, range(first, first + sensors)):
            print(line, flush=True)


if __name__ == "__main__":
    typer.run(main)
