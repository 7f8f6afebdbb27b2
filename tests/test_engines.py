"""Whoever runs the tasks, the files are the same; workers that would do other work are refused first."""

import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from pathlib import Path

import fleet_work
import numpy as np
import pandas as pd
import pytest

import echocal
from echocal.correct import correct_files
from echocal.correct.driver import Progress
from echocal.engines import open_engine
from echocal.engines.worker import sees
from echocal.errors import UsageError
from echocal.model import folder as model_folder
from echocal.places import file_digest

distributed = pytest.importorskip("distributed")

MODEL = echocal.Model("linear", {"zero_error": {"offset": 2e-3}})
FILES = 6


@pytest.fixture(scope="module")
def cluster() -> Iterator[str]:
    """Address of a scheduler with two workers, each a process with two threads."""
    with distributed.LocalCluster(n_workers=2, threads_per_worker=2, dashboard_address="127.0.0.1:0") as own:
        yield str(own.scheduler_address).removeprefix("tcp://")


@pytest.fixture
def logs(tmp_path: Path, random: np.random.Generator) -> Path:
    for number in range(FILES):
        rows = 5000 + number
        table = pd.DataFrame(
            {
                "sensor_id": random.integers(0, 3, rows),
                "echo_us": np.round(random.uniform(2000, 20_000, rows), 1),
                "temperature_C": np.round(random.uniform(0, 30, rows), 2),
            }
        )
        folder = tmp_path / "in" / f"month={number % 2}"
        folder.mkdir(parents=True, exist_ok=True)
        if number % 2:
            table.to_parquet(folder / f"{number}.parquet", row_group_size=2000)
        else:
            table.to_csv(folder / f"{number}.csv", index=False)
    return tmp_path / "in"


@pytest.fixture
def models(tmp_path: Path) -> Path:
    folder = tmp_path / "models"
    folder.mkdir()
    for sensor in range(3):
        echocal.Model("linear", {"zero_error": {"offset": sensor * 1e-3}}).save(folder / f"{sensor}.json")
    return folder


def contents(out: Path) -> dict[str, bytes]:
    files = (path for path in out.rglob("*") if path.is_file() and "_echocal" not in path.parts)
    return {path.relative_to(out).as_posix(): path.read_bytes() for path in files}


@pytest.mark.slow
@pytest.mark.parametrize("engine", ["dask-local", "dask://"])
def test_the_same_files_from_the_command(
    engine: str, logs: Path, models: Path, cluster: str, run: Callable[..., tuple[int, str]]
) -> None:
    """The paths are relative, and the workers have another working folder."""
    assert run("correct", "in", "-o", "here", "--models", "models", "--by", "sensor_id")[0] == 0
    name = engine + cluster if engine == "dask://" else engine
    words = ["correct", "in", "-o", "there", "--models", "models", "--by", "sensor_id", "--engine", name]
    assert run(*words)[0] == 0
    assert contents(Path("there")) == contents(Path("here"))
    assert len(contents(Path("there"))) == FILES
    assert run(*words)[0] == 0  # nothing is left to do


def test_one_file_and_a_bad_one(logs: Path, cluster: str, tmp_path: Path) -> None:
    one = logs / "month=0" / "0.csv"
    assert correct_files(one, tmp_path / "a.csv", MODEL, engine=f"dask://{cluster}").rows == 5000
    correct_files(one, tmp_path / "b.csv", MODEL)
    assert (tmp_path / "a.csv").read_bytes() == (tmp_path / "b.csv").read_bytes()
    (logs / "cut.parquet").write_bytes(b"PAR1")
    summary = correct_files(logs, tmp_path / "out", MODEL, engine=f"dask://{cluster}")
    assert [Path(path).name for path in summary.set_aside] == ["cut.parquet"]
    assert len(contents(tmp_path / "out")) == FILES
    with pytest.raises(echocal.DataError, match="damaged"):
        correct_files(logs / "cut.parquet", tmp_path / "c.parquet", MODEL, engine=f"dask://{cluster}")


