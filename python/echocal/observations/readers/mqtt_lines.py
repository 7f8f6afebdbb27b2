"""Lines of ``mosquitto_sub -v``: a topic and its payload, a number or JSON (Tasmota, Zigbee2MQTT)."""

import re
from collections import Counter
from collections.abc import Collection, Sequence
from typing import Any

from echocal.observations.fields import shown
from echocal.observations.hints import is_time_name
from echocal.observations.limits import from_json
from echocal.observations.readers.events import Event, ranger_names, rows_of
from echocal.observations.readers.json_records import flat
from echocal.observations.readers.log import Log

NAME = "topics and payloads of MQTT"

_LINE = re.compile(
    r"(?:\[?(?P<time>\d{4}-\d\d-\d\d[T ]\d\d:\d\d:\d\d(?:[.,]\d+)?(?:Z|[+-]\d\d:?\d\d)?"
    r"|\d{1,2}:\d\d:\d\d(?:\.\d+)?|\d{10}(?:\.\d+)?|\d{13})\]?[ :\t]+)?"
    r"(?P<topic>[\w.$ -]+(?:/[\w.:$-]+)+)[ :\t] ?(?P<payload>[-+]?[\d.]+|nan|\{.*\})"
)


def recognizes(lines: Sequence[str]) -> bool:
    """Whether most lines are a topic and a payload."""
    look = lines[:100]
    return 2 * sum(bool(_LINE.fullmatch(line.strip())) for line in look) > len(look)


def read(lines: Sequence[str], path: str) -> Log:
    """Read the payloads; a row is a payload of the ranger, with those of other topics at its time."""
    log = Log()
    told, others = [], []
    for line in filter(str.strip, lines):
        match = _LINE.fullmatch(line.strip())
        values = None if match is None else _values(match["topic"], match["payload"])
        if match is None or values is None:
            others.append(line)
            continue
        told.append((line, match["time"], values))
    if others:
        log.notes.append(
            f"{len(others)} lines are no topic with a payload and are no rows, first '{shown(others[0])}'"
        )
    short = _short(dict.fromkeys(name for _, _, values in told for name in values))
    events = [_event(line, time, {short[n]: own for n, own in values.items()}) for line, time, values in told]
    names = list(dict.fromkeys(name for event in events for name in event.holds))
    return rows_of(events, ranger_names(names, {}), log)


def _event(line: str, time: str | None, values: dict[str, Any]) -> Event:
    own = next((name for name in values if is_time_name(name)), None)
    clock = {"time": time.replace(",", ".")} if time else {} if own is None else {own: values[own]}
    return Event(clock, {name: value for name, value in values.items() if name != own}, line)


def _values(topic: str, payload: str) -> dict[str, Any] | None:
    """Values of a payload by their whole names."""
    if not payload.startswith("{"):
        return {topic: payload}
    try:
        return {f"{topic}.{name}": own for name, own in flat(from_json(payload)).items()}
    except ValueError:
        return None


def _short(names: Collection[str]) -> dict[str, str]:
    """The last part of each name where no other name has it: of two tanks each keeps its topic."""
    last = {name: re.split(r"[/.]", name)[-1] for name in names}
    count = Counter(last.values())
    return {name: own if count[own] == 1 or is_time_name(own) else name for name, own in last.items()}
