"""Line protocol of InfluxDB: ``tank,site=roof distance=12.3,temperature=20.1 1700000000000000000``."""

import re
from collections.abc import Sequence
from typing import Any

from echocal.observations.readers.log import Log

NAME = "line protocol of InfluxDB"

_LINE = re.compile(
    r"(?P<head>[^\s,=]+(?:,[^\s,=]+=[^\s,]+)*) (?P<fields>[^\s=]+=[^\s]+?)(?: (?P<time>\d{10,19}))?"
)


def recognizes(lines: Sequence[str]) -> bool:
    """Whether most lines are of the protocol."""
    look = lines[:100]
    full = [match for line in look if (match := _LINE.fullmatch(line.strip()))]
    return 2 * len(full) > len(look) and all(match["time"] for match in full)


def read(lines: Sequence[str], path: str) -> Log:
    """Read the lines; tags are columns."""
    log = Log()
    for line in filter(str.strip, lines):
        if line.startswith("#"):
            continue
        match = _LINE.fullmatch(line.strip())
        if match is None:
            log.lose(line)
            continue
        record: dict[str, Any] = dict(pair.split("=", 1) for pair in match["head"].split(",")[1:])
        for pair in match["fields"].split(","):
            name, _, value = pair.partition("=")
            record[name] = value.strip('"').rstrip("iu") if re.match(r'["\d+-]', value) else value
        log.records.append({**record, "timestamp": match["time"]})
    return log
