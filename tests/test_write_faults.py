"""A disk that is full or broken: an output is whole or absent, and what was there stays."""

import errno
import os
import resource
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from watched import csv, log

import echocal
from echocal.errors import UsageError

MODEL = echocal.Model("linear", {"zero_error": {"offset": 2e-3}})
FAULTS = 12  # sizes at which each output is cut


@contextmanager
def at_most(size: int) -> Iterator[None]:
    """No file can grow beyond so many bytes, as if the disk were full."""
    before = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (size, before[1]))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, before)


@pytest.fixture(autouse=True)
def source(tmp_path: Path, random: np.random.Generator, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    Path("log.csv").write_text(csv(log(random, 400)))


WRITERS: dict[str, Callable[[str], object]] = {
    "out.csv": lambda name: echocal.correct_files("log.csv", name, MODEL, processes=1),
    "out.csv.gz": lambda name: echocal.correct_files("log.csv", name, MODEL, processes=1),
    "out.parquet": lambda name: echocal.correct_files("log.csv", name, MODEL, processes=1),
    "model.json": lambda name: MODEL.save(name),
}


@pytest.mark.parametrize("name", WRITERS)
@pytest.mark.parametrize("old", [b"", b"what was there"])
def test_a_full_disk_leaves_an_output_whole_or_as_it_was(
    name: str, old: bytes, random: np.random.Generator
) -> None:
    make = WRITERS[name]
    make(name)
    whole = Path(name).stat().st_size
    for size in {0, 1, whole - 1, *random.integers(whole, size=FAULTS).tolist()}:
        Path(name).unlink(missing_ok=True)
        if old:
            Path(name).write_bytes(old)
        with at_most(size), pytest.raises(UsageError, match="cannot be written"):
            make(name)
        assert (Path(name).read_bytes() if Path(name).exists() else b"") == old
        assert not list(Path().glob(".*.unfinished"))


@pytest.mark.parametrize("name", WRITERS)
@pytest.mark.parametrize("call", ["fsync", "replace"])
@pytest.mark.parametrize("code", [errno.EIO, errno.ENOSPC])
def test_a_disk_that_fails_at_the_end(
    name: str, call: str, code: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    Path(name).write_bytes(b"what was there")

    def fail(*_: Any, **__: Any) -> None:
        raise OSError(code, os.strerror(code))

    monkeypatch.setattr(os, call, fail)
    with pytest.raises(UsageError, match=f"cannot be written: {os.strerror(code)}"):
        WRITERS[name](name)
    assert Path(name).read_bytes() == b"what was there"
    assert not list(Path().glob(".*.unfinished"))


def test_a_watch_goes_on_after_a_full_disk(
    run: Callable[..., tuple[int, str]], random: np.random.Generator
) -> None:
    words = ("watch", "log.csv", "--law", "linear", "--once", "--correct-only")
    assert run(*words, "-o", "whole.csv", "--state", "whole.db")[0] == 0
    whole = Path("whole.csv").read_bytes()
    for number, size in enumerate(random.integers(len(whole), size=4).tolist()):
        mine = ("-o", f"{number}.csv", "--state", f"{number}.db")
        with at_most(size):
            code, told = run(*words, *mine)
        assert code in (2, 3), told
        assert "Traceback" not in told
        code, told = run(*words, *mine)
        assert code == 0, told
        assert Path(f"{number}.csv").read_bytes() == whole
