"""Lines of an ESPHome log: ``[14:00:00][D][sensor:093]: 'Distance': Sending state 1.234 m ...``."""

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Literal

import numpy as np
import pandas as pd

from echocal.keywords import keyword
from echocal.observations.fields import floats
from echocal.observations.numbers import says_no_echo
from echocal.observations.readers.events import Event, ranger_names, rows_of
from echocal.observations.readers.log import Log
from echocal.observations.readers.pairs import pairs_of
from echocal.observations.readers.stamps import Stamped, stamped
from echocal.observations.units import NAMES, symbol_of

NAME = "log of ESPHome"

_STATE = re.compile(
    r"'(?P<name>[^']+)'(?::| ?>>) ?(?:(?:Sending|Received new) state )?(?P<value>[-+\d.eE]+|nan)\s*"
    r"(?P<unit>(?!with\b)[^\s\d]\S*)?(?:\s+with \d+ decimals.*)?"
)
_ECHO = re.compile(r"Echo took (?P<value>\d+)\s*[µμu]s(?: \((?P<length>[\d.]+)\s*m\))?")
_DISTANCE = re.compile(
    r"(?:'?(?P<name>[^']*?)'? - )?(?:Got distance|Distance from sensor): "
    r"(?P<value>[\d.]+)\s*(?P<unit>mm|cm|m)\b"
    r"(?:.*?echo: (?P<echo>\d+)\s*[µμu]s)?.*"
)
_CONFIGURATION = re.compile(r"(?:^|[\]\s])\[C\]\[")
"""What a component is set to: each session begins with it."""
_OF_NAME = re.compile(r"'(?P<name>[^']+)' - ")
_FIXED_SPEED = re.compile(r"sensor\.ultrasonic|ultrasonic\.sensor")
_NOTE = "the component 'ultrasonic' of ESPHome makes readings with 343 m/s (us_to_m in ultrasonic_sensor.cpp)"
_WIDE = 300  # characters that tell of what kind a line is
_SPELLED = "Got distance"


@dataclass(frozen=True)
class _Said:
    """What a line says, and which sensor it is of."""

    line: Stamped
    kind: Literal["echo", "distance", "state", "silent", "other"]
    sensor: str
    holds: Mapping[str, str]
    units: Mapping[str, str] = field(default_factory=dict)


def recognizes(lines: Sequence[str]) -> bool:
    """Whether the lines are a log of ESPHome with values."""
    told = (line.rest for line in map(stamped, (line[:_WIDE] for line in lines)) if line.tag)
    return sum(any(form.match(rest) for form in (_STATE, _ECHO, _DISTANCE)) for rest in told) > 1


def read(lines: Sequence[str], path: str) -> Log:
    """Read what the sensors tell, a row for each measurement of the ranger. Other lines are no rows."""
    told = [stamped(line) for line in lines if not _CONFIGURATION.search(line[:_WIDE])]
    said = _with_owners([own for line in told if line.tag and (own := _said(line))])
    states = {own.sensor for own in said if own.kind == "state"}
    said = [own for own in said if own.kind != "other" or not states]  # each value is a state, too
    rangers = list(dict.fromkeys(own.sensor for own in said if own.kind in {"echo", "distance"}))
    said = [own for own in said if own.kind != "silent" or own.sensor in rangers]
    log = Log()
    for own in said:
        log.units |= {_column(name, own, rangers): unit for name, unit in own.units.items()}
    events = [_event(own, rangers) for own in said]
    if not rangers:
        names = list(dict.fromkeys(name for event in events for name in event.holds))
        return rows_of(events, (ranger_names(names, log.units) or names)[:1], log)
    sensor = rangers[0]
    first = [own for own in said if own.sensor == sensor and own.kind in {"echo", "distance"}]
    columns = list(dict.fromkeys(_column(name, own, rangers) for own in first for name in own.holds))
    log = rows_of(events, columns, log, beside=[sensor])
    if any(_FIXED_SPEED.fullmatch(own.line.tag) for own in first):
        log.notes.append(f"{_NOTE}: {keyword('reading_speed', 343)}")
    _settle(log, columns, sensor)
    return log


