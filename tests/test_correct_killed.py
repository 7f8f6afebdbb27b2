"""A run that is killed at a random moment, and run again: the same files, no stray, no duplicate."""

import multiprocessing
import os
import signal
import threading
import time
from pathlib import Path

import numpy as np
import pytest
from killed import (
    FILES,
    await_end,
    await_files,
    begin,
    check_partial,
    check_whole,
    contents,
    correct,
    make_logs,
    model,
    quick,
)

from echocal.correct import correct_files
from echocal.engines.processes import Processes

pytestmark = pytest.mark.slow

ROWS = 80_000


@pytest.fixture
def logs(tmp_path: Path, random: np.random.Generator) -> Path:
    return make_logs(tmp_path / "in", random, ROWS)


@pytest.fixture
def whole(logs: Path, tmp_path: Path) -> dict[str, bytes]:
    """The outputs of a run that nothing stops."""
    assert not correct_files(logs, tmp_path / "whole", model()).set_aside
    return contents(tmp_path / "whole")


def durations(logs: Path, out: Path, engine: str, workers: int) -> tuple[float, float]:
    """Time until the first file is done, and from then until all are [s]."""
    run = begin(correct, logs, out, engine, workers)
    taken = await_files(out, 1), await_files(out, FILES)
    run.join()
    assert run.exitcode == 0
    return taken


@pytest.mark.parametrize(
    ("engine", "workers", "moments"),
    [("local", 1, 20), ("local", 2, 20), ("dask-local", 2, 10)],
    ids=["alone", "processes", "dask-local"],
)
def test_the_driver(
    engine: str,
    workers: int,
    moments: int,
    logs: Path,
    whole: dict[str, bytes],
    tmp_path: Path,
    random: np.random.Generator,
) -> None:
    """Killed, not its workers, and run again while they may be alive.

    Every other moment is drawn from the whole run, the others from the time in which files are written. A
    third of the runs is begun in what a killed one has left, and killed, too.
    """
    if engine == "dask-local":
        pytest.importorskip("distributed")
    partial, folders = 0, 0
    first, others = durations(logs, tmp_path / "timed", engine, workers)
    for number in range(moments):
        out, written = tmp_path / f"out {folders}", number % 2
        run = begin(correct, logs, out, engine, workers)
        if written:
            await_files(out, 1)
        time.sleep(float(random.uniform(0.0, others if written else first + others)))
        run.kill()
        run.join()
        check_partial(out, whole)
        if number % 3 == 1 and number + 1 < moments:
            continue
        folders += 1
        again = correct_files(logs, out, model())
        partial += 0 < again.skipped < FILES
        await_end(run.pid)
        check_partial(out, whole)
        last = correct_files(logs, out, model())
        check_whole(out, whole, last, ROWS)
        assert last.skipped == FILES, "a worker replaced an output after its run"
    print(f"{moments} moments, {folders} outputs; {partial} times a part was done")


@pytest.mark.parametrize("every", [False, True], ids=["one", "all"])
def test_workers(
    every: bool,
    logs: Path,
    whole: dict[str, bytes],
    tmp_path: Path,
    random: np.random.Generator,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """At the start, or after the first file is done. They begin quickly, so many moments can be tried."""
    monkeypatch.setattr("echocal.engines.worker.multiprocessing.get_context", lambda method: quick)
    lost = 0
    for number in range(20):
        out, started = tmp_path / f"out {number}", number % 2
        dead: list[int] = []
        killer = Killer(every, out if started else None, float(random.uniform(0.0, 0.2)), dead)
        killer.start()
        check_whole(out, whole, correct_files(logs, out, model(), engine=Processes(2)), ROWS)
        killer.join(40)
        lost += bool(dead)
        assert correct_files(logs, out, model()).skipped == FILES
    print(f"{lost} of 20 moments found workers")
    assert lost > 4, "few moments found a worker"


class Killer(threading.Thread):
    """Kills workers of this process some time after they start, or after the first file in `out` is done."""

    def __init__(self, every: bool, out: Path | None, moment: float, dead: list[int]) -> None:
        super().__init__(daemon=True)
        self._every, self._out, self._moment, self._dead = every, out, moment, dead

    def run(self) -> None:
        while not multiprocessing.active_children():
            time.sleep(0.002)
        if self._out is not None:
            await_files(self._out, 1)
        time.sleep(self._moment)
        children = multiprocessing.active_children()
        for child in children if self._every else children[:1]:
            self._dead.append(int(child.pid or 0))
            os.kill(self._dead[-1], signal.SIGKILL)
