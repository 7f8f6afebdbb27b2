"""Messages of a broker: each is dealt with by itself, and none stops the watch."""

import json
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np
import poisoned
import pytest
from brokers import broker

import echocal

__all__ = ["broker"]

paho = pytest.importorskip("paho.mqtt.client", reason="no paho-mqtt")

WATCH = [sys.executable, "-m", "echocal", "watch"]
TOPIC = "tanks/7/echo"
DISTANCE = 0.5 * 11660e-6 * (331.4 + 0.6 * 20.0)


def lines(path: Path) -> list[dict[str, Any]]:
    """Whole rows of a file of JSON lines, which is being written; none where there is no file yet."""
    text = path.read_text() if path.exists() else ""
    return [json.loads(line) for line in text[: text.rfind("\n") + 1].splitlines()]


def until(true: Callable[[], bool], watch: subprocess.Popen[bytes], seconds: float = 90.0) -> None:
    end = time.monotonic() + seconds
    while not true():
        assert watch.poll() is None, f"the watch ended with {watch.returncode}; see said.txt"
        assert time.monotonic() < end, "it takes too long"
        time.sleep(0.05)


@contextmanager
def sender(port: int) -> Iterator[Callable[..., None]]:
    client = paho.Client(paho.CallbackAPIVersion.VERSION2)
    client.connect("127.0.0.1", port)
    client.loop_start()

    def send(payload: bytes, topic: str = TOPIC, *, retain: bool = False) -> None:
        client.publish(topic, payload, qos=1, retain=retain).wait_for_publish(30)

    yield send
    client.disconnect()
    client.loop_stop()


@contextmanager
def watching(port: int, folder: Path, *more: str) -> Iterator[subprocess.Popen[bytes]]:
    """A watch with a state; it is asked to terminate at the end, and must do so cleanly."""
    words = [f"mqtt://127.0.0.1:{port}/tanks/+/echo", "--client", "w", "--poll", "0.1"]
    words += ["--state", "s.db", "--json", "events.jsonl", *more]
    said = folder / "said.txt"
    with said.open("ab") as file:
        watch = subprocess.Popen([*WATCH, *words], cwd=folder, stderr=file, stdout=file)
    try:
        until((folder / "events.jsonl").exists, watch)
        time.sleep(1.0)  # until it has subscribed
        yield watch
        watch.send_signal(signal.SIGTERM)
        watch.wait(timeout=60)
        text = said.read_bytes().decode()
        assert watch.returncode == 128 + signal.SIGTERM, text[-3000:]
        assert "Traceback" not in text
        assert all(line.isprintable() for line in text.split("\n"))
    finally:
        if watch.poll() is None:
            watch.kill()
            watch.wait()


@pytest.fixture
def models(tmp_path: Path) -> Path:
    folder = tmp_path / "models"
    folder.mkdir()
    echocal.Model("linear", {"zero_error": {"offset": 5e-3}}).save(folder / "of-a.json")
    index = {"schema": "echocal.models/1", "models": {"a": "of-a.json"}}
    (folder / "index.json").write_text(json.dumps(index))
    return folder


