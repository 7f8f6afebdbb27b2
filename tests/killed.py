"""Runs that are killed, for the tests: begun quickly, by a process that has read the code already."""

import json
import multiprocessing
import os
import signal
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest

import echocal
from echocal.correct import correct_files
from echocal.correct.driver import Summary
from echocal.engines import open_engine

FILES = 8

quick = multiprocessing.get_context("forkserver")
quick.set_forkserver_preload(
    ["killed", "echocal.correct.task", "echocal.correct.parquet.file", "distributed", "s3fs"]
)


def model(offset: float = 2e-3) -> echocal.Model:
    return echocal.Model("linear", {"zero_error": {"offset": offset}})


def make_logs(folder: Path, random: np.random.Generator, rows: int) -> Path:
    """Files of two kinds, in folders; the first has so many rows, the next one more."""
    for number in range(FILES):
        count = rows + number
        table = pd.DataFrame(
            {
                "echo_us": np.round(random.uniform(2000, 20_000, count), 1),
                "temperature_C": np.round(random.uniform(0, 30, count), 2),
            }
        )
        below = folder / f"month={number % 2}"
        below.mkdir(parents=True, exist_ok=True)
        if number % 3:
            table.to_parquet(below / f"{number}.parquet", row_group_size=rows // 4)
        else:
            table.to_csv(below / f"{number}.csv", index=False)
    return folder


def contents(out: Path) -> dict[str, bytes]:
    """All files but what a run notes for itself."""
    found = {}
    for path in out.rglob("*"):
        if path.is_file() and "_echocal" not in path.parts:
            found[path.relative_to(out).as_posix()] = path.read_bytes()
    return found


def check_partial(out: Path, *wholes: dict[str, bytes]) -> None:
    """What has the name of an output is whole, as one of the requests makes it."""
    for path in out.rglob("*"):
        if path.is_file() and "_echocal" not in path.parts and not path.name.endswith(".unfinished"):
            name = path.relative_to(out).as_posix()
            try:
                found = path.read_bytes()
            except FileNotFoundError:
                continue  # it went between the two lines
            assert found in [whole[name] for whole in wholes], f"{name} is not whole"


def check_whole(out: Path, whole: dict[str, bytes], summary: Summary, rows: int) -> None:
    """All files, nothing else, and each row once."""
    total = sum(rows + number for number in range(FILES))
    assert contents(out) == whole
    assert not summary.set_aside
    assert summary.rows == total
    assert sorted(path.name for path in (out / "_echocal").iterdir()) == ["lock", "manifest.jsonl"]
    lines = [json.loads(line) for line in (out / "_echocal" / "manifest.jsonl").read_text().splitlines()]
    assert sorted(line["place"] for line in lines[1:]) == sorted(whole)
    assert sum(line["rows"] for line in lines[1:]) == total


def begin(work: Callable[..., None], *given: Any) -> Any:
    """Begin a process with a session of its own, which its processes share."""
    here, there = quick.Pipe(duplex=False)
    run = quick.Process(target=_begun, args=(there, work, given))
    run.start()
    there.close()
    with here:
        assert here.recv() == "begun"
    return run


def _begun(told: Any, work: Callable[..., None], given: tuple[Any, ...]) -> None:
    os.setsid()
    told.send("begun")
    told.close()
    work(*given)


def correct(logs: Path, out: Path, engine: str, workers: int, offset: float = 2e-3) -> None:
    with open_engine(engine, workers) as own:
        correct_files(logs, out, model(offset), engine=own)


def await_files(out: Path, count: int) -> float:
    """Wait until so many files are done, or the run has begun its manifest [s]."""
    start, manifest = time.monotonic(), out / "_echocal" / "manifest.jsonl"
    while time.monotonic() - start < 30:
        if manifest.exists() and manifest.read_text().count("\n") > count:
            break
        time.sleep(0.002)
    return time.monotonic() - start


def await_end(group: int) -> None:
    """Wait until all processes of a group have ended."""
    begun = time.monotonic()
    while lives(group):
        if time.monotonic() - begun > 20:
            os.killpg(group, signal.SIGKILL)
            pytest.fail("workers outlive their run")
        time.sleep(0.02)


def lives(group: int) -> bool:
    """Whether a process of a group runs; one that has ended and is not yet reaped does not."""
    try:
        os.killpg(group, 0)
    except ProcessLookupError:
        return False
    states = []
    for file in Path("/proc").glob("[0-9]*/stat"):
        with suppress(OSError):
            state, _, own = file.read_text().rpartition(")")[2].split()[:3]
            states.append(state if int(own) == group else "Z")
    return not states or set(states) > {"Z"}


@contextmanager
def stopped(pids: list[int]) -> Iterator[None]:
    """Processes that do nothing for the time of a block, wherever they are in their work."""
    for pid in pids:
        os.kill(pid, signal.SIGSTOP)
    try:
        yield
    finally:
        for pid in pids:
            os.kill(pid, signal.SIGCONT)
