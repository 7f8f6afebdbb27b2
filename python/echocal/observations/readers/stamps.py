"""When a line was written, and what of it a program says: without clock, log level, and line of source."""

import re
from collections.abc import Mapping
from dataclasses import dataclass
from datetime import UTC, datetime
from functools import lru_cache

_ANSI = re.compile(r"\x1b\[[\d;?]*[A-Za-z]|\x1b\][^\x07]*\x07|\x1b[()][A-Z0-9]")
_DATE = (
    r"(?:\d{4}-\d\d-\d\d[T ]|\d{4}/\d\d/\d\d |\d{1,2}[./]\d{1,2}[./]\d{2,4},? |\d{1,2}-[A-Z][a-z]{2}-\d{4} )"
)
_CLOCK = rf"{_DATE}?\d{{1,2}}:\d\d:\d\d(?:[.,:]\d+)?(?: ?[AaPp]\.?[Mm]\b\.?)?"
_ZONE = r"(?:Z|[+-]\d\d:?\d\d)?"
_LEVEL = r"\s*(?:\[[A-Z]{1,5}\])?\s*"
_TAG = r"\[(?P<tag>[\w.:<>-]+?):(?P<line>\d+)\](?:\[[^\]]*\])?:?\s*"
_FORMS = tuple(
    (re.compile(form), column)
    for form, column in (
        # ESPHome, and what else has level and place in brackets: [14:00:00.123][D][sensor:093]: ...
        (rf"\[?(?P<time>(?={_DATE}){_CLOCK}{_ZONE}).*?\[{_CLOCK}\]{_LEVEL}{_TAG}(?P<rest>.*)", "time"),
        (rf".*?\[(?P<time>{_CLOCK})\]{_LEVEL}{_TAG}(?P<rest>.*)", "time"),
        (rf".*?\[(?P<time>{_CLOCK})\]\[[A-Z]{{1,5}}\]\[(?P<tag>[\w.-]+)\]:\s*(?P<rest>.*)", "time"),
        # Arduino's core for the ESP32: [  1234][I][main.cpp:52] loop(): ...
        (rf"\[\s*(?P<time>\d+)\]\[[A-Z]\]{_TAG}(?:\w+\(\):\s*)?(?P<rest>.*)", "time_ms"),
        # ESP-IDF: I (1234) TAG: ...
        (r"[EWIDV] \((?P<time>\d+)\) [\w.-]+: (?P<rest>.*)", "time_ms"),
        (rf"[EWIDV] \((?P<time>{_CLOCK})\) [\w.-]+: (?P<rest>.*)", "time"),
        # ESPEasy: 1234 : Info  : ...
        (r"(?P<time>\d+)\s*: (?:Info|Debug|Error|DebugMore)\s*: (?P<rest>.*)", "time_ms"),
        # ROS: [INFO] [1623456789.123456789] [node]: ...
        (
            r"\[[A-Z]+\]\s*\[(?:WallTime: )?(?P<time>\d+\.\d+)(?:, \d+\.\d+)?\]\s*"
            r"(?:\[[^\]]*\])?:?\s*(?P<rest>.*)",
            "time_s",
        ),
        # Zephyr: [00:00:01.234,000] <inf> sensor: ...
        (rf"\[(?P<time>{_CLOCK})(?:,\d{{3}})?\] <\w+> [\w.-]+: (?P<rest>.*)", "time"),
        # Android: 05-31 14:00:00.123  1234  1250 D Tag: ...
        (
            r"(?P<time>\d\d-\d\d \d\d:\d\d:\d\d\.\d+)\s+\d+\s+\d+ [A-Z] [^:]+: (?P<rest>.*)",
            "%m-%d %H:%M:%S.%f",
        ),
        (
            r"(?P<time>[A-Z][a-z]{2} [ \d]\d \d\d:\d\d:\d\d) \S+ \S+?: (?P<rest>.*)",
            "%b %d %H:%M:%S",
        ),  # syslog
        (
            rf"\s*[\[(]?(?P<time>{_CLOCK}{_ZONE})[\])]?\s*(?P<arrow>->|=>|>|\||;|:|,|-)?\s+(?P<rest>.*)",
            "time",
        ),
        (rf"\s*[\[(](?P<time>{_CLOCK}{_ZONE})[\])](?P<rest>.*)", "time"),
        (r"\s*\[\s*(?P<time>\d+\.\d+|\d+(?:\.\d+)?\s*s)\]\s*(?P<rest>.*)", "time_s"),
        (r"\s*[\[(]?\s*(?P<time>\d+(?:\.\d+)?)\s*ms[\])]?\s*:?\s+(?P<rest>.*)", "time_ms"),
        (r"\s*[\[(]\s*(?P<time>\d+)\s*[\])]\s*(?P<rest>\S.*)", "timestamp"),  # in a unit that nothing tells
    )
)
_SOURCE = re.compile(
    r"\[[A-Za-z_][\w.]*:\d+\](?=:| -|\[)|(?<![\w/])[\w./-]+\.(?:py|c|cc|cpp|h|hpp|ino|rs|js|ts|java|go|lua)"
    r":\d+(?::\d+)?(?![\w.])"
)
"""A line of a program: ``[ultrasonic.sensor:053]``, ``main.cpp:52``."""
_ARROWS = frozenset({"->", "=>"})


@dataclass(frozen=True)
class Stamped:
    """A line of a log."""

    time: Mapping[str, str]  # its clock by the column that it belongs to; empty where the line has none
    rest: str  # what the line says
    arrow: bool = False  # whether an arrow is between both, as a serial monitor writes it
    tag: str = ""  # which part of a program says it; empty where the line does not tell


def plain(line: str) -> str:
    """A line without the colors of a terminal."""
    return _ANSI.sub("", line) if "\x1b" in line else line


@lru_cache(maxsize=1024)
def stamped(line: str) -> Stamped:
    """Clock and rest of a line.

    Examples
    --------
    >>> stamped("[08:00:00][V][sensor.ultrasonic:053]: Echo took 11us")
    Stamped(time={'time': '08:00:00'}, rest='Echo took 11us', arrow=False, tag='sensor.ultrasonic')
    >>> stamped("14:00:00.199 -> dist 12 cm").time, stamped("[ 1234][I][main.cpp:52] loop(): d=12").time
    ({'time': '14:00:00.199'}, {'time_ms': '1234'})
    """
    for form, column in _FORMS:
        if match := form.fullmatch(line):
            parts = match.groupdict()
            rest = _SOURCE.sub(" ", parts["rest"]).strip()
            return Stamped(
                _time(parts["time"], column), rest, parts.get("arrow") in _ARROWS, parts.get("tag") or ""
            )
    return Stamped({}, _SOURCE.sub(" ", line).strip())


def _time(written: str, column: str) -> dict[str, str]:
    if "%" in column:  # a date without a year
        instant = datetime.strptime(f"2000 {written}", f"%Y {column}").replace(tzinfo=UTC)
        return {"time_s": f"{instant.timestamp():.3f}"}
    if column == "time":
        written = re.sub(r"(?<=\d),(?=\d)|(?<=:\d\d:\d\d):(?=\d)", ".", written)
    return {column: written}
