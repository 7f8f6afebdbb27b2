"""A run that is stopped anywhere and begun again ends with the same files."""

import json
import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pandas as pd
import pyarrow.parquet as pq
import pytest

import echocal
from echocal.correct import correct_files
from echocal.correct.driver import Progress
from echocal.correct.task import run_task

MODEL = echocal.Model("linear", {"zero_error": {"offset": 2e-3}})
OTHER = echocal.Model("linear", {"zero_error": {"offset": 3e-3}})
FILES = 6

RUN = """
import sys
import echocal
from echocal.correct import correct_files
from echocal.engines import open_engine
model = echocal.Model("linear", {"zero_error": {"offset": 2e-3}})
with open_engine("local", int(sys.argv[3])) as engine:
    summary = correct_files(sys.argv[1], sys.argv[2], model, engine=engine)
sys.exit(3 if summary.set_aside else 0)
"""


@pytest.fixture
def logs(tmp_path: Path, random: np.random.Generator) -> Path:
    """Files of two kinds, in folders."""
    for number in range(FILES):
        rows = 20_000 + number
        table = pd.DataFrame(
            {
                "echo_us": np.round(random.uniform(2000, 20_000, rows), 1),
                "temperature_C": np.round(random.uniform(0, 30, rows), 2),
            }
        )
        folder = tmp_path / "in" / f"month={number % 2}"
        folder.mkdir(parents=True, exist_ok=True)
        if number % 3:
            table.to_parquet(folder / f"{number}.parquet", row_group_size=5000)
        else:
            table.to_csv(folder / f"{number}.csv", index=False)
    return tmp_path / "in"


def contents(out: Path) -> dict[str, bytes]:
    """All files but what a run notes for itself."""
    files = (path for path in out.rglob("*") if path.is_file() and "_echocal" not in path.parts)
    return {path.relative_to(out).as_posix(): path.read_bytes() for path in files}


@pytest.fixture
def whole(logs: Path, tmp_path: Path) -> dict[str, bytes]:
    """The outputs of a run that nothing stops."""
    assert not correct_files(logs, tmp_path / "whole", MODEL).set_aside
    return contents(tmp_path / "whole")


def lines(out: Path) -> list[dict[str, object]]:
    return [json.loads(line) for line in (out / "_echocal" / "manifest.jsonl").read_text().splitlines()]


def test_what_is_done_is_not_done_again(logs: Path, whole: dict[str, bytes], tmp_path: Path) -> None:
    out = tmp_path / "whole"
    times = {path: path.stat().st_mtime_ns for path in out.rglob("*.parquet")}
    summary = correct_files(logs, out, MODEL)
    assert summary.skipped == FILES
    assert summary.rows == sum(20_000 + number for number in range(FILES))
    assert times == {path: path.stat().st_mtime_ns for path in out.rglob("*.parquet")}
    facts = lines(out)[1:]
    assert {line["rows"] for line in facts} == {20_000 + number for number in range(FILES)}
    assert all(len(line["input"]["sha256"]) == 64 for line in facts)  # type: ignore[index]


def test_an_input_that_changed_is_done_again(logs: Path, whole: dict[str, bytes], tmp_path: Path) -> None:
    out, changed = tmp_path / "whole", logs / "month=0" / "0.csv"
    before = changed.read_text()
    changed.write_text(before)  # another time, the same content
    assert correct_files(logs, out, MODEL).skipped == FILES
    first = before.splitlines()[1]
    other = first[:-1] + ("1" if first[-1] != "1" else "2")
    changed.write_text(before.replace(first, other, 1))
    assert changed.stat().st_size == len(before)
    assert correct_files(logs, out, MODEL).skipped == FILES - 1
    assert sorted(str(line["place"]) for line in lines(out)[1:]) == sorted(whole)  # one line for each


@pytest.mark.parametrize("damage", ["cut", "gone"])
def test_an_output_that_is_not_whole_is_made_again(
    damage: str, logs: Path, whole: dict[str, bytes], tmp_path: Path
) -> None:
    out = tmp_path / "whole"
    victim = out / "month=1" / "1.parquet"
    if damage == "cut":
        victim.write_bytes(victim.read_bytes()[:1000])
    else:
        victim.unlink()
    assert correct_files(logs, out, MODEL).skipped == FILES - 1
    assert contents(out) == whole


def test_another_model_is_refused(logs: Path, whole: dict[str, bytes], tmp_path: Path) -> None:
    out = tmp_path / "whole"
    with pytest.raises(echocal.UsageError, match=r"begun with another model; .*force=True"):
        correct_files(logs, out, OTHER)
    with pytest.raises(echocal.UsageError, match=r"begun with other options; .*force=True"):
        correct_files(logs, out, MODEL, reading_speed="343")
    assert contents(out) == whole
    assert correct_files(logs, out, OTHER, force=True).skipped == 0
    assert contents(out) != whole


def test_a_line_that_a_crash_cut_off_is_no_line(logs: Path, whole: dict[str, bytes], tmp_path: Path) -> None:
    manifest = tmp_path / "whole" / "_echocal" / "manifest.jsonl"
    manifest.write_bytes(manifest.read_bytes()[:-40])
    assert correct_files(logs, tmp_path / "whole", MODEL).skipped == FILES - 1
    assert contents(tmp_path / "whole") == whole
    assert len(lines(tmp_path / "whole")) == FILES + 1


