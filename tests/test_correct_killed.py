"""A run that is killed at a random moment, and run again: the same files, no stray, no duplicate."""

import json
import multiprocessing
import os
import signal
import subprocess
import sys
import threading
import time
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

import echocal
from echocal.correct import correct_files
from echocal.correct.driver import Summary
from echocal.engines.processes import Processes

pytestmark = pytest.mark.slow

MODEL = echocal.Model("linear", {"zero_error": {"offset": 2e-3}})
FILES = 8
ROWS = sum(80_000 + number for number in range(FILES))

RUN = """
import sys
import echocal
from echocal.correct import correct_files
from echocal.engines import open_engine
model = echocal.Model("linear", {"zero_error": {"offset": 2e-3}})
with open_engine(sys.argv[3], int(sys.argv[4])) as engine:
    print("begun", flush=True)
    correct_files(sys.argv[1], sys.argv[2], model, processes=1, engine=engine)
"""


@pytest.fixture
def logs(tmp_path: Path, random: np.random.Generator) -> Path:
    """Files of two kinds, in folders."""
    for number in range(FILES):
        rows = 80_000 + number
        table = pd.DataFrame(
            {
                "echo_us": np.round(random.uniform(2000, 20_000, rows), 1),
                "temperature_C": np.round(random.uniform(0, 30, rows), 2),
            }
        )
        folder = tmp_path / "in" / f"month={number % 2}"
        folder.mkdir(parents=True, exist_ok=True)
        if number % 3:
            table.to_parquet(folder / f"{number}.parquet", row_group_size=20_000)
        else:
            table.to_csv(folder / f"{number}.csv", index=False)
    return tmp_path / "in"


@pytest.fixture
def whole(logs: Path, tmp_path: Path) -> dict[str, bytes]:
    """The outputs of a run that nothing stops."""
    assert not correct_files(logs, tmp_path / "whole", MODEL).set_aside
    return contents(tmp_path / "whole")


def contents(out: Path) -> dict[str, bytes]:
    """All files but what a run notes for itself; files of runs that are under way may go meanwhile."""
    found = {}
    for path in out.rglob("*"):
        if path.is_file() and "_echocal" not in path.parts:
            found[path.relative_to(out).as_posix()] = path.read_bytes()
    return found


def check_partial(out: Path, whole: dict[str, bytes]) -> None:
    """What has the name of an output is whole."""
    for path in out.rglob("*"):
        if path.is_file() and "_echocal" not in path.parts and not path.name.endswith(".unfinished"):
            name = path.relative_to(out).as_posix()
            assert path.read_bytes() == whole[name], f"{name} is not whole"


def check_whole(out: Path, whole: dict[str, bytes], summary: Summary) -> None:
    assert contents(out) == whole
    assert not summary.set_aside
    assert summary.rows == ROWS
    assert sorted(path.name for path in (out / "_echocal").iterdir()) == ["lock", "manifest.jsonl"]
    lines = [json.loads(line) for line in (out / "_echocal" / "manifest.jsonl").read_text().splitlines()]
    assert sorted(line["place"] for line in lines[1:]) == sorted(whole)
    assert sum(line["rows"] for line in lines[1:]) == ROWS


def begun(logs: Path, out: Path, engine: str, workers: int) -> "subprocess.Popen[bytes]":
    """A run that has read its code and begins with the files."""
    command = [sys.executable, "-c", RUN, str(logs), str(out), engine, str(workers)]
    run = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, start_new_session=True)
    assert run.stdout is not None
    assert run.stderr is not None
    assert run.stdout.readline() == b"begun\n", run.stderr.read()
    return run


def await_files(out: Path, count: int) -> float:
    """Wait until so many files are done [s]."""
    start, manifest = time.monotonic(), out / "_echocal" / "manifest.jsonl"
    while time.monotonic() - start < 30 and count:
        if manifest.exists() and manifest.read_text().count("\n") > count:
            break
        time.sleep(0.002)
    return time.monotonic() - start


def killed(logs: Path, out: Path, engine: str, workers: int, files: int, moment: float) -> int:
    """Kill a run, not its workers, some time after some files are done [s]; the group of its processes."""
    run = begun(logs, out, engine, workers)
    await_files(out, files)
    time.sleep(moment)
    run.kill()
    run.communicate()
    return run.pid