def test_models_that_depend_on_other_rows(cluster: str, tmp_path: Path, random: np.random.Generator) -> None:
    """Each worker reads the log for itself, and two threads of a worker read it at the same time."""
    (tmp_path / "log").mkdir()
    for part in range(8):
        time_s = 1000.0 * part + np.arange(200.0)
        warm = 20 + random.normal(0, 2, 200)
        table = pd.DataFrame({"time_s": time_s, "echo_us": 11_660.0, "temperature_C": warm})
        table.to_csv(tmp_path / "log" / f"{part}.csv", index=False)
    lag = echocal.Model("linear", {"temperature_lag": {"time_constant": 60.0}})
    correct_files(tmp_path / "log", tmp_path / "here", lag, logs="all")
    correct_files(tmp_path / "log", tmp_path / "there", lag, logs="all", engine=f"dask://{cluster}")
    assert contents(tmp_path / "here") == contents(tmp_path / "there")


@pytest.mark.slow
@pytest.mark.parametrize("every", [False, True], ids=["one", "all"])
def test_workers_that_are_killed(every: bool, logs: Path, tmp_path: Path) -> None:
    correct_files(logs, tmp_path / "whole", MODEL)
    killed: list[int] = []
    with distributed.LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address="127.0.0.1:0") as own:
        pids = [worker.pid for worker in own.workers.values()]

        def kill(state: Progress) -> None:
            if state.files == 1 and not killed:
                killed.extend(pids if every else pids[:1])
                for pid in killed:
                    os.kill(pid, signal.SIGKILL)

        address = own.scheduler_address.removeprefix("tcp://")
        summary = correct_files(logs, tmp_path / "out", MODEL, engine=f"dask://{address}", progress=kill)
    assert killed
    assert not summary.set_aside
    assert contents(tmp_path / "out") == contents(tmp_path / "whole")


@pytest.mark.slow
def test_a_task_that_kills_its_workers_is_given_up_and_the_others_are_not(tmp_path: Path) -> None:
    import dask

    tasks = [{"number": number, "folder": str(tmp_path)} for number in range(7)]
    with dask.config.set({"distributed.scheduler.allowed-failures": 0}), open_engine("dask-local", 2) as own:
        found = {task["number"]: result for task, result in own.run(fleet_work.deadly, tasks)}
    assert found.pop(3) is None
    assert all(result is not None and result["threads"] == "1" for result in found.values())
    assert sorted(found) == [0, 1, 2, 4, 5, 6]


