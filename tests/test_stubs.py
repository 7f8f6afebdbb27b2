"""The type stub of the compiled core says exactly what is there."""

import subprocess
import sys
from pathlib import Path

import pytest

# PyO3 lists the public names at run time; in a stub they are public without a list.
ALLOWED = "echocal._core.__all__\n"


@pytest.mark.slow
def test_the_stub_is_complete_and_true(tmp_path: Path) -> None:
    allowed = tmp_path / "allowed.txt"
    allowed.write_text(ALLOWED)
    run = subprocess.run(
        [sys.executable, "-m", "mypy.stubtest", "echocal._core", "--concise", "--allowlist", str(allowed)],
        capture_output=True,
        text=True,
        check=False,
    )
    assert run.returncode == 0, run.stdout + run.stderr
