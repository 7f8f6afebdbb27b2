"""The same on Ray."""

import os
import signal
from pathlib import Path

import fleet_work
import numpy as np
import pandas as pd
import pytest

import echocal
from echocal.correct import correct_files
from echocal.correct.driver import Progress
from echocal.engines import open_engine
from echocal.errors import UsageError
from echocal.model import folder as model_folder

pytest.importorskip("ray")
pytestmark = pytest.mark.slow

MODEL = echocal.Model("linear", {"zero_error": {"offset": 2e-3}})


@pytest.fixture
def logs(tmp_path: Path, random: np.random.Generator) -> Path:
    (tmp_path / "in").mkdir()
    for number in range(6):
        table = pd.DataFrame({"echo_us": random.uniform(2000, 20_000, 20_000), "temperature_C": 20.0})
        table.to_parquet(tmp_path / "in" / f"{number}.parquet")
    return tmp_path / "in"


def contents(out: Path) -> dict[str, bytes]:
    return {path.name: path.read_bytes() for path in out.iterdir() if path.is_file()}


def test_the_same_files_though_a_worker_is_killed(
    logs: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    correct_files(logs, tmp_path / "here", MODEL)
    tests = str(Path(__file__).parent)  # its processes import this file and fleet_work
    monkeypatch.setenv("PYTHONPATH", os.pathsep.join([tests, os.environ.get("PYTHONPATH", "")]))
    with open_engine("ray-local", 2) as engine:

        def kill(state: Progress) -> None:
            if state.files == 1:
                for pid in _workers():
                    os.kill(pid, signal.SIGKILL)

        summary = correct_files(logs, tmp_path / "there", MODEL, engine=engine, progress=kill)
        assert not summary.set_aside
        assert contents(tmp_path / "there") == contents(tmp_path / "here")
        tasks = [{"number": number, "folder": str(tmp_path)} for number in range(6)]
        found = {task["number"]: result for task, result in engine.run(fleet_work.deadly, tasks)}
        assert [number for number, result in found.items() if result is None] == [3]
        assert {result["threads"] for result in found.values() if result} == {"1"}
        with pytest.raises(UsageError, match="install the same version everywhere"):
            list(engine.run(_refuses, tasks[:1]))
        (tmp_path / "m").mkdir()
        MODEL.save(tmp_path / "m" / "1.json")
        monkeypatch.setattr(model_folder.ModelFolder, "digest", lambda self: "0" * 64)  # here, not there
        with pytest.raises(UsageError, match=r"worker \S+ \w+ has other models: their digest is"):
            correct_files(logs, tmp_path / "o", models=tmp_path / "m", by="sensor_id", engine=engine)


def _refuses(task: object) -> dict[str, object]:
    raise UsageError("install the same version everywhere")


def _workers() -> list[int]:
    """Processes that run a task of Ray, of this test alone."""
    import psutil

    below = psutil.Process().children(recursive=True)
    return [one.pid for one in below if " ".join(one.cmdline()[:1]).startswith("ray::call")]