def durations(logs: Path, out: Path, engine: str, workers: int) -> tuple[float, float]:
    """Time until the first file is done, and from then until all are [s]."""
    run = begun(logs, out, engine, workers)
    taken = await_files(out, 1), await_files(out, FILES)
    run.communicate()
    assert run.returncode == 0
    return taken


def await_end(group: int) -> float:
    """Wait until all processes of a group have ended [s]."""
    begun = time.monotonic()
    while True:
        try:
            os.killpg(group, 0)
        except ProcessLookupError:
            return time.monotonic() - begun
        if time.monotonic() - begun > 20:
            os.killpg(group, signal.SIGKILL)
            pytest.fail("workers outlive their run")
        time.sleep(0.05)


@pytest.mark.parametrize(
    ("engine", "workers", "moments"),
    [("local", 1, 20), ("local", 2, 6), ("dask-local", 2, 4)],
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
    """Killed once, or twice in the same folder, then run again while its workers may be alive."""
    if engine == "dask-local":
        pytest.importorskip("distributed")
    partial, (first, others) = 0, durations(logs, tmp_path / "timed", engine, workers)
    for number in range(moments):
        out = tmp_path / f"out {number - number % 2 * random.integers(0, 2)}"
        before = number % 4 == 0
        latest = first + others if before else others
        group = killed(logs, out, engine, workers, not before, float(random.uniform(0.0, latest)))
        check_partial(out, whole)
        summary = None
        if number % 2 or random.integers(0, 2):
            summary = correct_files(logs, out, MODEL)
            partial += 0 < summary.skipped < FILES
        await_end(group)
        check_partial(out, whole)
        last = correct_files(logs, out, MODEL)
        check_whole(out, whole, last)
        if summary is not None:
            assert last.skipped == FILES, "a worker replaced an output after its run"
    print(f"{partial} of {moments} runs had done a part")


def test_the_driver_of_a_cluster(
    logs: Path, whole: dict[str, bytes], tmp_path: Path, random: np.random.Generator
) -> None:
    """Its workers go on; the same request begins again on them at once."""
    distributed = pytest.importorskip("distributed")
    with distributed.LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address="127.0.0.1:0") as own:
        cluster = "dask://" + str(own.scheduler_address).removeprefix("tcp://")
        for number in range(4):
            out = tmp_path / f"out {number}"
            await_end(killed(logs, out, cluster, 2, 0, float(random.uniform(0.0, 0.5))))
            check_whole(out, whole, correct_files(logs, out, MODEL, engine=cluster))
            time.sleep(0.5)
            check_whole(out, whole, correct_files(logs, out, MODEL))


@pytest.mark.parametrize("every", [False, True], ids=["one", "all"])
def test_workers(
    every: bool, logs: Path, whole: dict[str, bytes], tmp_path: Path, random: np.random.Generator
) -> None:
    """While they start, or after the first file is done."""
    lost = 0
    for number in range(6):
        out, started = tmp_path / f"out {number}", number % 2
        latest = 0.1 if started else 0.8
        dead: list[int] = []
        killer = Killer(every, out if started else None, float(random.uniform(0.0, latest)), dead)
        killer.start()
        check_whole(out, whole, correct_files(logs, out, MODEL, engine=Processes(2)))
        killer.join(40)
        lost += bool(dead)
        assert correct_files(logs, out, MODEL).skipped == FILES
    assert lost > 1, "no moment found a worker"


class Killer(threading.Thread):
    """Kills workers of this process some time after they start, or after the first file in `out` is done."""

    def __init__(self, every: bool, out: Path | None, moment: float, dead: list[int]) -> None:
        super().__init__(daemon=True)
        self._every, self._out, self._moment, self._dead = every, out, moment, dead

    def run(self) -> None:
        while not multiprocessing.active_children():
            time.sleep(0.01)
        if self._out is not None:
            await_files(self._out, 1)
        time.sleep(self._moment)
        children = multiprocessing.active_children()
        for child in children if self._every else children[:1]:
            self._dead.append(int(child.pid or 0))
            os.kill(self._dead[-1], signal.SIGKILL)
