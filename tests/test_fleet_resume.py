"""A run that is killed is continued; a worker that is killed loses seconds; two runs do not mix."""

import multiprocessing
import os
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import fleet_logs
import fleet_work
import numpy as np
import polars as pl
import pytest

from echocal.engines import open_engine
from echocal.engines.processes import Processes
from echocal.errors import UsageError
from echocal.fleet import diagnose_fleet
from echocal.fleet.store import Store

WORK = Path(fleet_work.__file__)


@pytest.fixture
def logs(tmp_path: Path, random: np.random.Generator, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    whole = fleet_logs.fleet(random, [0.0, fleet_logs.DELAY] * 3)
    Path("logs").mkdir()
    whole.write_parquet("logs/a.parquet")
    return tmp_path


def start(out: str, models: str) -> subprocess.Popen[bytes]:
    return subprocess.Popen([sys.executable, str(WORK), out, models], start_new_session=True)


def records(out: str) -> int:
    return len(list(Path(f"{out}.parts").glob("*.json.gz")))


def killed_after(out: str, models: str, count: int) -> None:
    """Kill the run and its workers when so many tasks are done."""
    run = start(out, models)
    while run.poll() is None and records(out) < count:
        time.sleep(0.01)
    os.killpg(run.pid, signal.SIGKILL)
    run.wait()


@pytest.mark.slow
def test_a_killed_run_is_continued_with_the_same_verdicts(logs: Path, random: np.random.Generator) -> None:
    assert start("whole.parquet", "m1").wait() == 0
    for count in sorted(random.integers(0, 5, 2).tolist()):
        killed_after("v.parquet", "m2", count)
        assert not Path("v.parquet").exists()
    before = records("v.parquet")
    Path("v.parquet.parts").mkdir(exist_ok=True)  # a run that was killed at once made none
    (Path("v.parquet.parts") / ".0000001.json.gz.0123456789abcdef.unfinished").write_text("cut o")
    done: list[tuple[int, int, int]] = []
    diagnose_fleet(
        "logs", "sensor_id", out="v.parquet", models="m2", base="cramer", memory=fleet_work.ONE_EACH,
        workers=2, progress=lambda *state: done.append(state),
    )  # fmt: skip
    assert done[0] == (before, 6, before)
    changing = ["seconds"]
    assert pl.read_parquet("v.parquet").drop(changing).equals(pl.read_parquet("whole.parquet").drop(changing))
    assert not Path("v.parquet.parts").exists()
    for file in Path("m1").iterdir():
        assert (Path("m2") / file.name).read_bytes() == file.read_bytes()
    assert len(list(Path("m2").iterdir())) == len(list(Path("m1").iterdir())) == 7


@pytest.mark.slow
def test_a_model_that_was_damaged_is_made_again(logs: Path) -> None:
    killed_after("v.parquet", "m", 3)
    first = sorted(Path("m").glob("?.json"))[0]
    whole = first.read_bytes()
    first.write_bytes(whole[:100])
    assert start("v.parquet", "m").wait() == 0
    assert first.read_bytes() == whole


@pytest.mark.slow
def test_another_request_does_not_continue_it(logs: Path) -> None:
    killed_after("v.parquet", "m", 1)
    with pytest.raises(
        UsageError, match=r"v.parquet.parts has the unfinished run of another request .*request"
    ):
        diagnose_fleet("logs", "sensor_id", out="v.parquet", models="m", base="linear")
    pl.read_parquet("logs/a.parquet")[:-1].write_parquet("logs/a.parquet")
    with pytest.raises(UsageError, match=r"it differs in: files\); repeat that request"):
        diagnose_fleet(
            "logs", "sensor_id", out="v.parquet", models="m", base="cramer", memory=fleet_work.ONE_EACH
        )
    found = diagnose_fleet("logs", "sensor_id", out="v.parquet", models="m", base="linear", force=True)
    assert len(found.rows) == 6


def test_two_runs_on_one_output_are_refused(logs: Path) -> None:
    with (
        Store(Path("v.parquet.parts")).locked(),
        pytest.raises(UsageError, match=r"v.parquet.parts is being written by process \d+"),
    ):
        diagnose_fleet("logs", "sensor_id", out="v.parquet", base="cramer")


def test_the_pool_runs_each_task_once_with_one_thread() -> None:
    tasks = [{"number": number} for number in range(9)]
    found = list(Processes(2).run(fleet_work.plain, tasks))
    assert sorted(task["number"] for task, _ in found) == list(range(9))
    assert all(result is not None and result["number"] == task["number"] for task, result in found)
    processes = {result["process"] for _, result in found if result}
    assert 1 <= len(processes) <= 2
    assert os.getpid() not in processes
    assert {result["threads"] for _, result in found if result} == {"1"}


@pytest.mark.slow
def test_a_task_that_loses_its_process_is_run_again_and_given_up_if_it_does_so_alone(tmp_path: Path) -> None:
    tasks = [{"number": number, "folder": str(tmp_path)} for number in range(9)]
    found = {task["number"]: result for task, result in Processes(2).run(fleet_work.deadly, tasks)}
    assert sorted(found) == list(range(9))
    assert [number for number, result in found.items() if result is None] == [3]


def test_what_a_task_raises_ends_the_run_and_says_where() -> None:
    with pytest.raises(KeyError, match="folder") as raised:
        list(Processes(2).run(fleet_work.deadly, [{"number": 1}] * 5))
    assert "in deadly" in raised.value.__notes__[0]
    with pytest.raises(RuntimeError, match="Alone: 1 of 2, in a process"):
        list(Processes(2).run(fleet_work.alone, [{}] * 3))
    with pytest.raises(SystemExit, match="3"):
        list(Processes(2).run(fleet_work.leaves, [{}] * 3))
    with pytest.raises(RuntimeError, match="cannot be sent"):
        list(Processes(2).run(fleet_work.unspeakable, [{}]))
    assert not multiprocessing.active_children()


@pytest.mark.slow
def test_processes_that_are_killed_while_others_begin() -> None:
    """The pool of the standard library waited for ever, or raised that a handle is closed."""
    begun: list[Any] = []

    def kill() -> None:
        while len(begun) < 6:
            for process in multiprocessing.active_children():
                if process not in begun:
                    begun.append(process)
                    process.kill()

    killer = threading.Thread(target=kill)
    killer.start()
    tasks = [{"number": number} for number in range(9)]
    found = {task["number"]: result for task, result in Processes(2).run(fleet_work.plain, tasks)}
    killer.join()
    assert sorted(found) == list(range(9))
    assert sum(result is None for result in found.values()) <= 6
    assert not multiprocessing.active_children()


@pytest.mark.slow
def test_dask_gives_the_same_verdicts_and_models(logs: Path) -> None:
    """Its workers have another working folder, and one of them is killed."""
    pytest.importorskip("distributed")
    how = {"base": "cramer", "memory": fleet_work.ONE_EACH}
    diagnose_fleet("logs", "sensor_id", out="here.parquet", models="m1", workers=1, **how)
    with open_engine("dask-local", 2) as engine:
        pids: list[int] = list(engine.ask(os.getpid).values())

        def kill(done: int, total: int, earlier: int) -> None:
            if done == 1:
                os.kill(pids[0], signal.SIGKILL)

        diagnose_fleet(
            "logs", "sensor_id", out="there.parquet", models="m2", engine=engine, progress=kill, **how
        )
    changing = ["seconds"]
    assert (
        pl.read_parquet("there.parquet").drop(changing).equals(pl.read_parquet("here.parquet").drop(changing))
    )
    for file in Path("m1").iterdir():
        assert (Path("m2") / file.name).read_bytes() == file.read_bytes()
    assert len(list(Path("m2").iterdir())) == 7


@pytest.mark.slow
def test_the_engine_of_the_command(logs: Path, run: Callable[..., tuple[int, str]]) -> None:
    pytest.importorskip("distributed")
    words = ["diagnose", "logs", "--by", "sensor_id", "-o", "v.csv", "--base", "cramer", "--workers", "2"]
    assert run(*words, "--engine", "dask-local", "--quiet") == (0, "")
    assert len(Path("v.csv").read_text().splitlines()) == 7
    code, said = run("diagnose", "logs/a.parquet", "--engine", "dask-local")
    assert code == 2
    assert "--engine is for a fleet" in said