@pytest.mark.slow
def test_a_scheduler_that_is_gone(logs: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("echocal.engines.dask._CONNECT", 3.0)
    command = [sys.executable, "-m", "distributed.cli.dask_scheduler", "--port", "0", "--no-dashboard"]
    file = tmp_path / "scheduler.json"
    scheduler = subprocess.Popen([*command, "--scheduler-file", str(file)], stderr=subprocess.DEVNULL)
    try:
        address = _address(file)
        with pytest.raises(UsageError, match=rf"Dask scheduler {address} has no workers; start some: dask w"):
            correct_files(logs, tmp_path / "out", MODEL, engine=f"dask://{address}")
        worker = _worker(address, {})
        try:

            def kill(state: Progress) -> None:
                if state.files == 1:
                    scheduler.kill()

            with pytest.raises(UsageError, match=rf"Dask scheduler {address} is gone .*; what is complete s"):
                correct_files(logs, tmp_path / "out", MODEL, engine=f"dask://{address}", progress=kill)
        finally:
            worker.kill()
            worker.wait()
    finally:
        scheduler.kill()
        scheduler.wait()
    assert correct_files(logs, tmp_path / "out", MODEL).skipped >= 1
    correct_files(logs, tmp_path / "whole", MODEL)
    assert contents(tmp_path / "out") == contents(tmp_path / "whole")


@pytest.mark.slow
@pytest.mark.parametrize(
    ("package", "said"),
    [
        ('__version__ = "0.0.9"', r"has echocal 0\.0\.9\. Nothing was begun: this process has echocal"),
        ('raise ImportError("libstdc++")', r"has an echocal that cannot be imported \(libstdc\+\+\)"),
        (None, r"has no echocal \(No module named 'echocal._core'\)"),
    ],
    ids=["other", "broken", "none"],
)
def test_a_worker_of_another_version(package: str | None, said: str, logs: Path, tmp_path: Path) -> None:
    other = tmp_path / "other" / "echocal"
    other.mkdir(parents=True)
    (other / "__init__.py").write_text("")
    if package is not None:
        (other / "_core.py").write_text(package)
    with distributed.LocalCluster(n_workers=1, threads_per_worker=1, dashboard_address="127.0.0.1:0") as own:
        address = own.scheduler_address.removeprefix("tcp://")
        worker = _worker(address, {"PYTHONPATH": str(other.parent)})
        try:
            with distributed.Client(own.scheduler_address) as client:
                client.wait_for_workers(2, timeout=30)
            with pytest.raises(UsageError, match=rf"^Dask scheduler {address}: worker tcp://\S+ {said}"):
                correct_files(logs, tmp_path / "out", MODEL, engine=f"dask://{address}")
        finally:
            worker.kill()
            worker.wait()
    assert contents(tmp_path / "out") == {}


def test_a_worker_with_other_models(
    logs: Path, models: Path, cluster: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(model_folder.ModelFolder, "digest", lambda self: "0" * 64)  # here, not there
    with pytest.raises(UsageError, match=r"worker tcp://\S+ has other models: their digest is \w+, and here"):
        correct_files(logs, tmp_path / "o", models=models, by="sensor_id", engine=f"dask://{cluster}")
    assert contents(tmp_path / "o") == {}


def test_what_a_worker_must_see(tmp_path: Path, models: Path) -> None:
    here, lock = tmp_path / "a.csv", tmp_path / "lock"
    here.write_text("echo_us")
    lock.write_text("mine")
    assert sees({"files": {str(here): 7}, "written": [str(lock), file_digest(lock)]}) == ""
    assert "reports: no file /nowhere/a.csv" in sees({"files": {"/nowhere/a.csv": 7}})
    assert "with 7 bytes, and this process with 9" in sees({"files": {str(here): 9}})
    assert "does not see what this process wrote" in sees({"written": [str(lock), "another's"]})
    assert "does not see what this process wrote" in sees({"written": ["/nowhere/lock", "mine"]})
    plain = {"folder": str(tmp_path / "absent"), "by": "sensor_id"}
    assert "reports: models=" in sees({"models": plain, "digest": ""})


@pytest.mark.parametrize(
    ("name", "said"),
    [
        ("dusk", r"no engine 'dusk'; engines: local, dask-local, dask://HOST:PORT"),
        ("dask", r"no engine 'dask'; engines: "),
        ("local://a:1", r"no engine 'local://a:1'; engines: "),
        ("dask://somewhere", r"dask://somewhere is no address; it is dask://HOST:PORT"),
        ("dask://127.0.0.1:9", r"no Dask scheduler 127\.0\.0\.1:9 answers: "),
    ],
)
def test_engines_that_are_not_there(name: str, said: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("echocal.engines.dask._CONNECT", 0.5)
    with pytest.raises(UsageError, match=said), open_engine(name, 1):
        pass


def test_dask_that_is_not_installed(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "distributed", None)
    with pytest.raises(UsageError, match=r"pip install 'echocal\[dask\]'"), open_engine("dask-local", 1):
        pass


def _worker(address: str, environment: dict[str, str]) -> "subprocess.Popen[bytes]":
    command = [sys.executable, "-m", "distributed.cli.dask_worker", f"tcp://{address}", "--nthreads", "1"]
    return subprocess.Popen(
        [*command, "--no-nanny", "--no-dashboard"],
        env={**os.environ, **environment},
        stderr=subprocess.DEVNULL,
    )


def _address(file: Path) -> str:
    import json

    begun = time.monotonic()
    while time.monotonic() - begun < 30:
        if file.exists() and (text := file.read_text()):
            return str(json.loads(text)["address"]).removeprefix("tcp://")
        time.sleep(0.05)
    raise TimeoutError(file)
