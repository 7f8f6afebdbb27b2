"""Tasks that outlive their run, on workers that nobody killed, leave nothing in what later runs have made."""

import time
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import fleet_logs
import fleet_work
import numpy as np
import polars as pl
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
    stopped,
)

import echocal
from echocal.correct import correct_files
from echocal.correct.task import run_task
from echocal.fleet import diagnose_fleet, store
from echocal.fleet.task import run_task as diagnose_task

MODEL, OTHER = model(2e-3), model(3e-3)
ROWS = 60_000


def everything(out: Path) -> dict[str, bytes]:
    """All files, also what a run notes for itself."""
    files = (path for path in out.rglob("*") if path.is_file())
    return {path.relative_to(out).as_posix(): path.read_bytes() for path in files}


class Noted:
    """Runs tasks here and keeps them, as workers do that do not know that their run has ended."""

    name, inside = "noted", False

    def __init__(self) -> None:
        self.tasks: list[Mapping[str, Any]] = []

    def run(self, work: Any, tasks: Sequence[Mapping[str, Any]]) -> Iterator[Any]:
        for task in tasks:
            self.tasks.append(task)
            yield task, work(task)

    def ask(self, question: Any, *given: Any) -> dict[str, Any]:
        return {}


@pytest.fixture
def logs(tmp_path: Path, random: np.random.Generator) -> Path:
    return make_logs(tmp_path / "in", random, ROWS)


def test_a_task_of_another_request_leaves_nothing(logs: Path, tmp_path: Path) -> None:
    """It had put its own file in place, where the manifest says that the other request made it."""
    out, old = tmp_path / "out", Noted()
    correct_files(logs, out, MODEL, engine=old)
    correct_files(logs, out, OTHER, force=True)
    before = everything(out)
    for task in old.tasks:
        assert "was begun anew by another run" in run_task(task)["error"]["text"]
    assert everything(out) == before
    assert correct_files(logs, out, OTHER).skipped == FILES


def test_a_task_of_the_same_request_makes_the_same_file(logs: Path, tmp_path: Path) -> None:
    out, old = tmp_path / "out", Noted()
    correct_files(logs, out, MODEL, engine=old)
    correct_files(logs, out, MODEL, force=True)
    before = everything(out)
    for task in old.tasks:
        assert run_task(task)["error"] is None
    assert everything(out) == before


def test_a_task_of_an_output_that_was_removed_makes_none(logs: Path, tmp_path: Path) -> None:
    out, old = tmp_path / "out", Noted()
    correct_files(logs, out, MODEL, engine=old)
    (out / "_echocal" / "manifest.jsonl").unlink()
    for place in contents(out):
        (out / place).unlink()
    assert run_task(old.tasks[0])["error"]["kind"] == "OutputError"
    assert contents(out) == {}


def test_a_diagnosis_of_another_request_leaves_no_verdict(
    random: np.random.Generator, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Its record had been taken for that of the request that runs now."""
    monkeypatch.chdir(tmp_path)
    fleet_logs.fleet(random, [0.0, fleet_logs.DELAY] * 2).write_parquet("logs.parquet")
    how: dict[str, Any] = {"models": "m", "memory": fleet_work.ONE_EACH}
    old = Noted()
    diagnose_fleet("logs.parquet", "sensor_id", base="linear", out="v.parquet", engine=old, **how)
    diagnose_fleet("logs.parquet", "sensor_id", base="cramer", out="alone.parquet", **{**how, "models": "n"})

    class Late(Noted):
        """The tasks of the old run end after each of this one."""

        def run(self, work: Any, tasks: Sequence[Mapping[str, Any]]) -> Iterator[Any]:
            for task in tasks:
                result = work(task)
                for late in old.tasks:
                    with pytest.raises(echocal.UsageError, match="was begun anew by another run"):
                        (store.run_spill if "buckets" in late else diagnose_task)(late)
                yield task, result

    diagnose_fleet("logs.parquet", "sensor_id", base="cramer", out="v.parquet", engine=Late(), **how)
    kept = [pl.read_parquet(name).drop("seconds") for name in ("v.parquet", "alone.parquet")]
    assert kept[0].equals(kept[1])
    assert contents(Path("m")) == contents(Path("n"))
    assert not Path("v.parquet.parts").exists()
    with pytest.raises(echocal.UsageError, match="or has ended"):
        diagnose_task(old.tasks[-1])
    assert not Path("v.parquet.parts").exists()


@pytest.mark.slow
def test_the_driver_of_a_cluster(logs: Path, tmp_path: Path, random: np.random.Generator) -> None:
    """Killed while its workers stand still in their tasks; they finish them during or after the next run.

    A third of the moments is drawn from the whole run, the others from the time in which files are written.
    The next run is of the same request or of another, on the same workers or in this process.
    """
    distributed = pytest.importorskip("distributed")
    wholes = {}
    for offset in (2e-3, 3e-3):
        correct_files(logs, tmp_path / f"whole {offset}", model(offset))
        wholes[offset] = contents(tmp_path / f"whole {offset}")
    with (
        distributed.LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address="127.0.0.1:0") as own,
        distributed.Client(own, set_as_default=False) as client,
    ):
        cluster = "dask://" + str(own.scheduler_address).removeprefix("tcp://")
        pids = [worker.pid for worker in own.workers.values()]
        run = begin(correct, logs, tmp_path / "timed", cluster, 2)
        first, others = await_files(tmp_path / "timed", 0), await_files(tmp_path / "timed", FILES)
        run.join()
        assert run.exitcode == 0
        caught = 0
        for number in range(20):
            out, offset = tmp_path / f"out {number}", 3e-3 if number % 2 else 2e-3
            run = begin(correct, logs, out, cluster, 2)
            if number % 3:
                await_files(out, int(random.integers(0, FILES - 1)))
            time.sleep(float(random.uniform(0.0, others / FILES if number % 3 else first + others)))
            with stopped(pids):
                run.kill()
                run.join()
                await_end(run.pid)
                check_partial(out, wholes[2e-3])
                strays = len(list(out.rglob("*.unfinished")))
                caught += strays > 0
                if number % 4 < 2:
                    last = correct_files(logs, out, model(offset), force=True)
                    check_whole(out, wholes[offset], last, ROWS)
            if number % 4 >= 2:
                last = correct_files(logs, out, model(offset), engine=cluster, force=True)
                check_whole(out, wholes[offset], last, ROWS)
            end = time.monotonic() + 30
            while any(client.run(_executing).values()):
                assert time.monotonic() < end, "a task does not end"
                time.sleep(0.02)
            check_whole(out, wholes[offset], correct_files(logs, out, model(offset)), ROWS)
        print(f"{caught} of 20 moments found a task that was writing; {first:.2f} and {others:.2f} s")
        assert caught


def _executing(dask_worker: Any) -> int:
    return len(dask_worker.state.executing)
