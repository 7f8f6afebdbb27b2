"""`echocal watch`: where rows come from, what is written, how it stops and goes on."""

import contextlib
import json
import os
import signal
import sqlite3
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from brokers import broker
from watched import csv, log

import echocal
from echocal.cli.watch import _Stop

__all__ = ["broker"]

Run = Callable[..., tuple[int, str]]
WATCH = [sys.executable, "-m", "echocal", "watch"]


def lines(path: Path) -> list[dict[str, Any]]:
    return [json.loads(line) for line in path.read_text().splitlines()]


@pytest.mark.parametrize(
    ("files", "source", "said"),
    [
        ({"log.csv": ""}, "log.csv", "log.csv is empty"),
        ({"logs/a.csv": "", "logs/b.csv": ""}, "logs", "logs/a.csv is empty"),
        ({"logs/a.txt": ""}, "logs", "logs has no file to watch; endings: .csv"),
    ],
)
@pytest.mark.parametrize("state", [[], ["--state", "s.db"]])
def test_a_watch_of_nothing_is_no_success(
    files: dict[str, str], source: str, said: str, state: list[str], run: Run, tmp_path: Path
) -> None:
    (tmp_path / "logs").mkdir()
    for name, text in files.items():
        (tmp_path / name).write_text(text)
    code, told = run("watch", source, "--law", "cramer", "--once", "--correct-only", *state)
    assert (code, told.splitlines()[-1][: len(said) + 9]) == (3, f"echocal: {said}")
    (tmp_path / "header.csv").write_text("echo_us,temperature_C\n")
    code, told = run("watch", "header.csv", "--law", "cramer", "--once", "--correct-only", *state)
    assert "header.csv has no row" in told
    assert code == (0 if state else 3)  # with a state the next start goes on


@pytest.mark.parametrize(
    "asked", ["--column redings_m=reading_m", "--trust reeding_m", "--missing reading_mm=-1", "--by reading"]
)
def test_a_misspelled_column_is_told(asked: str, run: Run, tmp_path: Path) -> None:
    (tmp_path / "log.csv").write_text("time_s,reading_m,temperature_C\n0,1.5,20\n")
    code, told = run("watch", "log.csv", "--law", "cramer", "--once", "--correct-only", *asked.split(" "))
    assert (code, "did you mean 'reading_m'?" in told) == (3 if "--by" in asked else 2, True), told


def test_a_growing_file_is_read_line_by_whole_line(
    run: Run, tmp_path: Path, random: np.random.Generator
) -> None:
    rows = log(random, 40)
    text = csv(rows)
    words = ["log.csv", "--law", "linear", "--once", "-o", "out.csv", "--state", "s.db"]
    (tmp_path / "log.csv").write_text("".join(text.splitlines(keepends=True)[:11]))
    assert run("watch", *words) == (0, "10 rows, 10 corrected; 0 changes told\n")
    (tmp_path / "log.csv").write_text(text)
    assert run("watch", *words)[1].startswith("30 rows")
    assert run("watch", *words)[1].startswith("0 rows")
    table = [line.split(",") for line in (tmp_path / "out.csv").read_text().splitlines()]
    assert table[0][-3:] == ["corrected_distance_m", "distance_standard_uncertainty_m", "status"]
    assert [fields[0] for fields in table[1:]] == [row["time"] for row in rows]


def test_a_folder_of_files_that_are_added(run: Run, tmp_path: Path, random: np.random.Generator) -> None:
    rows = log(random, 30)
    (tmp_path / "in" / "deeper").mkdir(parents=True)
    (tmp_path / "in" / "1.csv").write_text(csv(rows[:10]))
    (tmp_path / "in" / ".2.csv").write_text("not a table")
    words = ["in", "--law", "linear", "--once", "-o", "out.jsonl", "--state", "s.db", "--quiet"]
    assert run("watch", *words) == (0, "")
    (tmp_path / "in" / "deeper" / "2.jsonl").write_text("".join(json.dumps(row) + "\n" for row in rows[10:]))
    assert run("watch", *words) == (0, "")
    assert [row["time"] for row in lines(tmp_path / "out.jsonl")] == [row["time"] for row in rows]


