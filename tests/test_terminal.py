"""The commands in terminals that cannot show every sign, and on machines with little memory."""

import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

EXAMPLE = Path(__file__).parents[1] / "examples" / "study_table2.csv"


def _slow(value: str) -> object:
    return pytest.param(value, marks=pytest.mark.slow)


@pytest.mark.parametrize("encoding", ["ascii", _slow("cp1252"), _slow("cp437")])
@pytest.mark.parametrize("command", [_slow("study"), "effects", f"diagnose {EXAMPLE}"])
def test_a_narrow_encoding_is_no_error(command: str, encoding: str) -> None:
    environment = {**os.environ, "PYTHONIOENCODING": encoding}
    words = [sys.executable, "-m", "echocal", *command.split()]
    run = subprocess.run(words, env=environment, capture_output=True, check=False)
    assert (run.returncode, run.stderr) == (0, b"")
    shown = run.stdout.decode(encoding)
    if command == "study":
        assert "331.300 x" in shown
        assert "\\u" not in shown


def test_a_file_name_that_no_encoding_has_can_be_told(tmp_path: Path) -> None:
    name = os.fsdecode(b"caf\xe9.csv")
    words = [
        sys.executable,
        "-m",
        "echocal",
        "correct",
        str(EXAMPLE),
        "--law",
        "linear",
        "--reading-speed",
        "linear",
        "-o",
        name,
    ]
    run = subprocess.run(words, cwd=tmp_path, capture_output=True, text=True, check=False)
    assert (run.returncode, run.stderr) == (0, "")
    assert (tmp_path / name).is_file()


@pytest.mark.slow
def test_memory_that_runs_out_is_one_line() -> None:
    limited = "import resource; resource.setrlimit(resource.RLIMIT_AS, (2 * 2**30, 2 * 2**30)); import sys; "
    limited += "sys.argv = ['echocal', *sys.argv[1:]]; from echocal.cli import main; main()"
    words = ["sweep", "--temperature", "0:50:0.001", "--distance", "0.01:4:0.0025"]  # 8e7 points
    run = subprocess.run([sys.executable, "-c", limited, *words], capture_output=True, text=True, check=False)
    assert run.returncode == 3
    assert run.stderr.startswith("echocal: memory ran out")
    assert run.stderr.count("\n") == 1


@pytest.mark.parametrize("sign", ["\x1b]0;pwned\x07", "\x1b[2J", "\x9b31m", "\n", "\r", "\u202e", "\x7f"])
def test_a_message_shows_the_signs_that_would_steer_the_terminal(sign: str, tmp_path: Path) -> None:
    words = [sys.executable, "-m", "echocal", "inspect", f"no{sign}file.csv"]
    run = subprocess.run(words, cwd=tmp_path, capture_output=True, check=False, timeout=60)
    said = run.stderr.decode()
    assert run.returncode != 0
    assert said.endswith("\n")
    assert said.removesuffix("\n").isprintable()
    assert f"no{ascii(sign)[1:-1]}file.csv" in said


@pytest.mark.parametrize("command", ["inspect", "correct", "diagnose"])
def test_names_of_columns_files_and_sensors_steer_no_terminal(
    command: str, random: np.random.Generator, tmp_path: Path
) -> None:
    """They come from other people: notes, tables and reports show their signs."""
    signs = random.permutation(
        ["\x1b[2J", "\x1b]0;x\x07", "\x9b31m", "\x7f", "\u202e", "\x08", "\u2028"]
    ).tolist()
    name, *rest = (f"a{sign}b" for sign in signs)
    log = tmp_path / "in" / f"{name}.csv"
    log.parent.mkdir()
    rows = [f"{random.uniform(9000, 12000):.0f},2.0,20,{random.normal():.3f},{rest[1]}" for _ in range(30)]
    log.write_text("\n".join([f"echo_us,distance_m,temperature_C,{rest[0]},kind", *rows, ""]), "utf-8")
    (log.parent / f"{rest[2]}.csv").write_text("echo_us,temperature_C\n11660,20\n", "utf-8")
    (log.parent / f"{rest[3]}.txt").write_text("nothing\n")
    (log.parent / f"{rest[4]}.parquet").write_bytes(b"PAR1 is cut")
    words = ["in", "-o", "out"] if command == "correct" else [f"in/{name}.csv"]
    words = [sys.executable, "-m", "echocal", command, *words]
    run = subprocess.run(words, cwd=tmp_path, capture_output=True, check=False, timeout=120)
    for said in (run.stdout.decode(), run.stderr.decode()):
        assert [line for line in said.split("\n") if not line.isprintable()] == []
    if command == "correct":
        told = run.stderr.decode()
        assert run.returncode == 3
        assert all(f"a{ascii(sign)[1:-1]}b" in told for sign in (signs[1], *signs[4:6]))
