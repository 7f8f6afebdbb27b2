"""ULog and bags of ROS, written by the writers of their libraries."""

import struct
import sys
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pandas as pd
import pytest

import echocal
from echocal.errors import DataError
from echocal.observations.inspection import inspect_log
from echocal.observations.source import load

ROWS = 40
SINCE = 1_700_000_000
DELAY = echocal.Model("linear", {"fixed_delay": {"delay": 85e-6}})

_C = {"f4": ("float", "f"), "i1": ("int8_t", "b"), "u1": ("uint8_t", "B"), "u8": ("uint64_t", "Q")}


def ulog(path: Path, topics: dict[tuple[str, int], dict[str, np.ndarray]]) -> None:
    """A log with these messages of topics and instances, by the writer of pyulog."""
    pyulog = pytest.importorskip("pyulog")
    log = pyulog.ULog(None)
    for number, ((name, instance), fields) in enumerate(topics.items()):
        types = {own: _C[values.dtype.str[1:]][0] for own, values in fields.items()}
        text = f"{name}:" + "".join(f"{kind} {own};" for own, kind in types.items())
        header = SimpleNamespace(msg_size=len(text))
        log._message_formats[name] = pyulog.ULog.MessageFormat(text.encode(), header)
        table = np.rec.fromarrays(list(fields.values()), names=list(fields))
        data = SimpleNamespace(
            multi_id=instance,
            msg_id=number,
            message_name=name,
            field_data=[SimpleNamespace(field_name=own, type_str=kind) for own, kind in types.items()],
            timestamp_idx=0,
            buffer=table.tobytes(),
            dtype=table.dtype,
        )
        log._data_list.append(pyulog.ULog.Data(data))
    log.write_ulog(str(path))


def distances(readings: np.ndarray, kind: int = 1, start: int = 0) -> dict[str, np.ndarray]:
    count = len(readings)
    return {
        "timestamp": (start + 100_000 * np.arange(count)).astype("u8"),
        "current_distance": readings.astype("f4"),
        "signal_quality": np.full(count, 100, dtype="i1"),
        "type": np.full(count, kind, dtype="u1"),
    }


def test_a_ulog_of_px4(tmp_path: Path, random: np.random.Generator) -> None:
    """A sonar and a laser; the barometer is slower, and its temperature is interpolated."""
    readings = random.uniform(0.3, 3.0, ROWS)
    sonar = distances(readings)
    sonar["signal_quality"][7] = 0
    baro = {
        "timestamp": (1_000_000 * np.arange(5)).astype("u8"),
        "temperature": np.array([20.0, 21.0, 22.0, 23.0, 24.0], dtype="f4"),
    }
    topics = {("distance_sensor", 0): sonar, ("distance_sensor", 1): distances(readings, kind=0)}
    ulog(tmp_path / "flight.ulg", topics | {("sensor_baro", 0): baro})
    table = load(tmp_path / "flight.ulg")
    assert list(table) == ["time_s", "reading_m", "temperature_C"]
    assert table["reading_m"].to_numpy() == pytest.approx(readings, rel=1e-6)
    assert table["temperature_C"].to_numpy() == pytest.approx(20 + 0.1 * np.arange(ROWS), abs=1e-5)
    found = inspect_log(tmp_path / "flight.ulg")
    assert found.kind == "a ULog of PX4"
    assert found.usable == ROWS - 1, "a row without an echo"
    assert any("distance_sensor_1 is no ultrasonic ranger" in note for note in found.notes)
    assert any("temperature_C is that of sensor_baro" in note for note in found.notes)
    observations = echocal.read_observations(tmp_path / "flight.ulg")
    assert not observations.usable[7]


def test_a_laser_alone_is_refused(tmp_path: Path, random: np.random.Generator) -> None:
    ulog(tmp_path / "laser.ulg", {("distance_sensor", 0): distances(random.uniform(0.3, 3.0, ROWS), kind=0)})
    with pytest.raises(DataError, match=r"no ultrasonic ones: distance_sensor \(type \[0\]\)"):
        load(tmp_path / "laser.ulg")
    ulog(tmp_path / "none.ulg", {("sensor_baro", 0): {"timestamp": np.arange(3).astype("u8")}})
    with pytest.raises(DataError, match="no ranger is in it"):
        load(tmp_path / "none.ulg")


def test_two_sonars_have_a_column(tmp_path: Path, random: np.random.Generator) -> None:
    near, far = random.uniform(0.3, 1.0, ROWS), random.uniform(2.0, 3.0, ROWS)
    topics = {("distance_sensor", 0): distances(near), ("distance_sensor", 1): distances(far, start=50_000)}
    ulog(tmp_path / "two.ulg", topics)
    table = load(tmp_path / "two.ulg")
    assert table["sensor_id"].tolist() == ["distance_sensor_0", "distance_sensor_1"] * ROWS
    own = table[table["sensor_id"] == "distance_sensor_1"]
    assert own["reading_m"].to_numpy() == pytest.approx(far, rel=1e-6)


