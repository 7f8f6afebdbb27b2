"""Rows from an MQTT broker, by the library paho-mqtt."""

import hashlib
import json
import queue
from collections.abc import Iterator
from typing import Any
from urllib.parse import SplitResult, unquote, urlsplit

from echocal.errors import DataError, UsageError
from echocal.watch.parser import Batch, json_of, parsed
from echocal.watch.rows import Row
from echocal.watch.state import State

_MOST = 2000  # messages of a batch


class Broker:
    """Messages of a topic: each payload is one JSON object or a list of them.

    A message is acknowledged when its rows are committed, or when it is set aside. With a client's name and
    quality of service 1, the broker keeps what comes while nobody watches. The address is
    ``mqtt://[user[:password]@]host[:port]/topic``, ``mqtts`` for TLS; the topic may have wildcards. `client`
    is the name that the broker keeps messages for, `wait` the longest wait for the next message before an
    empty batch [s]; the state knows the last message of each topic: one that the broker keeps counts once.
    Raises `UsageError` if the address is not of this form, or the library is absent, and `DataError` if the
    broker cannot be reached or refuses.
    """

    def __init__(self, url: str, client: str, wait: float, state: State) -> None:
        parts = urlsplit(url.replace("#", "%23"))
        self.topic, self.wait = unquote(parts.path.lstrip("/")), wait
        self._state, self._last = state, dict[str, str]()
        self._session = f"mqtt session {parts.hostname}:{parts.port} {client}"
        self._subscribed = state.position(self._session) if client else None
        if not parts.hostname or not self.topic:
            message = f"{url} is no address of a topic; give mqtt://host[:port]/topic, e.g. mqtt://host/tanks/+/echo"
            raise UsageError(message)
        self.place = place_of(parts)
        self._arrived: queue.SimpleQueue[Any] = queue.SimpleQueue()
        self._taken: list[Any] = []
        self._client = client_of(parts, client_id=client, clean_session=not client, manual_ack=True)
        self._client.on_connect = self._connected
        self._client.on_message = lambda _client, _data, message: self._arrived.put(message)
        connect(self._client, parts)

    def _connected(self, client: Any, _data: Any, flags: Any, reason: Any, _properties: Any) -> None:
        if reason.is_failure:
            self._arrived.put(DataError(f"the broker {self.place} refuses: {reason}"))
        elif not (flags.session_present and self._subscribed == self.topic):
            # also after a loss of the connection; where the broker still knows it, it would send what it
            # retains again, beside what it has kept for this client
            client.subscribe(self.topic, qos=1)

    def batches(self) -> Iterator[Batch]:
        """Rows of messages; each row has its topic as column ``topic``."""
        while True:
            batch = Batch()
            try:
                self._take(self._arrived.get(timeout=self.wait), batch)
                for _ in range(_MOST):
                    self._take(self._arrived.get_nowait(), batch)
            except queue.Empty:
                pass
            yield batch

    def _take(self, message: Any, batch: Batch) -> None:
        if isinstance(message, DataError):
            raise message
        self._taken.append(message)
        topic, text = message.topic, bytes(message.payload)
        if self._came_before(topic, text, retained=message.retain):
            return
        if not text.lstrip().startswith(b"["):
            batch.add(*_with_topic(*parsed(text), topic), text, topic)
            return
        listed, why = json_of(text)
        if why or not listed:
            batch.add(None, why or "a list without rows", text, topic)
            return
        for one in listed:
            own = json.dumps(one).encode()
            batch.add(*_with_topic(*parsed(own), topic), own, topic)

    def _came_before(self, topic: str, text: bytes, *, retained: bool) -> bool:
        """Whether this is the message that the broker keeps of a topic, and it was taken before."""
        key = f"mqtt {self.place} {topic}"
        digest = hashlib.sha256(text).hexdigest()
        before = self._last.get(key) or self._state.position(key)
        self._last[key] = digest
        return retained and before == digest

    def done(self, state: State) -> None:
        """Keep the last message of each topic: the broker may send it again."""
        for key, digest in self._last.items():
            state.set_position(key, digest)
        self._last.clear()
        state.set_position(self._session, self.topic)

    def empty(self) -> str:
        """Why no row has come."""
        return f"no message of {self.topic} has come"

    def acknowledge(self) -> None:
        """Tell the broker that the messages so far are dealt with."""
        for message in self._taken:
            self._client.ack(message.mid, message.qos)
        self._taken.clear()

    def close(self) -> None:
        """Leave the broker."""
        self._client.disconnect()
        self._client.loop_stop()


def client_of(parts: SplitResult, **settings: Any) -> Any:
    """A client for the broker of an address, which is not connected yet.

    Raises `UsageError` if the library is absent.
    """
    try:
        from paho.mqtt.client import Client
        from paho.mqtt.enums import CallbackAPIVersion
    except ImportError:
        raise UsageError("MQTT needs the library paho-mqtt: pip install 'echocal[mqtt]'") from None
    client = Client(CallbackAPIVersion.VERSION2, **settings)
    if parts.username:
        client.username_pw_set(unquote(parts.username), unquote(parts.password or ""))
    if parts.scheme == "mqtts":
        client.tls_set()
    return client


def connect(client: Any, parts: SplitResult) -> None:
    """Connect a client, and let it work.

    Raises `DataError` if the broker cannot be reached.
    """
    place = place_of(parts)
    host, _, port = place.rpartition(":")
    try:
        client.connect(host, int(port))
    except OSError as error:
        raise DataError(f"the broker {place} cannot be reached: {error.strerror or error}") from None
    client.loop_start()


def place_of(parts: SplitResult) -> str:
    """Host and port of a broker."""
    return f"{parts.hostname}:{parts.port or (8883 if parts.scheme == 'mqtts' else 1883)}"


def _with_topic(row: Row | None, why: str, topic: str) -> tuple[Row | None, str]:
    """A row with its topic; none that says another one."""
    if row is None:
        return row, why
    if row.get("topic", topic) != topic:
        return None, f"its field 'topic' says {row['topic']!r}, and it came on {topic!r}"[:300]
    return {"topic": topic, **row}, ""
