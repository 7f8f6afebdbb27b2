"""Whoever waits for a diagnosis is told how far it is, and nobody else."""

import os
import pty
import subprocess
import sys
from pathlib import Path

import echocal
from echocal.diagnose.progress import STAGES

TABLE = Path(__file__).parents[1] / "examples" / "study_table2.csv"


def test_a_listener_hears_every_stage_once_and_in_order() -> None:
    heard: list[tuple[str, int, int]] = []
    echocal.diagnose(TABLE, progress=lambda *said: heard.append(said))
    assert [what for what, _, _ in heard] == [*STAGES, "done"]
    assert [done for _, done, _ in heard] == list(range(len(STAGES) + 1))
    assert {total for _, _, total in heard} == {len(STAGES)}


def test_listening_changes_nothing() -> None:
    quiet, told = (
        echocal.diagnose(TABLE, progress=progress).to_dict() for progress in (None, lambda *_: None)
    )
    quiet.pop("seconds"), told.pop("seconds")
    assert quiet == told


def on_a_terminal(*arguments: str) -> tuple[str, str]:
    """What a run writes to stdout, a pipe, and to stderr, a terminal."""
    leader, follower = pty.openpty()
    command = [sys.executable, "-m", "echocal", "diagnose", str(TABLE), *arguments]
    environment = {**os.environ, "TERM": "xterm", "COLUMNS": "100"}
    process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=follower, env=environment)
    os.close(follower)
    seen = b""
    while True:
        try:
            chunk = os.read(leader, 4096)
        except OSError:  # Linux: the other end is closed
            break
        if not chunk:
            break
        seen += chunk
    os.close(leader)
    assert process.stdout is not None
    said = process.stdout.read().decode()
    process.stdout.close()
    assert process.wait(120) == 0
    return said, seen.decode()


def test_a_terminal_shows_a_bar_and_the_report_has_none_of_it() -> None:
    said, seen = on_a_terminal()
    assert any(stage in seen for stage in STAGES)
    assert f"/{len(STAGES)}" in seen
    assert "fixed_speed" in said
    assert not any(stage in said for stage in STAGES[1:])  # "reading" is a word of reports, too


def test_quiet_is_quiet_on_a_terminal_too() -> None:
    assert on_a_terminal("--quiet") == ("", "")


def test_a_log_gets_no_bar() -> None:
    command = [sys.executable, "-m", "echocal", "diagnose", str(TABLE), "--json", "-"]
    done = subprocess.run(command, capture_output=True, text=True, check=True, timeout=120)
    assert done.stderr == ""
