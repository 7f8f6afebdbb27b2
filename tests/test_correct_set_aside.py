"""Whatever is wrong with one file sets it aside, with a reason; the files after it are corrected."""

import os
import subprocess
import sys
from pathlib import Path
from typing import Any

import damaged
import numpy as np
import pandas as pd
import pyarrow as pa
import pyarrow.parquet as pq
import pytest

import echocal
from echocal.correct import correct_files, task
from echocal.fleet import diagnose_fleet
from echocal.model.folder import file_name

MODEL = echocal.Model("linear", {"zero_error": {"offset": 2e-3}})


class Panic(BaseException):
    """As of a library in Rust: no `Exception`."""


def make_logs(folder: Path, random: np.random.Generator, count: int = 4) -> Path:
    folder.mkdir(exist_ok=True)
    for number in range(count):
        echoes = random.integers(3000, 20_000, 20)
        rows = [f"{echo},{random.uniform(0, 30):.1f}" for echo in echoes]
        (folder / f"{number}.csv").write_text("\n".join(["echo_us,temperature_C", *rows, ""]))
    return folder


@pytest.mark.parametrize("kind", damaged.KINDS)
def test_damaged_files(kind: str, random: np.random.Generator, tmp_path: Path) -> None:
    """Every one is corrected or has a reason that somebody foresaw."""
    found = damaged.tried(kind, 250, random, tmp_path)
    assert set(found) == {"set aside", "corrected"}, found
    assert found["set aside"] > 50


def test_the_command_goes_on_and_its_exit_code_says_so(random: np.random.Generator, tmp_path: Path) -> None:
    logs = make_logs(tmp_path / "in", random)
    sound = damaged.parquet_seeds(random)[0]
    for number in range(30):
        (logs / f"{number:02}.parquet").write_bytes(damaged.spoiled_footer(sound, random))
    (logs / "z.parquet").write_bytes(sound)
    words = [sys.executable, "-m", "echocal", "correct", "in", "-o", "out", "--law", "linear"]
    run = subprocess.run(words, cwd=tmp_path, capture_output=True, text=True, timeout=120, check=False)
    assert run.returncode == 3
    assert "Traceback" not in run.stderr
    assert "files were set aside" in run.stderr.splitlines()[-1]
    made = {path.name for path in (tmp_path / "out").iterdir()}
    assert {"0.csv", "1.csv", "2.csv", "3.csv", "z.parquet", "_echocal"} <= made


def test_a_part_without_rows_is_corrected(random: np.random.Generator, tmp_path: Path) -> None:
    """As clusters write them; with a model for each sensor, too."""
    whole = pa.table({"id": ["a", "b"], "echo_us": [11660.0, 9000.0], "temperature_C": [20.0, 21.0]})
    (tmp_path / "in").mkdir()
    (tmp_path / "models").mkdir()
    pq.write_table(whole, tmp_path / "in" / "whole.parquet")
    pq.write_table(whole.slice(0, 0), tmp_path / "in" / "none.parquet")
    for name in "ab":
        MODEL.save(tmp_path / "models" / f"{name}.json")
    done = correct_files(tmp_path / "in", tmp_path / "out", models=tmp_path / "models", by="id")
    assert [one["error"] for one in done.results.values()] == [None, None]
    assert pq.read_table(tmp_path / "out" / "none.parquet").num_rows == 0


@pytest.mark.skipif(sys.platform == "win32", reason="links and pipes of POSIX")
def test_links_that_lead_nowhere_and_pipes_are_told(random: np.random.Generator, tmp_path: Path) -> None:
    logs = make_logs(tmp_path / "in", random, 1)
    (logs / "gone.csv").symlink_to(tmp_path / "no.csv")
    (logs / "loop.csv").symlink_to("loop.csv")
    (logs / "folder").symlink_to(tmp_path)
    os.mkfifo(logs / "pipe.csv")
    words = [sys.executable, "-m", "echocal", "correct", "in", "-o", "out", "--law", "linear"]
    run = subprocess.run(words, cwd=tmp_path, capture_output=True, text=True, timeout=120, check=False)
    assert run.returncode == 3
    assert "2 of 3 files were set aside" in run.stderr
    assert all(
        name in run.stderr for name in ("gone.csv", "loop.csv", "left out: 2 files", "folder", "pipe.csv")
    )