def _said(line: Stamped) -> _Said | None:
    rest = line.rest
    if match := _ECHO.match(rest):
        length = {"Distance": match["length"]} if match["length"] else {}
        return _Said(
            line, "echo", "", {"Echo took": match["value"], **length}, {"Echo took": "us", "Distance": "m"}
        )
    if match := _DISTANCE.fullmatch(rest):
        echo = {"Echo": match["echo"]} if match["echo"] else {}
        units = {_SPELLED: match["unit"], "Echo": "us"}
        return _Said(line, "distance", match["name"] or "", {_SPELLED: match["value"], **echo}, units)
    if match := _STATE.fullmatch(rest):
        unit = {match["name"]: match["unit"]} if symbol_of(match["unit"] or "") else {}
        return _Said(line, "state", match["name"], {match["name"]: match["value"]}, unit)
    if says_no_echo(rest):
        named = _OF_NAME.match(rest)
        return _Said(line, "silent", named["name"] if named else "", {})
    pairs = pairs_of(rest)
    units = {name: unit for name, _, unit in pairs if symbol_of(unit)}
    return _Said(line, "other", "", {name: value for name, value, _ in pairs}, units) if pairs else None


def _with_owners(said: Sequence[_Said]) -> list[_Said]:
    """An echo, and whatever has no name, is of the ranger that a line below names."""
    found: list[_Said] = []
    name = next((own.sensor for own in reversed(said) if own.kind == "distance" and own.sensor), "")
    for own in reversed(said):
        if own.kind in {"distance", "silent"} and own.sensor:
            name = own.sensor
        found.append(own if own.sensor or own.kind == "other" else replace(own, sensor=name))
    return found[::-1]


def _column(name: str, own: _Said, rangers: Sequence[str]) -> str:
    """Column of a value; with the name of its sensor where there are several rangers."""
    alone = own.kind in {"state", "other"} or len(rangers) < 2
    return name if alone else f"{own.sensor} - {name}"


def _event(own: _Said, rangers: Sequence[str]) -> Event:
    values = {_column(name, own, rangers): value for name, value in own.holds.items()}
    if own.kind == "silent" and rangers.index(own.sensor):  # of another ranger
        values = {_column(_SPELLED, own, rangers): "nan"}
    return Event(own.line.time, values, own.line.rest)


def _settle(log: Log, columns: Sequence[str], sensor: str) -> None:
    """One reading, that with the most digits of those that are the same, and the echo time: both are sure."""
    table = pd.DataFrame(log.records)
    lengths = [name for name in columns if symbol_of(log.units.get(name, "")) in {"m", "cm", "mm"}]
    if sensor in log.units or lengths:
        log.units.setdefault(sensor, log.units.get(lengths[0], "") if lengths else "")
    alike = [name for name in (*lengths, sensor) if name in table and table[name].notna().any()]
    best = alike[0] if alike else ""
    for name in alike[1:]:
        if (finer := _finer(table, best, name, log.units)) is None:
            continue
        best, other = (name, best) if finer == name else (best, name)
        log.notes.append(f"'{other}' is '{best}' with fewer digits and is left out")
        for record in log.records:
            record.pop(other, None)
    for name in (*columns, best):
        unit = symbol_of(log.units.get(name, ""))
        request = f"echo_{unit}" if unit == "us" else f"reading_{unit}" if name == best else "extra"
        if request in NAMES:
            log.requests[name] = request


def _finer(table: pd.DataFrame, first: str, second: str, units: Mapping[str, str]) -> str | None:
    """Which of two columns has more digits, if they are the same otherwise."""
    numbers, steps = [], []
    for name in (first, second):
        unit = NAMES.get(f"reading_{symbol_of(units.get(name, ''))}")
        if unit is None:
            return None
        digits = max(
            (len(str(v).partition(".")[2]) for v in table[name].dropna() if str(v) != "nan"), default=0
        )
        numbers.append(unit[0].units[unit[1]].to_si(floats(table[name])))
        steps.append(float(unit[0].units[unit[1]].to_si(10.0**-digits)))
    apart = np.abs(numbers[0] - numbers[1])
    both = np.isfinite(apart)
    if not both.any() or (apart[both] > 0.5001 * max(steps) + 1e-12).any():
        return None
    return first if steps[0] <= steps[1] else second
