"""Inputs and outputs in an object store, on a local server that speaks S3."""

import os
import sys
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest
from killed import begin, model
from killed import contents as on_disk

import echocal
from echocal.correct import correct_files
from echocal.correct.driver import Progress
from echocal.engines import open_engine
from echocal.fleet import diagnose_fleet
from echocal.objects import Object

pytest.importorskip("s3fs")
moto = pytest.importorskip("moto.server")

MODEL, OTHER = model(2e-3), model(3e-3)
FILES = 5


@pytest.fixture(scope="module")
def server() -> Iterator[str]:
    own = moto.ThreadedMotoServer(ip_address="127.0.0.1", port=0, verbose=False)
    own.start()
    host, port = own.get_host_and_port()
    yield f"http://{host}:{port}"
    own.stop()


@pytest.fixture
def store(server: str, monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> Any:
    """A file system with an empty bucket ``fleet``; all processes find it by their environment."""
    import s3fs

    monkeypatch.setenv("AWS_ENDPOINT_URL", server)
    monkeypatch.setenv("AWS_ACCESS_KEY_ID", "testing")
    monkeypatch.setenv("AWS_SECRET_ACCESS_KEY", "testing")
    monkeypatch.setenv("AWS_DEFAULT_REGION", "us-east-1")
    s3fs.S3FileSystem.clear_instance_cache()
    files = s3fs.S3FileSystem(use_listings_cache=False)
    if files.exists("fleet"):
        files.rm("fleet", recursive=True)
    files.mkdir("fleet")
    return files


@pytest.fixture
def logs(tmp_path: Path, store: Any, random: np.random.Generator) -> Path:
    """The same files on the disk and in the store."""
    for number in range(FILES):
        rows = 3000 + number
        table = pd.DataFrame(
            {
                "echo_us": np.round(random.uniform(2000, 20_000, rows), 1),
                "temperature_C": np.round(random.uniform(0, 30, rows), 2),
            }
        )
        folder = tmp_path / "in" / f"sensor_id={number % 2}"
        folder.mkdir(parents=True, exist_ok=True)
        if number % 2:
            table.to_parquet(folder / f"{number}.parquet", row_group_size=1000)
        else:
            table.to_csv(folder / f"{number}.csv", index=False)
    (tmp_path / "in" / "_SUCCESS").write_text("")
    store.put(f"{tmp_path}/in/", "fleet/in/", recursive=True)
    return tmp_path / "in"


@pytest.fixture
def whole(logs: Path, tmp_path: Path) -> dict[str, bytes]:
    """The outputs on a disk."""
    correct_files(logs, tmp_path / "whole", MODEL)
    return on_disk(tmp_path / "whole")


def contents(store: Any, folder: str) -> dict[str, bytes]:
    found = store.find(folder) if store.exists(folder) else []
    return {path[len(folder) + 1 :]: store.cat_file(path) for path in found if "_echocal" not in path}


def test_a_folder_from_store_to_store(
    logs: Path, whole: dict[str, bytes], store: Any, run: Callable[..., tuple[int, str]], tmp_path: Path
) -> None:
    MODEL.save(tmp_path / "model.json")
    words = ["correct", "s3://fleet/in", "-o", "s3://fleet/out", "--model", "model.json"]
    code, said = run(*words)
    assert code == 0
    assert "left out: 1 file (s3://fleet/in/_SUCCESS)" in said
    assert contents(store, "fleet/out") == whole
    before = {path: store.info(path)["ETag"] for path in store.find("fleet/out")}
    times = {path: store.info(path)["LastModified"] for path in before if "_echocal" not in path}
    assert run(*words)[0] == 0
    assert times == {path: store.info(path)["LastModified"] for path in times}  # not done again
    store.pipe_file("fleet/out/sensor_id=0/0.csv", b"cut off")
    assert run(*words)[0] == 0
    assert contents(store, "fleet/out") == whole
    echocal.Model("linear").save(tmp_path / "model.json")
    code, said = run(*words)
    assert code == 2
    assert "s3://fleet/out was begun with another model" in said


def test_a_glob_a_file_and_a_disk(logs: Path, whole: dict[str, bytes], store: Any, tmp_path: Path) -> None:
    summary = correct_files("s3://fleet/in/*/*.parquet", tmp_path / "o", MODEL)
    assert sorted(summary.results) == ["sensor_id=1/1.parquet", "sensor_id=1/3.parquet"]
    name = "sensor_id=1/1.parquet"
    assert (tmp_path / "o" / name).read_bytes() == whole[name]
    correct_files(logs / name, "s3://fleet/one.parquet", MODEL)
    assert store.cat_file("fleet/one.parquet") == whole[name]
    correct_files("s3://fleet/in/sensor_id=0/0.csv", tmp_path / "one.csv", MODEL)
    assert (tmp_path / "one.csv").read_bytes() == whole["sensor_id=0/0.csv"]


def test_the_models_of_partitions(logs: Path, store: Any, tmp_path: Path) -> None:
    (tmp_path / "models").mkdir()
    for sensor in range(2):
        own = echocal.Model("linear", {"zero_error": {"offset": sensor * 1e-3}})
        own.save(tmp_path / "models" / f"{sensor}.json")
    how: dict[str, Any] = {"models": tmp_path / "models", "by": "sensor_id"}
    correct_files("s3://fleet/in", "s3://fleet/out", **how)
    correct_files(logs, tmp_path / "here", **how)
    one = "sensor_id=1/3.parquet"
    assert store.cat_file(f"fleet/out/{one}") == (tmp_path / "here" / one).read_bytes()


@pytest.mark.slow
@pytest.mark.parametrize("engine", ["local", "dask-local"])
def test_on_processes(engine: str, logs: Path, whole: dict[str, bytes], store: Any) -> None:
    if engine == "dask-local":
        pytest.importorskip("distributed")
    with open_engine(engine, 2) as own:
        correct_files("s3://fleet/in", "s3://fleet/out", MODEL, engine=own)
    assert contents(store, "fleet/out") == whole


def correct_there(environment: dict[str, str], offset: float, force: bool) -> None:
    """Correct the folder of the store in a process of its own; exit code 2 where it is refused."""
    os.environ.update(environment)
    try:
        correct_files("s3://fleet/in", "s3://fleet/out", model(offset), force=force)
    except echocal.UsageError as error:
        sys.exit(error.exit_code)


@pytest.mark.slow
def test_killed_anywhere(
    logs: Path, whole: dict[str, bytes], store: Any, random: np.random.Generator
) -> None:
    """At 20 moments of the whole run; every other run begins in what the last one left."""
    environment = {name: value for name, value in os.environ.items() if name.startswith("AWS_")}
    begun = time.monotonic()
    begin(correct_there, environment, 2e-3, False).join()
    latest = time.monotonic() - begun
    assert contents(store, "fleet/out") == whole
    for number in range(20):
        if number % 2 == 0:
            store.rm("fleet/out", recursive=True)
        run = begin(correct_there, environment, 2e-3, False)
        time.sleep(float(random.uniform(0.0, latest)))
        run.kill()
        run.join()
        assert contents(store, "fleet/out").items() <= whole.items()  # each is whole, or absent
        if number % 2:
            correct_files("s3://fleet/in", "s3://fleet/out", MODEL)
            assert contents(store, "fleet/out") == whole


@pytest.mark.slow
def test_two_runs_at_once(
    logs: Path, whole: dict[str, bytes], store: Any, tmp_path: Path, random: np.random.Generator
) -> None:
    """Of one request both succeed. Of two at most one succeeds, and all objects are its own."""
    environment = {name: value for name, value in os.environ.items() if name.startswith("AWS_")}
    correct_files(logs, tmp_path / "other", OTHER)
    wholes = {2e-3: whole, 3e-3: on_disk(tmp_path / "other")}
    ended = []
    for number in range(6):
        second = 3e-3 if number % 2 else 2e-3
        runs = {0: begin(correct_there, environment, 2e-3, False)}
        time.sleep(float(random.uniform(0.0, 0.3)))
        runs[1] = begin(correct_there, environment, second, number % 4 == 3)
        for run in runs.values():
            run.join()
        codes = [run.exitcode for run in runs.values()]
        ended.append(codes)
        assert set(codes) <= {0, 2}
        if second == 2e-3:
            assert codes == [0, 0]
            assert contents(store, "fleet/out") == whole
        elif codes[0] == codes[1]:  # the second began when the first had ended, or each was in the way
            assert codes == [2, 2] or number % 4 == 3
        winner = 2e-3 if codes[1] else second
        if 0 in codes:
            assert contents(store, "fleet/out") == wholes[winner]
        again = correct_files("s3://fleet/in", "s3://fleet/out", model(winner), force=0 not in codes)
        assert contents(store, "fleet/out") == wholes[winner]
        assert again.skipped == FILES or 0 not in codes
        store.rm("fleet/out", recursive=True)
    print(ended)


@pytest.mark.parametrize("moment", [0, 2, FILES])
def test_another_request_that_begins_anew_meanwhile(
    moment: int, logs: Path, whole: dict[str, bytes], store: Any
) -> None:
    """The first had gone on, and had put its manifest over objects of the other."""

    def meanwhile(state: Progress) -> None:
        if state.files == moment and not began:
            began.append(True)
            correct_files("s3://fleet/in", "s3://fleet/out", MODEL, force=True)

    began: list[bool] = []
    with pytest.raises(echocal.UsageError, match="s3://fleet/out was begun anew by another run, or removed"):
        correct_files("s3://fleet/in", "s3://fleet/out", OTHER, progress=meanwhile)
    assert contents(store, "fleet/out") == whole
    assert correct_files("s3://fleet/in", "s3://fleet/out", MODEL).skipped == FILES


def test_an_object_that_somebody_replaces_meanwhile(logs: Path, whole: dict[str, bytes], store: Any) -> None:
    def meanwhile(state: Progress) -> None:
        if state.files == FILES:
            store.pipe_file("fleet/out/sensor_id=1/1.parquet", b"not ours")

    with pytest.raises(echocal.UsageError, match=r"replaced 1 of 5 outputs, first sensor_id=1/1\.p"):
        correct_files("s3://fleet/in", "s3://fleet/out", MODEL, progress=meanwhile)
    assert correct_files("s3://fleet/in", "s3://fleet/out", MODEL).skipped == FILES - 1
    assert contents(store, "fleet/out") == whole


def test_bad_objects(logs: Path, whole: dict[str, bytes], store: Any, tmp_path: Path) -> None:
    good = store.cat_file("fleet/in/sensor_id=1/1.parquet")
    store.pipe_file("fleet/in/cut.parquet", good[: len(good) // 2])
    summary = correct_files("s3://fleet/in", "s3://fleet/out", MODEL)
    (said,) = summary.set_aside.items()
    assert said[0] == "s3://fleet/in/cut.parquet"
    assert said[1].startswith("s3://fleet/in/cut.parquet")
    assert "damaged" in said[1]
    assert contents(store, "fleet/out") == whole
    with pytest.raises(echocal.DataError, match=r"^no file s3://fleet/in/absent\.csv"):
        correct_files("s3://fleet/in/absent.csv", tmp_path / "a.csv", MODEL)
    with pytest.raises(echocal.UsageError, match=r"s3://nobody/a\.csv cannot be written: "):
        correct_files(logs / "sensor_id=0" / "0.csv", "s3://nobody/a.csv", MODEL)
    with pytest.raises(echocal.UsageError, match=r"s3://fleet/in/out is or lies in the input itself"):
        correct_files("s3://fleet/in", "s3://fleet/in/out", MODEL)


def test_an_object_that_changes_while_it_is_read(logs: Path, store: Any, tmp_path: Path) -> None:
    def change(state: Progress) -> None:
        if state.rows and not state.files:
            store.pipe_file("fleet/in/sensor_id=0/0.csv", b"echo_us,temperature_C\n11660,20\n")

    with pytest.raises(echocal.DataError, match="was written while it was read"):
        correct_files("s3://fleet/in/sensor_id=0/0.csv", tmp_path / "a.csv", MODEL, progress=change)
    assert not (tmp_path / "a.csv").exists()


def test_an_object_of_somebody_else_is_not_replaced(
    logs: Path, store: Any, run: Callable[..., tuple[int, str]]
) -> None:
    store.pipe_file("fleet/mine.csv", b"dear diary")
    code, said = run("correct", "s3://fleet/in/sensor_id=0/0.csv", "-o", "s3://fleet/mine.csv")
    assert code == 2
    assert "--out s3://fleet/mine.csv exists: choose another name, or replace it with --force" in said
    assert store.cat_file("fleet/mine.csv") == b"dear diary"
    assert run("correct", "s3://fleet/in/sensor_id=0/0.csv", "-o", "s3://fleet/mine.csv", "--force")[0] == 0
    store.pipe_file("fleet/out/sensor_id=0/0.csv", b"dear diary")
    assert run("correct", "s3://fleet/in", "-o", "s3://fleet/out")[0] == 2


def test_what_needs_a_disk(logs: Path, store: Any) -> None:
    lag = echocal.Model("linear", {"temperature_lag": {"time_constant": 60.0}})
    with pytest.raises(echocal.UsageError, match=r"the 5 files of it are in an object store; copy them"):
        correct_files("s3://fleet/in", "s3://fleet/out", lag, logs="all")
    with pytest.raises(echocal.UsageError, match=r"is in an object store, and this command reads files"):
        diagnose_fleet("s3://fleet/in", "sensor_id")


def test_a_store_that_nothing_knows(monkeypatch: pytest.MonkeyPatch) -> None:
    with pytest.raises(echocal.UsageError, match=r"nothing://a/b.csv cannot be used: Protocol not known"):
        Object("nothing://a/b.csv").exists()
    monkeypatch.setitem(sys.modules, "fsspec.core", None)
    with pytest.raises(echocal.UsageError, match=r"pip install 'echocal\[s3\]'"):
        Object("s3://a/b.csv").exists()