ERRORS = [KeyError(3), IndexError(), AttributeError("no\nsuch"), RecursionError(), Panic("index")]


@pytest.mark.parametrize("error", ERRORS, ids=lambda error: type(error).__name__)
def test_an_error_that_nobody_foresaw_is_that_of_its_file(
    error: BaseException, random: np.random.Generator, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    logs, work = make_logs(tmp_path / "in", random), task._correct

    def broken(source: Path, *given: Any) -> Any:
        if source.name == "1.csv":
            raise error
        return work(source, *given)

    with monkeypatch.context() as patch:
        patch.setattr(task, "_correct", broken)
        summary = correct_files(logs, tmp_path / "out", MODEL)
    (said,) = summary.set_aside.values()
    assert f"1.csv: unexpected {type(error).__name__}" in said
    assert "test_correct_set_aside.py, line" in said
    assert "\n" not in said
    assert sorted(path.name for path in (tmp_path / "out").glob("*.csv")) == ["0.csv", "2.csv", "3.csv"]
    assert correct_files(logs, tmp_path / "out", MODEL).skipped == 3  # it alone is tried again


@pytest.mark.parametrize("error", [KeyboardInterrupt(), SystemExit(143)])
def test_a_request_to_stop_is_no_error_of_a_file(
    error: BaseException, random: np.random.Generator, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def stopped(*_: Any) -> Any:
        raise error

    monkeypatch.setattr(task, "_correct", stopped)
    with pytest.raises(type(error)):
        correct_files(make_logs(tmp_path / "in", random), tmp_path / "out", MODEL)
    assert not list((tmp_path / "out").glob(".*"))


def test_what_cannot_be_read_is_not_said_to_be_unwritable(
    random: np.random.Generator, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A worn disk refuses to read one file: that is no reason to stop."""
    logs, digest = make_logs(tmp_path / "in", random), task.file_digest

    def worn(place: Any) -> str:
        if place.name == "1.csv":
            raise OSError(5, "Input/output error", str(place))
        return digest(place)

    monkeypatch.setattr(task, "file_digest", worn)
    summary = correct_files(logs, tmp_path / "out", MODEL)
    assert list(summary.set_aside.values()) == [f"{logs}/1.csv cannot be read: Input/output error"]
    assert len(list((tmp_path / "out").glob("*.csv"))) == 3


@pytest.mark.parametrize("sign", ["k", "ü", "深", "a/b"])
def test_keys_of_any_length(sign: str, random: np.random.Generator, tmp_path: Path) -> None:
    """The names of their models are shortened with a hash; without a model, only their rows have none."""
    logs, models = tmp_path / "in", tmp_path / "models"
    logs.mkdir(), models.mkdir()
    count = int(random.integers(260, 3000))
    keys = {"long": sign * count, "longer": sign * count + "x", "none": "n" * count, "short": "7"}
    for name, key in keys.items():
        (logs / f"{name}.csv").write_text(f'sensor_id,echo_us,temperature_C\n"{key}",11660,20\n', "utf-8")
        if name != "none":
            echocal.Model("linear").save(models / file_name(key))
    assert len(list(models.iterdir())) == 3
    summary = correct_files(logs, tmp_path / "out", models=models, by="sensor_id")
    assert not summary.set_aside
    status = {name: pd.read_csv(tmp_path / "out" / f"{name}.csv")["status"].tolist()[0] for name in keys}
    assert {name for name, own in status.items() if own == "no model for this key"} == {"none"}


def test_a_fleet_has_models_of_long_keys(random: np.random.Generator, tmp_path: Path) -> None:
    keys = ["深" * 100, "深" * 100 + "x", "a" * 251, "7"]
    rows = [
        {"sensor_id": key, "echo_us": float(echo), "temperature_C": 20.0, "distance_m": 2.0}
        for key in keys
        for echo in random.normal(11660, 3, 30)
    ]
    pd.DataFrame(rows).to_parquet(tmp_path / "log.parquet")
    fleet = diagnose_fleet(tmp_path / "log.parquet", "sensor_id", models=tmp_path / "models", workers=1)
    assert [row["verdict"] == "failed" for row in fleet.rows] == [False] * 4
    summary = correct_files(
        tmp_path / "log.parquet", tmp_path / "out.parquet", models=tmp_path / "models", by="sensor_id"
    )
    assert (summary.rows, summary.unusable) == (120, 0)


def test_a_name_that_the_output_cannot_have_is_that_of_its_file(
    random: np.random.Generator, tmp_path: Path
) -> None:
    logs, deep, out = make_logs(tmp_path / "in", random), tmp_path / "in", tmp_path
    for _ in range(9):
        deep, out = deep / ("d" * 230), out / ("o" * 230)
    deep.mkdir(parents=True)
    out.mkdir(parents=True)
    (deep / "far.csv").write_bytes((logs / "0.csv").read_bytes())
    summary = correct_files(logs, out / "x", MODEL)
    (place,) = (place for place, own in summary.results.items() if own["error"] is not None)
    assert place.endswith("/far.csv")
    assert "File name too long" in summary.results[place]["error"]["text"]
    assert len(list((out / "x").glob("*.csv"))) == 4


BOMB = """
import os, signal, sys
sys.addaudithook(
    lambda event, given: os.kill(os.getpid(), signal.SIGKILL)
    if event == "open" and str(given[0]).endswith("in/1.csv") else None
)
"""


@pytest.mark.parametrize("processes", ["1", "2"])
def test_a_file_that_kills_its_process_ends_one_run_at_most(
    processes: str, random: np.random.Generator, tmp_path: Path
) -> None:
    """The run after a run that was killed corrects in a process of its own."""
    make_logs(tmp_path / "in", random)
    (tmp_path / "sitecustomize.py").write_text(BOMB)
    search = os.pathsep.join([str(tmp_path), *filter(None, [os.environ.get("PYTHONPATH")])])
    words = [sys.executable, "-m", "echocal", "correct", "in", "-o", "out", "--processes", processes]
    ends = []
    for _ in range(2):
        run = subprocess.run(
            words,
            cwd=tmp_path,
            env={**os.environ, "PYTHONPATH": search},
            capture_output=True,
            text=True,
            timeout=120,
            check=False,
        )
        ends.append(run.returncode)
    assert ends == [-9, 3]
    assert "in/1.csv: each process that corrected it was killed; too little memory?" in run.stderr
    assert sorted(path.name for path in (tmp_path / "out").glob("*.csv")) == ["0.csv", "2.csv", "3.csv"]


@pytest.mark.parametrize("way", [{}, {"data_page_version": "2.0", "use_dictionary": False}])
def test_one_bit_of_a_page_with_a_checksum(
    way: dict[str, Any], random: np.random.Generator, tmp_path: Path
) -> None:
    """It was another distance, with an empty status: 2.712 m for 2.009 m."""
    rows = 300
    table = pa.table(
        {
            "echo_us": np.round(random.uniform(2000, 20_000, rows), 1),
            "temperature_C": np.round(random.uniform(0, 30, rows), 1),
        }
    )
    sink = tmp_path / "sound.parquet"
    pq.write_table(table, sink, row_group_size=100, write_page_checksum=True, compression="none", **way)
    sound = sink.read_bytes()
    footer = len(sound) - 8 - int.from_bytes(sound[-8:-4], "little")
    (tmp_path / "in").mkdir()
    for number in range(60):
        data = bytearray(sound)
        data[int(random.integers(4, footer))] ^= 1 << int(random.integers(8))
        (tmp_path / "in" / f"{number}.parquet").write_bytes(data)
    (tmp_path / "in" / "z.parquet").write_bytes(sound)
    summary = correct_files(tmp_path / "in", tmp_path / "out", MODEL, processes=1)
    assert summary.results["z.parquet"]["error"] is None
    read = lambda name: pq.read_table(tmp_path / "out" / name, columns=["corrected_distance_m"])  # noqa: E731
    wanted = read("z.parquet")
    for name, result in summary.results.items():
        assert result["error"] is not None or read(name).equals(wanted), name
    assert sum("CRC checksum" in why for why in summary.set_aside.values()) > 30
