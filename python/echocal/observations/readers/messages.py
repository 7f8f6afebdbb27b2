"""Messages of a log that end in JSON: ``14 May 22:00:00 - [info] [function:dist] {"distance": 185.5}``."""

import re
from collections.abc import Mapping, Sequence
from typing import Any

from echocal.observations.hints import is_time_name
from echocal.observations.limits import from_json
from echocal.observations.readers.events import of_several_messages
from echocal.observations.readers.json_records import flat
from echocal.observations.readers.log import Log

NAME = "messages that end in JSON"

_MESSAGE = re.compile(r"(?P<before>[^{]*[^{\s,;\"'=:]\s*[:=]?\s*['\"]?)(?P<json>\{.*\})['\")\]]*\s*")
_TIME = re.compile(
    r"\d{4}-\d\d-\d\d[T ]\d\d:\d\d:\d\d(?:[.,]\d+)?(?:Z|[+-]\d\d:?\d\d)?|\b\d{1,2}:\d\d:\d\d(?:[.,]\d+)?"
)


def recognizes(lines: Sequence[str]) -> bool:
    """Whether most lines have some words before a record of JSON."""
    look = lines[:100]
    return 2 * sum(_values(line) is not None for line in look) > len(look)


def read(lines: Sequence[str], path: str) -> Log:
    """Read the records, and the time before each where the record has none."""
    log = Log()
    for line in filter(str.strip, lines):
        values = _values(line)
        if values is None:
            log.lose(line)
        else:
            log.records.append(values)
    return of_several_messages(log.records, log)


def _values(line: str) -> dict[str, Any] | None:
    match = _MESSAGE.fullmatch(line.strip())
    if match is None:
        return None
    try:
        record = from_json(match["json"])
    except ValueError:
        return None
    if not isinstance(record, Mapping):
        return None
    values = {name.rpartition(".")[2]: own for name, own in flat(record).items()}
    time = _TIME.search(match["before"])
    return (
        values
        if time is None or any(map(is_time_name, values))
        else {"time": time[0].replace(",", "."), **values}
    )