@pytest.mark.slow
@pytest.mark.parametrize("workers", ["1", "2"])
def test_a_full_disk(workers: str, logs: Path, whole: dict[str, bytes], tmp_path: Path) -> None:
    limit = (
        "import resource; resource.setrlimit(resource.RLIMIT_FSIZE, (100_000, resource.RLIM_INFINITY))\n"
        "import echocal.errors\n"
    )
    out = tmp_path / "out"
    command = [sys.executable, "-c", limit + RUN, str(logs), str(out), workers]
    told = subprocess.run(command, capture_output=True, text=True, check=False)
    assert told.returncode != 0
    assert "cannot be written: File too large" in told.stderr
    assert contents(out) == {}
    assert not correct_files(logs, out, MODEL).set_aside
    assert contents(out) == whole


@pytest.mark.slow
def test_two_runs_on_one_output(logs: Path, whole: dict[str, bytes], tmp_path: Path) -> None:
    out = tmp_path / "out"
    told: list[str] = []

    def second(state: Progress) -> None:
        if state.files == 1 and not told:
            command = [sys.executable, "-c", RUN, str(logs), str(out), "1"]
            told.append(subprocess.run(command, capture_output=True, text=True, check=False).stderr)
            assert f"is being written by process {os.getpid()} on" in told[0]

    correct_files(logs, out, MODEL, progress=second)
    assert told
    assert contents(out) == whole


@pytest.mark.slow
def test_two_runs_that_begin_together(logs: Path, whole: dict[str, bytes], tmp_path: Path) -> None:
    out = tmp_path / "out"
    command = [sys.executable, "-c", RUN, str(logs), str(out), "1"]
    runs = [subprocess.Popen(command, stderr=subprocess.PIPE, text=True) for _ in range(3)]
    said = [run.communicate(timeout=60)[1] for run in runs]
    assert 0 in {run.returncode for run in runs}
    for run, text in zip(runs, said, strict=True):  # a later one may begin when the first has ended
        assert run.returncode == 0 or "is being written by" in text
    assert contents(out) == whole
    assert len(lines(out)) == FILES + 1


def test_damaged_files_are_set_aside(logs: Path, whole: dict[str, bytes], tmp_path: Path) -> None:
    good = (logs / "month=1" / "1.parquet").read_bytes()
    (logs / "cut.parquet").write_bytes(good[: len(good) // 2])
    (logs / "empty.parquet").write_bytes(b"")
    (logs / "text.parquet").write_text("no table")
    footer = int.from_bytes(good[-8:-4], "little")
    page = bytearray(good)
    page[4 : len(page) - footer - 8] = bytes(len(page) - footer - 12)
    (logs / "page.parquet").write_bytes(bytes(page))
    (logs / "quote.csv").write_text('echo_us,temperature_C\n11660,"20\n11660,20\n')
    summary = correct_files(logs, tmp_path / "out", MODEL)
    assert {Path(path).name for path in summary.set_aside} == {
        "cut.parquet", "empty.parquet", "text.parquet", "page.parquet", "quote.csv"
    }  # fmt: skip
    assert contents(tmp_path / "out") == whole
    kept = {line["place"]: line["error"] for line in lines(tmp_path / "out")[1:]}
    assert "truncated or damaged" in kept["cut.parquet"]["text"]  # type: ignore[index]
    (logs / "cut.parquet").write_bytes(good)  # mended: it alone, and those set aside, are tried again
    assert correct_files(logs, tmp_path / "out", MODEL).skipped == FILES
    assert (tmp_path / "out" / "cut.parquet").read_bytes() == whole["month=1/1.parquet"]


def test_a_task_is_plain_data(logs: Path, tmp_path: Path) -> None:
    """A task can be sent as text to any machine, and makes the same file there."""
    seen: list[str] = []

    class Elsewhere:
        name, inside = "elsewhere", False

        def run(self, work, tasks):  # type: ignore[no-untyped-def]
            for task in tasks:
                seen.append(json.dumps(task))
                yield task, json.loads(json.dumps(work(json.loads(seen[-1]))))

        def ask(self, question, *given):  # type: ignore[no-untyped-def]
            return {"the only one": question(*json.loads(json.dumps(given)))}

    correct_files(logs, tmp_path / "out", MODEL, engine=Elsewhere())
    before = contents(tmp_path / "out")
    for task in seen:
        assert run_task(json.loads(task))["error"] is None
    assert contents(tmp_path / "out") == before
    other = {**json.loads(seen[0]), "version": "0.0.0"}
    assert "install the same version everywhere" in run_task(other)["error"]["text"]
    other = {**json.loads(seen[0]), "digest": OTHER.hash}
    assert "not those that the run was begun with" in run_task(other)["error"]["text"]
    assert (
        pq.ParquetFile(tmp_path / "out" / "month=1" / "1.parquet").metadata.metadata[b"echocal.model_hash"]
        == MODEL.hash.encode()
    )
