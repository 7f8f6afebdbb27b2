"""Recordings of messages, a row for each echo of a ranger: ULog of PX4 [1]_, bags of ROS 1 and 2 [2]_.

References
----------
.. [1] PX4, msg/DistanceSensor.msg, https://docs.px4.io/main/en/msg_docs/DistanceSensor.html; ULog by pyulog.
.. [2] ROS, sensor_msgs/Range, Temperature, RelativeHumidity, FluidPressure,
   https://github.com/ros2/common_interfaces; bags by rosbags.
"""

import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from echocal.errors import DataError
from echocal.observations.file import BAG, ULOG
from echocal.observations.found import Found, Join, keep, told
from echocal.observations.in_time import Clock, joined
from echocal.observations.numbers import NO_ECHO

_SOUND = {ULOG: 1, BAG: 0}  # MAV_DISTANCE_SENSOR_ULTRASOUND; Range.ULTRASOUND
_PX4 = {
    ("sensor_hygrometer", "temperature"): ("temperature", "C"),
    ("vehicle_air_data", "ambient_temperature"): ("temperature", "C"),
    ("sensor_baro", "temperature"): ("temperature", "C"),
    ("sensor_hygrometer", "humidity"): ("humidity", "percent"),
    ("vehicle_air_data", "baro_pressure_pa"): ("pressure", "Pa"),
}
"""Fields of topics of PX4; of several thermometers the first is taken for that of the air."""
_ROS = {
    "sensor_msgs/msg/Temperature": ("temperature", ("temperature", "C")),
    "sensor_msgs/msg/RelativeHumidity": ("relative_humidity", ("relative_humidity", "")),
    "sensor_msgs/msg/FluidPressure": ("fluid_pressure", ("pressure", "Pa")),
}
_RANGE = "sensor_msgs/msg/Range"
_SINCE_1970 = 1e8  # s: a smaller time counts from a start of its own


@dataclass
class _Series:
    """Values of a topic: of a ranger [m], or of another quantity."""

    topic: str
    quantity: tuple[str, str] = ("reading", "m")
    times: list[float] = field(default_factory=list)
    heights: list[float] = field(default_factory=list)
    valid: list[bool] = field(default_factory=list)
    kinds: set[int] = field(default_factory=set)

    def add(self, time: float, value: float, *, valid: bool = True, kind: int = 0) -> None:
        """Add a message."""
        self.times.append(time)
        self.heights.append(value)
        self.valid.append(valid and bool(np.isfinite(value)))
        self.kinds.add(kind)


def read(path: Path, kind: str) -> pd.DataFrame:
    """Read the echoes of the ultrasonic rangers of a recording, with the air at their times.

    Raises `DataError` if the library is absent, the file is damaged, or no ultrasonic ranger is in it.
    """
    series = list(_ulog(path) if kind == ULOG else _bag(path))
    rangers = [own for own in series if own.quantity == ("reading", "m") and own.times]
    sound = [own for own in rangers if own.kinds == {_SOUND[kind]}]
    if not sound:
        others = ", ".join(f"{own.topic} (type {sorted(own.kinds)})" for own in rangers)
        none = f"its rangers are no ultrasonic ones: {others}" if others else "no ranger is in it"
        topic = "distance_sensor" if kind == ULOG else "sensor_msgs/Range"
        raise DataError(f"{path} is {kind}, and {none}; ultrasonic is type {_SOUND[kind]} of {topic}")
    notes = [f"{own.topic} is no ultrasonic ranger, and is not read" for own in rangers if own not in sound]
    return _table(sound, [own for own in series if own not in rangers and own.times], kind, notes)


