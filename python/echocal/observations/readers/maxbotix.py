"""Serial output of MaxBotix rangers: ``R1234``.

Four digits are millimeters (MB73xx, HRXL-MaxSonar-WR data sheet), three are inches (LV-MaxSonar) or
centimeters (XL-MaxSonar): these are refused until somebody says which.
"""

import re
from collections.abc import Sequence

from echocal.observations.readers.log import Log

NAME = "serial output of a MaxBotix ranger"

_LINE = re.compile(
    r"(?:(?P<time>[\dT:./ -]*\d:\d\d(?::\d\d(?:[.,]\d+)?)?Z?)\s*(?:->|,|;|\t)?\s*)?R(?P<value>\d{3,5})"
    r"(?:\s*(?:P(?P<proximity>\d)|T(?P<temperature>[-\d.]+)|TP\d))*\s*"
)


def recognizes(lines: Sequence[str]) -> bool:
    """Whether most lines are R and digits."""
    look = lines[:100]
    return 2 * sum(bool(_LINE.fullmatch(line.strip())) for line in look) > len(look)


def read(lines: Sequence[str], path: str) -> Log:
    """Read the lines; 300, 500, 5000 and 9999 are kept as they are."""
    log = Log()
    digits = [len(match["value"]) for line in lines if (match := _LINE.fullmatch(line.strip()))]
    name = "range"
    if digits and min(digits) >= 4:
        name = "range_mm"
        log.units[name] = "mm"
        log.notes.append("R and four digits are read as millimeters (data sheet of the HRXL-MaxSonar)")
    for line in filter(str.strip, lines):
        match = _LINE.fullmatch(line.strip())
        if match is None:
            if log.records:
                log.lose(line)
            continue
        record = {name: match["value"]}
        if match["time"]:
            record = {"time": match["time"].strip().replace(",", "."), **record}
        if match["temperature"]:
            record["temperature (°C)"] = match["temperature"]
        log.records.append(record)
    return log