def test_stdin_and_a_last_line_without_an_end(tmp_path: Path, random: np.random.Generator) -> None:
    text = csv(log(random, 5)) + "1,2\n" + '{"echo_us": 11660, "temperature_C": 20, "time": "2027-01-01"}'
    made = subprocess.run(
        [*WATCH, "-", "--law", "linear", "-o", "-"],
        input=text,
        capture_output=True,
        text=True,
        cwd=tmp_path,
        check=False,
    )
    assert made.returncode == 0, made.stderr
    corrected = [json.loads(line) for line in made.stdout.splitlines()]
    assert [row["status"] for row in corrected] == [*[""] * 5, "temperature_C missing", ""]
    assert (corrected[5]["echo_us"], corrected[5]["corrected_distance_m"]) == ("2", None)
    assert corrected[6]["corrected_distance_m"] == pytest.approx(2.002, abs=1e-3)


@pytest.mark.slow
def test_a_watch_that_is_killed_goes_on_as_if_nothing_had_been(
    tmp_path: Path, random: np.random.Generator
) -> None:
    """SIGKILL and Ctrl-C at random moments: the same rows and events as a watch that ran through."""
    rows = log(random, 700, error=np.where(np.arange(700) < 400, 0.0, 6e-3))
    (tmp_path / "log").mkdir()
    words = ["log", "--law", "linear", "--learn", "200", "--poll", "0.05", "--state"]
    outputs = ["-o", "out.jsonl", "--json", "events.jsonl"]
    first = 0
    for number, stop in enumerate((signal.SIGKILL, signal.SIGINT, signal.SIGKILL, signal.SIGTERM)):
        watch = subprocess.Popen([*WATCH, *words, "s.db", *outputs], cwd=tmp_path, stderr=subprocess.PIPE)
        last = min(first + int(random.integers(50, 300)), len(rows))
        (tmp_path / "log" / f"{number}.csv").write_text(csv(rows[first:last]) if last > first else "")
        first = last
        time.sleep(float(random.uniform(1.0, 5.0)))
        watch.send_signal(stop)
        _, said = watch.communicate(timeout=60)
        assert b"Traceback" not in said
        if stop is not signal.SIGKILL:
            assert watch.returncode in {128 + stop, -stop}  # minus where it was still being imported
    (tmp_path / "log" / "9.csv").write_text(csv(rows[first:]) if first < len(rows) else "")
    whole = ["-o", "whole.jsonl", "--json", "whole-events.jsonl"]
    for state, files in (("s.db", outputs), ("t.db", whole)):
        subprocess.run([*WATCH, *words, state, *files, "--once", "--quiet"], cwd=tmp_path, check=True)
    assert [row["time"] for row in lines(tmp_path / "out.jsonl")] == [row["time"] for row in rows]
    assert (tmp_path / "out.jsonl").read_text() == (tmp_path / "whole.jsonl").read_text()
    events = lines(tmp_path / "events.jsonl")
    assert events == lines(tmp_path / "whole-events.jsonl")
    assert "change" in {event["event"] for event in events}


def test_a_request_to_stop_that_was_swallowed_is_not_lost() -> None:
    """The batch is finished, and then it is asked again."""
    stop = _Stop()
    with contextlib.suppress(SystemExit):  # as a library may
        stop(signal.SIGINT, None)
    finished = []
    with pytest.raises(SystemExit) as raised, stop.later():
        finished.append("batch")
    assert (finished, raised.value.code) == (["batch"], 128 + signal.SIGINT)


