"""Time a diagnosis stage by stage and write diagnose_speed.json and docs/diagnose-speed.md.

The table: four stations, a temperature that follows the day, humidity and time; a fixed delay and
humid air that a linear law knows nothing of. The whole catalogue competes, on two processors. Of
several runs the fastest is told; the first one, which also imports, is not among them. The stations
take turns from row to row; once more, for a million rows, each has a quarter of the table.
"""

import json
import os
import warnings
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path
from time import perf_counter
from types import SimpleNamespace
from typing import Any
from unittest.mock import patch

import diagnose_speed_page
import numpy as np
from measure import processor

import echocal
from echocal import _core
from echocal.diagnose import engine, pipeline
from echocal.diagnose.candidates.columns import Columns
from echocal.diagnose.inference import case, examine, posterior
from echocal.diagnose.results import report

HERE = Path(__file__).parent
RUNS = {1_000: 9, 100_000: 5, 1_000_000: 3}
PROCESSORS = 2

STAGES: tuple[tuple[Any, str, str], ...] = (
    (engine, "read", "reading"),
    (pipeline, "find_faults", "faults"),
    (pipeline, "prepare", "usable rows, stations, series"),
    (examine, "effect_candidates", "where steps and edges may lie"),
    (examine, "term_candidates", "smooth functions"),
    (Columns, "products", "columns and their products"),
    (case.Case, "stack", "whitening"),
    (_core, "posterior", "hypotheses"),
    (pipeline, "infer_noises", "noises with a likelihood of their own"),
    (pipeline, "validate", "held-out rows"),
    (pipeline, "propose", "next measurements"),
    (report, "notes", "notes"),
    (report, "_cause", "sentences"),
    (report, "_traces", "traces"),
)


def table(rows: int, one_by_one: bool = False) -> dict[str, np.ndarray]:
    """A table like a week at four stations, which take turns or are measured one by one."""
    random = np.random.default_rng(1)
    temperature = 20 + 8 * np.sin(np.arange(rows) * 2 * np.pi / 288)
    distance = np.resize([0.5, 1.0, 2.0, 3.0], rows)
    distance = np.sort(distance) if one_by_one else distance
    humidity = random.uniform(0.3, 0.7, rows)
    echo = 2 * distance / echocal.speed_of_sound(temperature, humidity)
    return {
        "echo_s": echo + 30e-6 + random.normal(0, 6e-6, rows),
        "temperature_C": temperature,
        "distance_m": distance,
        "humidity_percent": 100 * humidity,
        "time_s": np.arange(rows) * 300.0,
    }


class Clock:
    """Seconds by stage; what a stage calls is its own time."""

    def __init__(self) -> None:
        self.seconds = {stage: 0.0 for *_, stage in STAGES}
        self.systems = 0
        self._inside = False

    def timed(self, stage: str, call: Callable[..., Any]) -> Callable[..., Any]:
        """The same call, on the clock."""

        def run(*given: Any, **named: Any) -> Any:
            if self._inside:
                return call(*given, **named)
            self._inside, start = True, perf_counter()
            try:
                return call(*given, **named)
            finally:
                self.seconds[stage] += perf_counter() - start
                self._inside = False

        return run

    def posterior(self, *given: Any) -> Any:
        """Search, and keep the number of systems solved."""
        result = _posterior(*given)
        self.systems = result.systems
        return result


_posterior = _core.posterior


@contextmanager
def on_the_clock(clock: Clock) -> Iterator[None]:
    """Put every stage on a clock."""
    with ExitStack() as stack:
        for owner, name, stage in STAGES:
            call = clock.posterior if owner is _core else getattr(owner, name)
            timed = clock.timed(stage, call)
            if owner is _core:  # a compiled module: what the caller sees of it is replaced
                proxy = SimpleNamespace(**{**vars(_core), "posterior": timed})
                stack.enter_context(patch.object(posterior, "_core", proxy))
            else:
                stack.enter_context(patch.object(owner, name, timed))
        yield


def measured(rows: int, one_by_one: bool = False) -> dict[str, Any]:
    """Seconds of the fastest run, whole and by stage."""
    given, best = table(rows, one_by_one), None
    echocal.diagnose(given)
    for _ in range(RUNS[rows]):
        clock = Clock()
        with on_the_clock(clock):
            start = perf_counter()
            found = echocal.diagnose(given)
            total = perf_counter() - start
        if best is None or total < best["total"]:
            stages = {name: round(seconds, 6) for name, seconds in clock.seconds.items()}
            best = {"total": round(total, 6), "stages": stages, "systems": clock.systems}
            best["causes"] = [cause.id for cause in found.causes]
    assert best is not None
    return best


def main() -> None:
    """Measure and write."""
    warnings.simplefilter("ignore")
    load = os.getloadavg()[0]
    if hasattr(os, "sched_setaffinity"):
        os.sched_setaffinity(0, sorted(os.sched_getaffinity(0))[:PROCESSORS])
    document = {
        "machine": {
            "processor": processor(),
            "logical_processors": os.cpu_count(),
            "load_before": round(load, 1),
        },
        "rows": {str(rows): measured(rows) for rows in RUNS},
        "one_by_one": measured(max(RUNS), one_by_one=True),
    }
    (HERE / "diagnose_speed.json").write_text(json.dumps(document, indent=1) + "\n")
    page = HERE.parent / "docs" / "diagnose-speed.md"
    page.write_text(diagnose_speed_page.page(document))


if __name__ == "__main__":
    main()
