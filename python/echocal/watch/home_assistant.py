"""Corrected rows for Home Assistant: it finds each sensor by MQTT discovery [1]_.

References
----------
.. [1] Home Assistant, MQTT, "Device discovery payload" and "Using availability topics",
   https://www.home-assistant.io/integrations/mqtt/
"""

import json
import re
from collections.abc import Sequence
from hashlib import sha256
from typing import Any
from urllib.parse import unquote, urlsplit

from echocal._core import __version__
from echocal.correct.results import DISTANCE, LEVEL, STATUS, UNCERTAINTY
from echocal.errors import UsageError
from echocal.watch.events import Event, finite
from echocal.watch.mqtt import client_of, connect
from echocal.watch.rows import Row

_PREFIX = "homeassistant"  # of Home Assistant's own settings
_WAIT = 10.0  # s for the last messages to leave
_CHANGE = "change"
_MODEL = "ultrasonic ranger"


class HomeAssistant:
    """A broker that Home Assistant listens to.

    Each sensor gets a device with four entities. The broker keeps the description and the last state, so
    that they are there when Home Assistant starts later. When this program ends, however it ends, the broker
    tells that the sensors are unavailable. The address is ``mqtt://[user[:password]@]host[:port][/prefix]``,
    ``mqtts`` for TLS; `node` distinguishes this watch from others at the same broker, and `by` is the column
    of the sensor's id. Raises `UsageError` if the address has another form, or the library is absent, and
    `DataError` if the broker cannot be reached.
    """

    def __init__(self, url: str, node: str = "", by: str | None = None) -> None:
        parts = urlsplit(url)
        if parts.scheme not in {"mqtt", "mqtts"} or not parts.hostname:
            raise UsageError(f"{url} is no address of a broker; give mqtt://host[:port][/prefix]")
        self._prefix = unquote(parts.path.strip("/")) or _PREFIX
        self._base = "/".join(["echocal", *([slug(node)] if node else [])])
        self._node, self._by = node, by
        self._told: dict[str, str] = {}
        self._changes: dict[str, str] = {}
        self._client = client_of(parts)
        self._client.will_set(self._status, "offline", qos=1, retain=True)
        self._client.on_connect = self._connected
        connect(self._client, parts)

    @property
    def _status(self) -> str:
        return f"{self._base}/status"

    def _connected(self, client: Any, *_: Any) -> None:
        """Say, also after a loss of the connection, that the watch is there."""
        client.publish(self._status, "online", qos=1, retain=True)

    def publish(self, rows: Sequence[Row], events: Sequence[Event]) -> None:
        """Publish the last row of each sensor, and whether it has changed."""
        for event in events:
            if event.kind == _CHANGE:
                self._changes[event.sensor] = event.sentence
        last = {str(row.get(self._by, "")) if self._by else "": row for row in rows}
        for sensor, row in last.items():
            first = LEVEL if LEVEL in row else DISTANCE
            own = slug(sensor or self._node or "ranger")
            if sensor not in self._told:
                topic, payload = discovery(own, sensor or self._node, self._prefix, self._base, first)
                self._publish(topic, payload)
                self._told[sensor] = own
            state = {name: row.get(name) for name in (first, UNCERTAINTY, STATUS)}
            change = {
                "changed": "ON" if sensor in self._changes else "OFF",
                _CHANGE: self._changes.get(sensor),
            }
            self._publish(f"{self._base}/{own}/state", state | change)

    def _publish(self, topic: str, payload: dict[str, Any]) -> None:
        self._client.publish(topic, json.dumps(finite(payload), allow_nan=False), qos=1, retain=True)

    def close(self) -> None:
        """Say that nobody watches any more, and leave the broker."""
        self._client.publish(self._status, "offline", qos=1, retain=True).wait_for_publish(_WAIT)
        self._client.disconnect()
        self._client.loop_stop()


def discovery(
    own: str, name: str, prefix: str = _PREFIX, base: str = "echocal", first: str = DISTANCE
) -> tuple[str, dict[str, Any]]:
    """Topic and payload by which Home Assistant finds a sensor.

    `own` is the sensor in topics and ids, `name` that for a person; `prefix` is that of the discovery
    topics, and `base` what the topics of this watch begin with.

    Examples
    --------
    >>> from echocal.watch.home_assistant import discovery
    >>> topic, payload = discovery("tank_7", "tank 7")
    >>> topic, payload["components"]["distance"]["value_template"]
    ('homeassistant/device/echocal_tank_7/config', '{{ value_json.corrected_distance_m }}')
    """
    identity = f"{base.replace('/', '_')}_{own}"
    what = "level" if first == LEVEL else "distance"
    parts: dict[str, dict[str, Any]] = {
        what: {
            "platform": "sensor",
            "name": what.capitalize(),
            "device_class": "distance",
            "state_class": "measurement",
            "unit_of_measurement": "m",
            "suggested_display_precision": 3,
            "value_template": _value(first),
        },
        "uncertainty": {
            "platform": "sensor",
            "name": "Standard uncertainty",
            "entity_category": "diagnostic",
            "device_class": "distance",
            "state_class": "measurement",
            "unit_of_measurement": "m",
            "suggested_display_precision": 4,
            "value_template": _value(UNCERTAINTY),
        },
        "status": {
            "platform": "sensor",
            "name": f"Why a row has no {what}",
            "entity_category": "diagnostic",
            "value_template": f"{{{{ value_json.{STATUS} or 'it has one' }}}}",  # an empty state is left out
        },
        "changed": {
            "platform": "binary_sensor",
            "name": "Changed",
            "device_class": "problem",
            "value_template": _value("changed"),
            "json_attributes_topic": f"{base}/{own}/state",
            "json_attributes_template": f"{{{{ {{'change': value_json.{_CHANGE}}} | tojson }}}}",
        },
    }
    for part, own_options in parts.items():
        own_options["unique_id"] = f"{identity}_{part}"
    return f"{prefix}/device/{identity}/config", {
        "device": {
            "identifiers": [identity],
            "name": name or _MODEL,
            "model": _MODEL,
        },
        "origin": {"name": "echocal", "sw_version": __version__},
        "components": parts,
        "state_topic": f"{base}/{own}/state",
        "availability_topic": f"{base}/status",
        "qos": 1,
    }


def _value(name: str) -> str:
    return f"{{{{ value_json.{name} }}}}"


def slug(text: str) -> str:
    """A text in the signs that ids of Home Assistant have; two texts never have the same.

    Examples
    --------
    >>> from echocal.watch.home_assistant import slug
    >>> slug("tank-7"), slug("tank 7")
    ('tank-7', 'tank_7_f9f567')
    """
    plain = re.sub(r"[^a-zA-Z0-9_-]", "_", text)
    return plain if plain == text else f"{plain[:60]}_{sha256(text.encode()).hexdigest()[:6]}"