@pytest.mark.parametrize(
    ("words", "code", "says"),
    [
        (["absent.csv"], 2, "absent.csv does not exist; to wait for files give their folder"),
        (["a.parquet"], 2, "a.parquet cannot be watched; endings of growing files: .csv"),
        (["a.csv", "--models", "m"], 2, "name the column of the sensor's id with --by"),
        (["a.csv", "--models", "m", "--by", "id"], 2, "--models m is no folder"),
        (["a.csv", "--models", "m", "--by", "id", "--law", "linear"], 2, "--models, or one model"),
        (["a.csv", "--by", "id", "--correct-only"], 3, "a row has no sensor id in the column 'id' of --by"),
        (["a.csv", "-o", "out.parquet"], 2, "cannot write out.parquet as rows come; endings: .csv, .jsonl"),
        (["a.csv", "-o", "a.csv"], 2, "is an input of this command"),
        (["a.csv", "-o", "-", "--json", "-"], 2, "both write to stdout"),
        (["a.csv", "-o", "notes.csv", "--once"], 2, "this command did not make it"),
        (["a.csv", "--dead-letters", "notes.csv", "--once"], 2, "this command did not make it"),
        (["a.csv", "--dead-letters", "-", "--once"], 2, "--dead-letters needs a file"),
        (["a.csv", "-o", "b.jsonl", "--dead-letters", "b.jsonl"], 2, "both name b.jsonl"),
        (["in", "-o", "in/out.csv"], 2, "lies in the folder that is watched"),
        (["a.csv", "--constant-distance", "--reference-distance", "2"], 2, "contradict each other"),
        (["a.csv", "--reference-distance", "-2"], 2, "give a distance above 0 m"),
        (["a.csv", "--column", "echo=echo_us", "--once"], 2, "no row has a column 'echo'"),
        (["a.csv", "--once"], 3, "no row has a reference distance"),
        (["a.csv", "--reference-distance", "2", "--once"], 3, "no row has a time"),
        (["a.csv", "--false-alarms", "0"], 2, "give a number above 0"),
        (["a.csv", "--state", "notes.csv"], 2, "--state notes.csv cannot be used"),
        (["no-echo.csv", "--correct-only", "--once"], 3, "echo"),
    ],
)
def test_what_cannot_be_watched_is_refused(
    words: list[str], code: int, says: str, run: Run, tmp_path: Path
) -> None:
    (tmp_path / "in").mkdir()
    (tmp_path / "a.csv").write_text("echo_us,temperature_C\n11660,20\n")
    (tmp_path / "no-echo.csv").write_text("temperature_C\n20\n")
    (tmp_path / "notes.csv").write_text("mine,and not to be replaced\n" * 50)
    (tmp_path / "a.parquet").write_text("")
    got, said = run("watch", *words)
    assert says in said
    assert got == code
    assert "Traceback" not in said


def test_a_file_that_became_shorter_and_other_settings_are_refused(
    run: Run, tmp_path: Path, random: np.random.Generator
) -> None:
    rows = log(random, 9)
    (tmp_path / "log.csv").write_text(csv(rows))
    words = ["log.csv", "--law", "linear", "--once", "--state", "s.db"]
    assert run("watch", *words)[0] == 0
    code, said = run("watch", *words, "--false-alarms", "2")
    assert (code, "made with false_alarms = 0.1, this watch has 2.0" in said) == (3, True)
    (tmp_path / "log.csv").write_text(csv(rows[:4]))
    code, said = run("watch", *words)
    assert (code, "became shorter" in said) == (3, True)


@pytest.mark.slow
def test_mqtt_messages_are_taken_once_also_those_of_the_time_between(
    broker: int, tmp_path: Path, random: np.random.Generator
) -> None:
    paho = pytest.importorskip("paho.mqtt.client", reason="no paho-mqtt")
    rows = log(random, 60)
    sender = paho.Client(paho.CallbackAPIVersion.VERSION2)
    sender.connect("127.0.0.1", broker)
    sender.loop_start()

    def send(own: list[dict[str, Any]]) -> None:
        for row in own:
            sender.publish("tanks/7/echo", json.dumps(row), qos=1).wait_for_publish(10)

    words = [f"mqtt://127.0.0.1:{broker}/tanks/+/echo", "--law", "linear", "--by", "topic", "--client", "w"]
    words += ["--state", "s.db", "-o", "out.jsonl", "--poll", "0.1"]
    for part in range(3):
        watch = subprocess.Popen([*WATCH, *words], cwd=tmp_path, stderr=subprocess.PIPE)
        if part == 0:
            _until(lambda: (tmp_path / "out.jsonl").exists())
            time.sleep(1.0)  # until it has subscribed
        send([*rows[20 * part : 20 * part + 10]])
        _until(lambda part=part: _count(tmp_path / "out.jsonl") >= 20 * part + 10)  # type: ignore[misc]
        time.sleep(0.5)
        watch.send_signal(signal.SIGINT)
        _, said = watch.communicate(timeout=30)
        assert watch.returncode == 130, said
        send(rows[20 * part + 10 : 20 * part + 20])  # nobody watches; the broker keeps them
    watch = subprocess.Popen([*WATCH, *words], cwd=tmp_path)
    _until(lambda: _count(tmp_path / "out.jsonl") >= 60)
    watch.send_signal(signal.SIGINT)
    watch.wait(30)
    sender.loop_stop()
    got = lines(tmp_path / "out.jsonl")
    assert [row["time"] for row in got] == [row["time"] for row in rows]
    assert {row["topic"] for row in got} == {"tanks/7/echo"}


