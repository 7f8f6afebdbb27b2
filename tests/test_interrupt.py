"""Ctrl-C ends a command without a traceback, also while it is still being imported."""

import os
import signal
import subprocess
import sys
from pathlib import Path

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
