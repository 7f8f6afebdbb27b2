"""Lines of an ESPHome log: ``[14:00:00][D][sensor:093]: 'Distance': Sending state 1.234 m ...``."""

import re
from collections.abc import Sequence

from echocal.observations.readers.log import Log

__all__ = ["NAME", "read", "recognizes"]

NAME = "log of ESPHome"

_LINE = re.compile(
    r".*?\[(?P<time>\d\d:\d\d:\d\d(?:\.\d+)?)\].*?'(?P<name>[^']+)'(?::| ?>>) (?:Sending state |Got )?"
    r"(?P<value>[-\d.]+|nan)\s*(?P<unit>\S*).*"
)
_ANSI = re.compile(r"\x1b\[[\d;]*m")


def recognizes(lines: Sequence[str]) -> bool:
    """Whether the lines are a log of ESPHome with states."""
    return sum(
        "Sending state" in line or (" >> " in line and "[S][sensor" in line) for line in lines
    ) > 1 and any(_LINE.fullmatch(_ANSI.sub("", line)) for line in lines)


def read(lines: Sequence[str], path: str) -> Log:
    """Read the states; those between two of one name are one row. Other lines are no rows."""
    log = Log([])
    records: list[dict[str, str]] = []
    for line in lines:
        match = _LINE.fullmatch(_ANSI.sub("", line))
        if match is None:
            continue
        if not records or match["name"] in records[-1]:
            records.append({"time": match["time"]})
        records[-1][match["name"]] = match["value"]
        if match["unit"] and match["unit"] != "with":
            log.units[match["name"]] = match["unit"]
    log.records = records
    log.notes.append("states between two of the same sensor are one row")
    return log