def _count(path: Path) -> int:
    return len(path.read_text().splitlines())


def _until(true: Callable[[], bool]) -> None:
    end = time.monotonic() + 60.0
    while not true():
        assert time.monotonic() < end, "it takes too long"
        time.sleep(0.05)


@pytest.mark.parametrize(
    ("address", "code", "says"),
    [
        ("mqtt://127.0.0.1:1/tanks", 3, "the broker 127.0.0.1:1 cannot be reached"),
        ("mqtt://127.0.0.1", 2, "is no address of a topic"),
    ],
)
def test_brokers_that_cannot_be(address: str, code: int, says: str, run: Run) -> None:
    pytest.importorskip("paho.mqtt.client", reason="no paho-mqtt")
    got, said = run("watch", address)
    assert (got, says in said) == (code, True)


def test_mqtt_without_its_library_says_what_to_install(run: Run, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "paho.mqtt.client", None)
    code, said = run("watch", "mqtt://127.0.0.1/tanks")
    assert (code, "pip install 'echocal[mqtt]'" in said) == (2, True)


def test_a_model_folder(run: Run, tmp_path: Path, random: np.random.Generator) -> None:
    (tmp_path / "models").mkdir()
    echocal.Model("linear").save(tmp_path / "models" / "7.json")
    rows = [{"id": name, **row} for row in log(random, 3) for name in ("7", "8")]
    (tmp_path / "log.csv").write_text(csv(rows))
    words = ["log.csv", "--models", "models", "--by", "id", "--once", "-o", "out.jsonl"]
    assert run("watch", *words)[1] == "6 rows, 3 corrected; 0 changes told\n"
    assert [row["status"] for row in lines(tmp_path / "out.jsonl")[:2]] == ["", "no model for sensor 8"]
    assert os.listdir(tmp_path / "models") == ["7.json"]  # noqa: PTH208


def table(path: Path) -> list[list[str]]:
    return [line.split(",") for line in path.read_text().splitlines()]


@pytest.mark.parametrize("stop", [signal.SIGTERM, signal.SIGINT, signal.SIGHUP])
def test_a_request_to_stop_ends_it_cleanly(
    stop: signal.Signals, tmp_path: Path, random: np.random.Generator
) -> None:
    """What was taken is written and kept; the next watch goes on behind it, and nothing else is left."""
    rows = log(random, 400)
    (tmp_path / "log.csv").write_text(csv(rows[:200]))
    words = [*WATCH, "log.csv", "--law", "linear", "--learn", "100", "--poll", "0.05"]
    words += ["-o", "out.csv", "--state", "s.db", "--json", "events.jsonl"]
    heard = lambda: signal.signal(stop, signal.SIG_DFL)  # noqa: E731  (under nohup one is ignored)
    watch = subprocess.Popen(words, cwd=tmp_path, stderr=subprocess.PIPE, preexec_fn=heard)
    _until(lambda: (tmp_path / "out.csv").exists() and _count(tmp_path / "out.csv") > 100)
    watch.send_signal(stop)
    _, said = watch.communicate(timeout=60)
    assert watch.returncode == 128 + stop, said
    assert b"200 rows, 200 corrected" in said
    assert sorted(file.name for file in tmp_path.iterdir()) == ["events.jsonl", "log.csv", "out.csv", "s.db"]
    with sqlite3.connect(tmp_path / "s.db") as base:
        assert base.execute("select count(*) from sensors").fetchone() == (1,)
    assert "learned" in (tmp_path / "events.jsonl").read_text()
    (tmp_path / "log.csv").write_text(csv(rows))
    more = subprocess.run([*words, "--once"], cwd=tmp_path, capture_output=True, check=True)
    assert b"200 rows, 200 corrected" in more.stderr
    assert [row[0] for row in table(tmp_path / "out.csv")[1:]] == [row["time"] for row in rows]


