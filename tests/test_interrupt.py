"""Ctrl-C and a request to terminate end a command without a traceback, and leave nothing unfinished."""

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pandas as pd
import pytest


@pytest.mark.parametrize("during", ["numpy", "typer"])
def test_ctrl_c_during_imports_leaves_no_traceback(during: str, tmp_path: Path) -> None:
    (tmp_path / f"{during}.py").write_text("raise KeyboardInterrupt\n")
    search = {**os.environ, "PYTHONPATH": str(tmp_path)}
    command = [sys.executable, "-m", "echocal", "--help"]
    run = subprocess.run(command, env=search, capture_output=True, text=True, check=False)
    assert run.stderr == ""
    assert run.returncode in {-signal.SIGINT, 130}  # a shell tells 130 for both


def test_whoever_imports_echocal_keeps_the_traceback(tmp_path: Path) -> None:
    (tmp_path / "numpy.py").write_text("raise KeyboardInterrupt\n")
    search = {**os.environ, "PYTHONPATH": str(tmp_path)}
    command = [sys.executable, "-c", "import echocal; echocal.Model"]
    run = subprocess.run(command, env=search, capture_output=True, text=True, check=False)
    assert "Traceback" in run.stderr


COMMANDS = {
    "a text": "correct one.csv -o out.csv --law linear",
    "a packed text": "correct one.csv -o out.csv.gz --law linear",
    "Parquet": "correct one.parquet -o out.parquet --law linear",
    "a text of Parquet": "correct one.parquet -o out.csv --law linear",
    "a folder": "correct in -o out --law linear --processes 1",
    "a folder, by processes": "correct in -o out --law linear --processes 2",
    "a sweep": "sweep --temperature 0:50:0.01 --distance 0.1:4:0.01 -o out.csv",
}


@pytest.fixture(scope="module")
def logs(tmp_path_factory: pytest.TempPathFactory, request: pytest.FixtureRequest, seeded) -> Path:  # type: ignore[no-untyped-def]
    random, folder = seeded(request), tmp_path_factory.mktemp("logs")
    rows = 500_000
    echoes, degrees = np.round(random.uniform(2000, 20_000, rows)), np.round(random.uniform(0, 30, rows), 1)
    table = pd.DataFrame({"echo_us": echoes, "temperature_C": degrees, "id": np.arange(rows)})
    (folder / "in").mkdir()
    for number in range(6):
        table.to_parquet(folder / "in" / f"{number}.parquet", row_group_size=100_000)
    table = pd.concat([table] * 4)
    table.to_parquet(folder / "one.parquet", row_group_size=100_000)
    table.to_csv(folder / "one.csv", index=False)
    return folder


@pytest.mark.skipif(sys.platform == "win32", reason="signals of POSIX")
@pytest.mark.parametrize("request_", ["SIGTERM", "SIGHUP"])
@pytest.mark.parametrize("name", COMMANDS)
def test_a_request_to_terminate_leaves_nothing_unfinished(
    name: str, request_: str, logs: Path, tmp_path: Path, random: np.random.Generator
) -> None:
    for path in logs.iterdir():
        (tmp_path / path.name).symlink_to(path)
    words = [sys.executable, "-m", "echocal", *COMMANDS[name].split()]
    number = getattr(signal, request_)
    heard = lambda: signal.signal(number, signal.SIG_DFL)  # noqa: E731  (under nohup one is ignored)
    pipes = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE, "text": True}
    run = subprocess.Popen(words, cwd=tmp_path, start_new_session=True, preexec_fn=heard, **pipes)
    begun = time.monotonic()
    while run.poll() is None and not list(tmp_path.rglob(".*.unfinished")):
        assert time.monotonic() - begun < 60
        time.sleep(0.002)
    time.sleep(float(random.uniform(0, 0.1)))
    run.send_signal(number)
    told = run.communicate(timeout=60)[1]
    assert "Traceback" not in told
    assert run.returncode in {128 + number, 0}  # it may have ended before
    assert not list(tmp_path.rglob(".*.unfinished"))
    if run.returncode and "folder" not in name:
        assert not list(tmp_path.glob("out*"))
    if run.returncode and "folder" in name:
        time.sleep(0.3)  # a process that outlives its run would go on writing
        assert not list(tmp_path.rglob(".*.unfinished"))
        subprocess.run(words, cwd=tmp_path, capture_output=True, check=True)  # it goes on where it was


@pytest.mark.skipif(sys.platform == "win32", reason="signals of POSIX")
def test_what_is_to_outlive_its_terminal_does(logs: Path, tmp_path: Path) -> None:
    """As after nohup."""
    ignoring = "import signal, os, sys; signal.signal(signal.SIGHUP, signal.SIG_IGN); "
    ignoring += "os.execv(sys.argv[1], sys.argv[1:])"
    words = [
        sys.executable,
        "-m",
        "echocal",
        "correct",
        str(logs / "in"),
        "-o",
        "out",
        "--law",
        "linear",
        "-q",
    ]
    run = subprocess.Popen([sys.executable, "-c", ignoring, *words], cwd=tmp_path)
    begun = time.monotonic()
    while run.poll() is None and not list(tmp_path.rglob(".*.unfinished")):
        assert time.monotonic() - begun < 60
        time.sleep(0.002)
    run.send_signal(signal.SIGHUP)
    assert run.wait(60) == 0


@pytest.mark.skipif(sys.platform == "win32", reason="signals of POSIX")
def test_an_import_is_finished_before_a_request_ends_it(tmp_path: Path) -> None:
    """Else its locks would stay closed, and threads that import wait for ever, as those of a pool do."""
    asked = "import os, signal\nos.kill(os.getpid(), signal.SIGTERM)\nprint('whole', flush=True)\n"
    (tmp_path / "asked.py").write_text(asked)
    program = "from echocal._interrupt import unwind_when_told\nunwind_when_told()\n"
    program += "import time, asked\ntime.sleep(30)\n"
    search = {**os.environ, "PYTHONPATH": os.pathsep.join([str(tmp_path), *sys.path])}
    words = [sys.executable, "-c", program]
    run = subprocess.run(words, env=search, capture_output=True, text=True, timeout=20, check=False)
    assert (run.returncode, run.stdout, run.stderr) == (128 + signal.SIGTERM, "whole\n", "")


@pytest.mark.skipif(sys.platform == "win32", reason="signals of POSIX")
def test_an_import_cannot_swallow_ctrl_c(tmp_path: Path) -> None:
    """As callbacks of an import do, of which Python ignores all errors."""
    asked = "import os, signal\ntry:\n os.kill(os.getpid(), signal.SIGINT)\nexcept BaseException:\n pass\n"
    (tmp_path / "asked.py").write_text(asked)
    (tmp_path / "echocal").write_text("import echocal, time, asked\ntime.sleep(30)\n")
    search = {**os.environ, "PYTHONPATH": os.pathsep.join([str(tmp_path), *sys.path])}
    words = [sys.executable, str(tmp_path / "echocal")]
    run = subprocess.run(words, env=search, capture_output=True, text=True, timeout=20, check=False)
    assert (run.returncode, run.stdout, run.stderr) == (-signal.SIGINT, "", "")
