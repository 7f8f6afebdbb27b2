"""Lines of ``mosquitto_sub -v``: a topic and its payload, a number or JSON (Tasmota, Zigbee2MQTT)."""

import json
import re
from collections.abc import Sequence
from typing import Any

from echocal.observations.readers.json_records import flat
from echocal.observations.readers.log import Log

__all__ = ["NAME", "read", "recognizes"]

NAME = "topics and payloads of MQTT"

_LINE = re.compile(r"(?P<topic>[\w.$ -]+(?:/[\w.:$-]+)+) (?P<payload>[-+]?[\d.]+|nan|\{.*\})")


def recognizes(lines: Sequence[str]) -> bool:
    """Whether most lines are a topic and a payload."""
    look = lines[:100]
    return 2 * sum(bool(_LINE.fullmatch(line.strip())) for line in look) > len(look)


def read(lines: Sequence[str], path: str) -> Log:
    """Read the payloads; those between two of one topic are one row."""
    log = Log([])
    records: list[dict[str, Any]] = []
    for line in filter(str.strip, lines):
        match = _LINE.fullmatch(line.strip())
        values = None if match is None else _values(match["topic"], match["payload"])
        if values is None:
            log.corrupt[len(records)] = line
            records.append({})
            continue
        if not records or set(values) & set(records[-1]) or len(records) - 1 in log.corrupt:
            records.append({})
        records[-1] |= values
    log.records = records
    log.notes.append("payloads between two of the same topic are one row")
    return log


def _values(topic: str, payload: str) -> dict[str, Any] | None:
    if not payload.startswith("{"):
        return {topic.rpartition("/")[2]: payload}
    try:
        return {name.rpartition(".")[2]: own for name, own in flat(json.loads(payload)).items()}
    except ValueError:
        return None
