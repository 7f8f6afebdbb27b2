"""`echocal watch`: where rows come from, what is written, how it stops and goes on."""

import contextlib
import json
import os
import shutil
import signal
import socket
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from watched import csv, log

import echocal

Run = Callable[..., tuple[int, str]]
WATCH = [sys.executable, "-m", "echocal", "watch"]


def lines(path: Path) -> list[dict[str, Any]]:
    return [json.loads(line) for line in path.read_text().splitlines()]


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
    assert table[0][-2:] == ["corrected_distance_m", "status"]
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
    corrected = [json.loads(line)["corrected_distance_m"] for line in made.stdout.splitlines()]
    assert len(corrected) == 6
    assert corrected[-1] == pytest.approx(2.002, abs=1e-3)
    assert "a line has 2 fields, its header 4: 1,2" in made.stderr


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


def free_port() -> int:
    with socket.socket() as one:
        one.bind(("127.0.0.1", 0))
        return int(one.getsockname()[1])


@pytest.fixture
def broker(tmp_path: Path) -> Iterator[int]:
    """A real broker, Eclipse Mosquitto, on a port of its own."""
    program = shutil.which("mosquitto") or shutil.which("mosquitto", path="/usr/sbin")
    if program is None:
        pytest.skip("no MQTT broker: install mosquitto")
    port = free_port()
    settings = f"listener {port} 127.0.0.1\nallow_anonymous true\n"
    (tmp_path / "broker.conf").write_text(settings)
    running = subprocess.Popen([program, "-c", str(tmp_path / "broker.conf")], stderr=subprocess.DEVNULL)
    for _ in range(100):
        with contextlib.suppress(OSError), socket.create_connection(("127.0.0.1", port), 0.1):
            break
        time.sleep(0.05)
    yield port
    running.terminate()
    running.wait()


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
