"""How many threads the core uses, as the environment says."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

SUM = """
import numpy as np, echocal
from pathlib import Path
most = 0
def count():
    global most
    most = max(most, len(list(Path("/proc/self/task").iterdir())))
import threading
stop = threading.Event()
watch = threading.Thread(target=lambda: [count() for _ in iter(stop.is_set, True)])
before = len(list(Path("/proc/self/task").iterdir()))
watch.start()
t = np.linspace(1e-3, 2e-2, 20_000_000)
d = echocal.distance(t, 20.0, 0.5)
stop.set(); watch.join()
print(most - before - 1, d[::5_000_000].tolist())
"""


def run(value: str | None, code: str) -> subprocess.CompletedProcess[str]:
    known = {name: own for name, own in os.environ.items() if name != "ECHOCAL_NUM_THREADS"}
    given = known if value is None else known | {"ECHOCAL_NUM_THREADS": value}
    return subprocess.run(
        [sys.executable, "-c", code], env=given, capture_output=True, text=True, check=False
    )


@pytest.mark.skipif(not Path("/proc/self/task").is_dir(), reason="counts threads as Linux lists them")
def test_one_thread_is_one_thread_and_changes_no_bit() -> None:
    alone, free = (run(value, SUM).stdout.partition(" ") for value in ("1", None))
    assert int(alone[0]) == 0
    seen = []
    for _ in range(8):  # on a busy machine a thread may begin and end unseen
        three = run("3", SUM).stdout.partition(" ")
        assert alone[2] == three[2] == free[2] != ""
        seen.append(int(three[0]))
        if max(seen) == 2:
            break
    assert max(seen) == 2, seen


@pytest.mark.parametrize("value", ["0", "-1", "two", "1.5"])
def test_what_is_no_number_of_threads_is_refused(value: str) -> None:
    done = run(value, "import echocal")
    assert done.returncode == 1
    assert f'ECHOCAL_NUM_THREADS is "{value}"; give the most threads' in done.stderr


def test_an_empty_value_is_none() -> None:
    assert run("", "import echocal").returncode == 0