@pytest.mark.slow
def test_no_message_stops_the_watch(
    broker: int, tmp_path: Path, models: Path, random: np.random.Generator
) -> None:
    """Each is followed by a good row, which is corrected; each is in the output, or set aside."""
    cases = list(poisoned.messages(random).items())
    order = random.permutation(len(cases)).tolist()
    assert len(cases) >= 60
    out, aside = tmp_path / "out.jsonl", tmp_path / "out.dead-letters.jsonl"
    words = ["--by", "sensor_id", "--models", str(models), "--correct-only", "-o", "out.jsonl"]
    with sender(broker) as send:
        with watching(broker, tmp_path, *words) as watch:
            for number, place in enumerate(order):
                send(cases[place][1][0])
                send(poisoned.good(number))
            until(lambda: sum("n" in row for row in lines(out)) >= len(cases), watch)
        with watching(broker, tmp_path, *words) as watch:  # nothing comes again
            send(poisoned.good(len(cases)))
            until(lambda: any(row.get("n") == len(cases) for row in lines(out)), watch)
    rows, letters = lines(out), lines(aside)
    good = [row for row in rows if "n" in row]
    assert [row["n"] for row in good] == list(range(len(cases) + 1))
    assert {row["status"] for row in good} == {""}
    assert {row["corrected_distance_m"] for row in good} == {round(DISTANCE - 5e-3, 9)}
    others = [row["status"] for row in rows if "n" not in row]
    wanted = [case[1] for place in order if (case := cases[place][1])[1] not in {"aside", "any"}]
    listed = [status for status in others if status in set(wanted)]
    assert listed == wanted
    set_aside = sum(case[1] == "aside" for _, case in cases)
    either = sum(case[1] == "any" for _, case in cases)
    assert len(others) + len(letters) == len(cases)
    assert set_aside <= len(letters) <= set_aside + either
    for letter in letters:
        assert letter["schema"] == "echocal.unread/1"
        assert letter["source"] == TOPIC
        assert letter["reason"]
        assert ("text" in letter) != ("base64" in letter)
    assert {cases[place][1][0].decode() for place in order if cases[place][0] == "a battery"} <= {
        letter.get("text") for letter in letters
    }


@pytest.mark.slow
def test_no_message_stops_a_test_or_a_table(broker: int, tmp_path: Path, random: np.random.Generator) -> None:
    """One sensor, tested against its known distance, into a CSV file with the columns of the first row."""
    cases = [payload for payload, _ in poisoned.messages(random).values()]
    out, aside = tmp_path / "out.csv", tmp_path / "letters.jsonl"
    rule = {"reason": "crosstalk", "kind": "far from neighbors", "sign": -1, "deviation": 0.05, "part": 0.05}
    marked = echocal.Model("linear").with_provenance({"row_marks": {"rules": [rule]}})  # rows wait for others
    marked.save(tmp_path / "model.json")
    words = ["--model", "model.json", "--reference-distance", "2", "--learn", "50", "-o", "out.csv"]
    words += ["--dead-letters", "letters.jsonl"]

    def good() -> list[list[str]]:
        rows = [line.split(",") for line in out.read_text().splitlines()] if out.exists() else []
        return [row for row in rows if row[1] == "a" and row[5:7] != ["", ""] and row[5].isdigit()]

    with sender(broker) as send, watching(broker, tmp_path, *words) as watch:
        send(poisoned.good(0))
        time.sleep(2.0)
        for number, place in enumerate(random.permutation(len(cases)).tolist(), 1):
            send(cases[place])
            send(poisoned.good(number))
        until(lambda: len(good()) > len(cases) - 6, watch)
    assert [int(row[5]) for row in good()] == list(range(len(cases) + 1))
    assert {float(row[6]) for row in good()} == {round(DISTANCE, 9)}
    events = lines(tmp_path / "events.jsonl")
    assert "learned" in {event["event"] for event in events}
    assert "ignored" in {event["event"] for event in events}
    assert len(lines(aside)) > 40


@pytest.mark.slow
def test_a_retained_message_counts_once(broker: int, tmp_path: Path) -> None:
    out = tmp_path / "out.jsonl"
    words = ["--law", "linear", "--correct-only", "-o", "out.jsonl"]
    with sender(broker) as send:
        for number in range(3):  # each is sent before a start, and again at every start after it
            send(poisoned.good(number), retain=True)
            send(poisoned.good(100 + number), "tanks/8/echo", retain=True)
            with watching(broker, tmp_path, *words) as watch:
                until(lambda number=number: len(lines(out)) >= 2 * (number + 1), watch)  # type: ignore[misc]
                time.sleep(0.5)
        with watching(broker, tmp_path, *words) as watch:
            send(poisoned.good(2), retain=True)  # sent anew: a row like any other
            until(lambda: len(lines(out)) >= 7, watch)
        with watching(broker, tmp_path, *words) as watch:
            send(poisoned.good(3))
            until(lambda: lines(out)[-1]["n"] == 3, watch)
    assert sorted(row["n"] for row in lines(out)) == [0, 1, 2, 2, 3, 100, 101, 102]
