"""What Home Assistant hears from a watch, through a real broker."""

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
import pytest
from brokers import broker
from jinja2 import Environment

import echocal
from echocal.watch.home_assistant import slug

__all__ = ["broker"]

paho = pytest.importorskip("paho.mqtt.client", reason="no paho-mqtt")

HEADER = "sensor_id,echo_us,temperature_C"


class Hearer(dict[str, Any]):
    """The last message of each topic, as somebody hears who comes now."""

    def until(self, true: Callable[[], object], seconds: float = 60.0) -> None:
        end = time.monotonic() + seconds
        while not true():
            assert time.monotonic() < end, dict(self)
            time.sleep(0.05)


@contextmanager
def hearer(port: int) -> Iterator[Hearer]:
    heard = Hearer()

    def keep(_client: Any, _data: Any, message: Any) -> None:
        text = message.payload.decode()
        heard[message.topic] = json.loads(text) if text.startswith("{") else text

    client = paho.Client(paho.CallbackAPIVersion.VERSION2)
    client.on_message = keep
    client.connect("127.0.0.1", port)
    client.subscribe("#", qos=1)
    client.loop_start()
    yield heard
    client.disconnect()
    client.loop_stop()


@contextmanager
def watching(port: int, folder: Path, *more: str) -> Iterator[subprocess.Popen[bytes]]:
    words = ["log.csv", "--law", "linear", "--by", "sensor_id", "--poll", "0.1", "--correct-only", *more]
    command = [sys.executable, "-m", "echocal", "watch", *words]
    watch = subprocess.Popen([*command, "--home-assistant", f"mqtt://127.0.0.1:{port}"], cwd=folder)
    try:
        yield watch
    finally:
        watch.kill()
        watch.wait()


def shown(component: dict[str, Any], state: dict[str, Any]) -> str:
    """The state of an entity, as Home Assistant makes it of a message."""
    return Environment().from_string(component["value_template"]).render(value_json=state)


@pytest.mark.slow
def test_home_assistant_finds_each_sensor_and_its_distance(
    broker: int, tmp_path: Path, random: np.random.Generator
) -> None:
    log = tmp_path / "log.csv"
    echoes = random.integers(3000, 12000, 2).tolist()
    log.write_text(f"{HEADER}\ntank-7,9000,20\ntank-7,{echoes[0]},20\ntank 8,{echoes[1]},20\n")
    with watching(broker, tmp_path) as watch:
        with hearer(broker) as heard:
            heard.until(lambda: len(heard) >= 5)
            assert heard["echocal/status"] == "online"
            configs = {topic: own for topic, own in heard.items() if topic.startswith("homeassistant/")}
            assert sorted(own["device"]["name"] for own in configs.values()) == ["tank 8", "tank-7"]
            ids = []
            for topic, payload in configs.items():
                assert [*topic.split("/")[:2], topic.split("/")[3]] == ["homeassistant", "device", "config"]
                assert slug(topic.split("/")[2]) == topic.split("/")[2]
                assert payload["origin"]["name"] == "echocal", "demanded of a device"
                assert payload["device"]["identifiers"]
                assert payload["availability_topic"] == "echocal/status"
                for component in payload["components"].values():
                    assert component["platform"] in {"sensor", "binary_sensor"}
                    ids.append(component["unique_id"])
                state = heard[payload["state_topic"]]
                echo = echoes[int(payload["device"]["name"] == "tank 8")]
                distance = echocal.distance(1e-6 * echo, 20.0, law="linear")
                parts = payload["components"]
                assert parts["distance"]["unit_of_measurement"] == "m"
                assert float(shown(parts["distance"], state)) == pytest.approx(distance, abs=1e-8)
                assert shown(parts["status"], state) == "it has one"
                assert shown(parts["changed"], state) == "OFF"
            assert len(set(ids)) == len(ids) == 8
            with log.open("a") as file:
                file.write("tank-7,0,20\n")
            topic = "echocal/tank-7/state"
            heard.until(lambda: heard[topic]["corrected_distance_m"] is None)
            parts = configs["homeassistant/device/echocal_tank-7/config"]["components"]
            assert shown(parts["distance"], heard[topic]) == "None", "which is an unknown state there"
            assert shown(parts["status"], heard[topic]) == heard[topic]["status"] != ""
        watch.send_signal(signal.SIGTERM)
        watch.wait(30)
    with hearer(broker) as later:
        later.until(lambda: later.get("echocal/status") == "offline")
        later.until(lambda: len(later) >= 5)  # who comes later finds them, too


@pytest.mark.slow
def test_the_broker_tells_that_a_watch_was_killed(broker: int, tmp_path: Path) -> None:
    (tmp_path / "log.csv").write_text(f"{HEADER}\na,9000,20\n")
    with hearer(broker) as heard, watching(broker, tmp_path, "--client", "cellar") as watch:
        heard.until(lambda: heard.get("echocal/cellar/status") == "online" and len(heard) >= 3)
        assert (
            heard["homeassistant/device/echocal_cellar_a/config"]["state_topic"] == "echocal/cellar/a/state"
        )
        watch.kill()
        heard.until(lambda: heard["echocal/cellar/status"] == "offline")


@pytest.mark.slow
def test_a_change_is_a_problem(broker: int, tmp_path: Path, random: np.random.Generator) -> None:
    """The distance jumps by 30 mm, and its noise is 1 mm."""
    away = 1.0 + random.normal(0.0, 1e-3, 400) + np.where(np.arange(400) < 300, 0.0, 30e-3)
    echo = 2e6 * away / 343.4
    rows = (f"{600 * n},a,{one:.2f},20" for n, one in enumerate(echo))
    (tmp_path / "log.csv").write_text("\n".join([f"time_s,{HEADER}", *rows]) + "\n")
    words = [
        "log.csv",
        "--law",
        "linear",
        "--by",
        "sensor_id",
        "--constant-distance",
        "--learn",
        "200",
        "--once",
    ]
    command = [sys.executable, "-m", "echocal", "watch", *words]
    subprocess.run([*command, "--home-assistant", f"mqtt://127.0.0.1:{broker}"], cwd=tmp_path, check=True)
    with hearer(broker) as heard:
        heard.until(lambda: "echocal/a/state" in heard)
        state = heard["echocal/a/state"]
    assert state["changed"] == "ON"
    assert state["change"]


@pytest.mark.parametrize("url", ["http://host", "mqtt://", "host"])
def test_an_address_of_another_kind_is_refused(url: str, tmp_path: Path) -> None:
    (tmp_path / "log.csv").write_text(f"{HEADER}\na,9000,20\n")
    words = [sys.executable, "-m", "echocal", "watch", str(tmp_path / "log.csv"), "--home-assistant", url]
    done = subprocess.run(words, capture_output=True, text=True, check=False)
    assert done.returncode == 2
    assert "no address of a broker" in done.stderr