def bag(path: Path, kind: str, readings: np.ndarray, warm: np.ndarray, *, stamped: bool = True) -> Path:
    """A bag, by the writer of rosbags: a ranger each 0.1 s, a thermometer each second."""
    pytest.importorskip("rosbags")
    from rosbags.rosbag1 import Writer as Writer1
    from rosbags.rosbag2 import StoragePlugin
    from rosbags.rosbag2 import Writer as Writer2
    from rosbags.typesys import Stores, get_typestore

    store = get_typestore(Stores.ROS1_NOETIC if kind == "bag" else Stores.ROS2_HUMBLE)
    types = store.types

    def header(nanoseconds: int) -> Any:
        seconds, rest = divmod(nanoseconds, 10**9) if stamped else (0, 0)
        stamp = types["builtin_interfaces/msg/Time"](seconds, rest)
        extra = (0,) if kind == "bag" else ()
        return types["std_msgs/msg/Header"](*extra, stamp, "sonar")

    new = types["sensor_msgs/msg/Range"]
    extra = {} if "variance" not in new.__dataclass_fields__ else {"variance": 0.0}
    messages = []
    for number, reading in enumerate(readings.tolist()):
        at = SINCE * 10**9 + number * 10**8
        limits = {"field_of_view": 0.5, "min_range": 0.02, "max_range": 4.0}
        own = new(header=header(at), radiation_type=0, range=reading, **limits, **extra)
        messages.append((at, "/sonar", "sensor_msgs/msg/Range", own))
    for number, degrees in enumerate(warm.tolist()):
        at = SINCE * 10**9 + number * 10**9
        own = types["sensor_msgs/msg/Temperature"](header=header(at), temperature=degrees, variance=0.0)
        messages.append((at, "/air", "sensor_msgs/msg/Temperature", own))
    place = path / ("log.bag" if kind == "bag" else "log")
    if kind == "bag":
        writer: Any = Writer1(place)
    else:
        plugin = StoragePlugin.MCAP if kind == "mcap" else StoragePlugin.SQLITE3
        writer = Writer2(place, version=9, storage_plugin=plugin)
    with writer:
        links = {
            topic: writer.add_connection(topic, name, typestore=store)
            for topic, name in {(topic, name) for _, topic, name, _ in messages}
        }
        for at, topic, name, own in sorted(messages, key=lambda one: one[0]):
            raw = store.serialize_ros1(own, name) if kind == "bag" else store.serialize_cdr(own, name)
            writer.write(links[topic], at, raw)
    return place if kind == "bag" else next(place.glob(f"*.{kind}"))


@pytest.mark.parametrize("stamped", [True, False], ids=["stamped", "by arrival"])
@pytest.mark.parametrize("kind", ["bag", "mcap", "db3"])
def test_a_bag_of_ros(kind: str, stamped: bool, tmp_path: Path, random: np.random.Generator) -> None:
    readings = random.uniform(0.3, 3.0, ROWS)
    readings[5] = np.inf
    log = bag(tmp_path, kind, readings, np.array([20.0, 21.0, 22.0, 23.0, 24.0]), stamped=stamped)
    table = load(log)
    assert list(table) == ["time", "reading_m", "temperature_C"]
    readings[5] = np.nan
    assert table["reading_m"].to_numpy() == pytest.approx(readings, rel=1e-6, nan_ok=True)
    assert table["temperature_C"].to_numpy() == pytest.approx(20 + 0.1 * np.arange(ROWS), abs=1e-5)
    times = pd.to_datetime(table["time"]) - pd.Timestamp(SINCE, unit="s", tz="UTC")
    assert times.dt.total_seconds().to_numpy() == pytest.approx(0.1 * np.arange(ROWS), abs=1e-3)
    found = inspect_log(log)
    assert (found.kind, found.usable) == ("a bag of ROS", ROWS - 1)
    assert found.clock is not None
    assert found.clock.first.startswith("2023-11-14T22:13:20")


@pytest.mark.statistical
def test_a_recording_is_diagnosed(tmp_path: Path, random: np.random.Generator) -> None:
    """Three placements of a target, a delay of 85 us."""
    away, air = np.repeat([2.5, 0.5, 1.2], 60), np.full(180, 21.0)
    reading = DELAY.indicate(away, temperature=air) + random.normal(0.0, 1e-3, 180)
    log = bag(tmp_path, "mcap", reading, np.full(19, 21.0))
    diagnosis = echocal.diagnose(log, placements=[2.5, 0.5, 1.2])
    alike = {diagnosis.causes[0].id, *diagnosis.causes[0].indistinguishable_from}
    assert {"fixed_delay", "zero_error"} & alike


@pytest.mark.parametrize(
    ("name", "begins", "library", "extra"),
    [
        ("a.ulg", b"ULog\x01\x12\x35\x01" + struct.pack("<Q", 0), "pyulog", "ulog"),
        ("a.bag", b"#ROSBAG V2.0\n", "rosbags.highlevel", "ros"),
        ("a.mcap", b"\x89MCAP0\r\n", "rosbags.highlevel", "ros"),
        ("a.db3", b"SQLite format 3\x00", "rosbags.highlevel", "ros"),
    ],
)
def test_without_the_library_the_way_is_told(
    name: str, begins: bytes, library: str, extra: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / name).write_bytes(begins + bytes(64))
    monkeypatch.setitem(sys.modules, library, None)
    with pytest.raises(DataError, match=rf"pip install 'echocal\[{extra}\]'"):
        load(tmp_path / name)


@pytest.mark.parametrize("name", ["a.bag", "a.mcap", "a.db3", "a.ulg"])
def test_a_damaged_recording_is_told(name: str, tmp_path: Path) -> None:
    begins = {
        "bag": b"#ROSBAG V2.0\n",
        "mcap": b"\x89MCAP0\r\n",
        "db3": b"SQLite format 3\x00",
        "ulg": b"ULog\x01\x12\x35",
    }
    (tmp_path / name).write_bytes(begins[name[2:]] + b"\xff" * 5)
    with pytest.raises(DataError, match=r"cannot be read as|no ranger"):
        load(tmp_path / name)
