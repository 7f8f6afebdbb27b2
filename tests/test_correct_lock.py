"""The lock of an output: whose it is while processes are started and killed."""

import os
import subprocess
import sys
import time
from pathlib import Path

import pytest

from echocal.correct import manifest
from echocal.correct.manifest import locked
from echocal.errors import UsageError

fcntl = pytest.importorskip("fcntl")

OWNER = """
import os, sys, time
from pathlib import Path
from echocal.correct.manifest import locked
with locked(Path(sys.argv[1])):
    if os.fork() == 0:  # a process that has not run its own program yet
        time.sleep(float(sys.argv[2]))
        os._exit(0)
    print("started", flush=True)
    time.sleep(60)
"""

DONE = """
import os, sys, time
from pathlib import Path
from echocal.correct.manifest import locked
with locked(Path(sys.argv[1])):
    if os.fork() == 0:
        time.sleep(5)
        os._exit(0)
print("done", flush=True)
time.sleep(60)
"""


def killed_owner(file: Path, shared_for: float) -> int:
    """An owner that is killed while a process that it started shares its lock."""
    owner = subprocess.Popen(
        [sys.executable, "-c", OWNER, str(file), str(shared_for)], stdout=subprocess.PIPE, text=True
    )
    assert owner.stdout is not None
    assert owner.stdout.readline() == "started\n"
    owner.kill()
    owner.wait()
    return owner.pid


def test_a_killed_owner_is_waited_for(tmp_path: Path) -> None:
    killed_owner(tmp_path / "out" / "lock", 1.0)
    begun = time.monotonic()
    with locked(tmp_path / "out" / "lock"):
        assert time.monotonic() - begun > 0.1


def test_the_wait_ends(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(manifest, "PATIENCE", 0.2)
    owner = killed_owner(tmp_path / "out" / "lock", 20.0)
    with pytest.raises(UsageError, match=f"by process {owner} on"), locked(tmp_path / "out" / "lock"):
        pass


def test_a_living_owner_is_told_at_once(tmp_path: Path) -> None:
    begun = time.monotonic()
    with (
        locked(tmp_path / "out" / "lock"),
        pytest.raises(UsageError, match=f"by process {os.getpid()} on"),
        locked(tmp_path / "out" / "lock"),
    ):
        pass
    assert time.monotonic() - begun < manifest.PATIENCE / 2


def test_what_a_run_has_started_does_not_keep_its_lock(tmp_path: Path) -> None:
    owner = subprocess.Popen([sys.executable, "-c", DONE, str(tmp_path / "lock")], stdout=subprocess.PIPE)
    assert owner.stdout is not None
    assert owner.stdout.readline() == b"done\n"
    with locked(tmp_path / "lock"):
        pass
    assert owner.poll() is None
    owner.kill()
    owner.wait()