def test_signs_that_steer_a_terminal_are_shown(tmp_path: Path, random: np.random.Generator) -> None:
    evil = ["\x1b[2J", "a\x1b]0;title\x07", "b\rc", "\u202egnp.exe", "\x9b31m", "tank 7"]
    rows = [{**row, "id": evil[place % len(evil)]} for place, row in enumerate(log(random, 18))]
    rows.append({**rows[0], "\x1b[31m": 1})
    rows.append({**rows[0], "time": "\x1b[2J"})
    text = "".join(json.dumps(row) + "\n" for row in rows) + '{"\x1b[2J\n\x1b[2J}\n'
    (tmp_path / "log.jsonl").write_text(text)
    echocal.Model("linear").save(tmp_path / "tank_7.json")
    words = [*WATCH, "log.jsonl", "--models", ".", "--by", "id", "--once"]
    made = subprocess.run(words, cwd=tmp_path, capture_output=True, check=True)
    said = (made.stdout + made.stderr).decode()
    assert all(line.isprintable() for line in said.split("\n"))
    assert "\\x1b[2J: no model" in said
    assert made.stdout.count(b"no model") == len(evil) - 1
    assert b"20 rows, 3 corrected" in made.stderr


def test_an_index_names_the_models_of_a_folder(run: Run, tmp_path: Path, random: np.random.Generator) -> None:
    """The sensor `index` has none, another has the file that the index says; a broken file stops its own."""
    (tmp_path / "models").mkdir()
    echocal.Model("linear").save(tmp_path / "models" / "x.json")
    (tmp_path / "models" / "broken.json").write_text("{")
    index = {"schema": "echocal.models/1", "models": {"tank/7": "x.json", "8": "broken.json"}}
    (tmp_path / "models" / "index.json").write_text(json.dumps(index))
    rows = [{"id": name, **row} for row in log(random, 3) for name in ("index", "tank/7", "8")]
    (tmp_path / "log.csv").write_text(csv(rows))
    words = ["log.csv", "--models", "models", "--by", "id", "--once", "-o", "out.jsonl", "--json", "-"]
    assert run("watch", *words)[1] == "9 rows, 3 corrected; 0 changes told\nwrote out.jsonl\n"
    status = [row["status"] for row in lines(tmp_path / "out.jsonl")[:3]]
    assert status == ["no model for sensor index", "", "no model for sensor 8"]


def test_a_time_in_numbers_is_followed_over_restarts(
    run: Run, tmp_path: Path, random: np.random.Generator
) -> None:
    """A step of 50 mm in a log with milliseconds since the start, which grows from call to call."""
    rows = log(random, 320, error=np.where(np.arange(320) < 260, 0.0, 0.05))
    for place, row in enumerate(rows):
        row["time_ms"] = str(600_000 * place)
        del row["time"]
    words = ["log.csv", "--law", "linear", "--learn", "200", "--once", "--state", "s.db", "--json", "e.jsonl"]
    for last in sorted({*random.integers(1, 320, 4).tolist(), 261, 262, 263, 264, 265, 320}):
        (tmp_path / "log.csv").write_text(csv(rows[:last]))
        assert run("watch", *words)[0] == 0
    events = lines(tmp_path / "e.jsonl")
    assert [event["event"] for event in events if event["event"] in {"learned", "change"}] == [
        "learned",
        "change",
    ]
    (change,) = [event for event in events if event["event"] == "change"]
    low, high = change["since_interval"]
    assert low <= 600.0 * 260 <= high