def _table(sound: Sequence[_Series], air: Sequence[_Series], kind: str, notes: list[str]) -> pd.DataFrame:
    times = np.concatenate([own.times for own in sound])
    order = np.argsort(times, kind="stable")
    valid = np.concatenate([own.valid for own in sound])[order]
    columns: dict[str, Any] = {"time_s": times[order]}
    if times.min() > _SINCE_1970:
        dates = pd.to_datetime(times[order], unit="s").strftime("%Y-%m-%dT%H:%M:%S.%fZ")
        columns = {"time": dates}
    if len(sound) > 1:
        columns["sensor_id"] = np.repeat([own.topic for own in sound], [len(o.times) for o in sound])[order]
    readings = np.concatenate([own.heights for own in sound])[order]
    columns["reading_m"] = np.where(np.isfinite(readings), readings, np.nan)
    joins: dict[str, Join] = {}
    for own in air:
        name = _name(own, columns)
        every = np.concatenate([times[order], own.times])
        at, where = np.arange(len(times)), np.arange(len(times), len(every))
        columns[name], joins[name] = joined(Clock(every), at, where, np.array(own.heights), smooth=True)
        notes.append(f"{name} is that of {own.topic}")
    corrupt = {int(row): NO_ECHO for row in np.flatnonzero(~valid)}
    if corrupt:
        notes.append(f"{len(corrupt)} of {len(times)} messages say that no echo came")
    found = Found(kind, notes=(*notes, *told(joins)), corrupt=corrupt, streams=False, joined=joins)
    return keep(pd.DataFrame(columns), found)


def _name(own: _Series, taken: Iterable[str]) -> str:
    """Name of a column: with the topic where another one has the quantity already."""
    quantity, unit = own.quantity
    plain = "_".join(filter(None, [quantity, unit]))
    topic = re.sub(r"[^a-zA-Z0-9]+", "_", own.topic).strip("_")
    return plain if plain not in taken else "_".join(filter(None, [quantity, topic, unit]))


def _ulog(path: Path) -> Iterable[_Series]:
    """Topics of a log of PX4; a signal quality of 0 says that an echo is not valid."""
    try:
        from pyulog import ULog
    except ImportError:
        raise DataError(f"{path} is {ULOG}: pip install 'echocal[ulog]'") from None
    wanted = ["distance_sensor", *dict.fromkeys(topic for topic, _ in _PX4)]
    try:
        log = ULog(str(path), wanted)
    except Exception as error:  # of its parser, which meets any bytes
        raise DataError(f"{path} cannot be read as {ULOG}: {error}") from None
    several = {data.name for data in log.data_list if data.multi_id}
    for data in log.data_list:
        name = f"{data.name}_{data.multi_id}" if data.name in several else str(data.name)
        seconds = 1e-6 * data.data["timestamp"]
        if data.name == "distance_sensor":
            own = _Series(name)
            quality = data.data.get("signal_quality", np.full(len(seconds), -1))
            rows = zip(seconds, data.data["current_distance"], quality, data.data["type"], strict=True)
            for time, value, good, kind in rows:
                own.add(float(time), float(value), valid=good != 0, kind=int(kind))
            yield own
    for (topic, name), quantity in _PX4.items():
        for data in log.data_list:
            if data.name == topic and name in data.data and np.isfinite(data.data[name]).any():
                label = f"{topic}_{data.multi_id}" if topic in several else topic
                times, values = 1e-6 * data.data["timestamp"], data.data[name]
                known = np.isfinite(values)
                yield _Series(label, quantity, times[known].tolist(), values[known].astype(float).tolist())


def _bag(path: Path) -> Iterable[_Series]:
    """Topics of a bag; an infinite range says that no echo came."""
    try:
        from rosbags.highlevel import AnyReader
        from rosbags.typesys import Stores, get_typestore
    except ImportError:
        raise DataError(f"{path} is {BAG}: pip install 'echocal[ros]'") from None
    found: dict[tuple[str, str], _Series] = {}
    try:
        with AnyReader([path], default_typestore=get_typestore(Stores.LATEST)) as reader:
            wanted = [one for one in reader.connections if one.msgtype in {_RANGE, *_ROS}]
            for link, received, raw in reader.messages(wanted) if wanted else ():
                sent: Any = reader.deserialize(raw, link.msgtype)
                stamp = sent.header.stamp
                time = stamp.sec + 1e-9 * stamp.nanosec or 1e-9 * received
                name, quantity = _ROS.get(link.msgtype, ("range", ("reading", "m")))
                own = found.setdefault((link.topic, link.msgtype), _Series(link.topic, quantity))
                own.add(time, float(getattr(sent, name)), kind=int(getattr(sent, "radiation_type", 0)))
    except Exception as error:  # of its parsers, which meet any bytes
        raise DataError(f"{path} cannot be read as {BAG}: {error}") from None
    return found.values()
