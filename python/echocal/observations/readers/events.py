"""Values that a log gives one after the other, each with its time: those of the ranger are its rows."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import pandas as pd

from echocal.observations.found import Join, told
from echocal.observations.hints import hint, is_time_name, role_of
from echocal.observations.in_time import clock_of, joined, spread
from echocal.observations.readers.log import Log, numeric
from echocal.observations.units import split_unit, symbol_of

Record = dict[str, Any]
_LEADS = (
    "distance", "dist", "abstand", "entfernung", "echo", "reading", "range", "ultrasonic", "sonar", "tank",
    "level",
)  # fmt: skip
_LENGTHS = {"m", "cm", "mm", "inch", "ft"}
_AIR_UNITS = {"C", "F", "K", "percent", "Pa", "hPa", "kPa", "mbar", "ppm", "m_s", "km_h", "W_m2", "lux"}
_AIR = (
    "temp", "humid", "press", "luft", "feuchte", "druck", "wind", "radiation", "solar", "light", "lux",
    "co2", "thermo", "dew", "taupunkt", "hum", "rh",
)  # fmt: skip


@dataclass(frozen=True)
class Event:
    """What a line of a log says at its time."""

    time: Mapping[str, Any]  # the clock of the line by its column; empty where it has none
    holds: Mapping[str, Any]  # empty where the line says that no echo came
    said: str = ""  # the line
    ends: bool = False  # whether a blank line is above it that ends what came before


def rows_of(events: Sequence[Event], ranger: Sequence[str], log: Log, beside: Sequence[str] = ()) -> Log:
    """A row for each measurement of the ranger, with the values that other quantities have at its time.

    Without a clock, or without a name that says which quantity is the ranger's, rows follow the order of
    the values, see `rows_by_order`.

    Parameters
    ----------
    ranger : sequence of str
        Names of the values that a measurement has. One ends where a name comes again.
    log : Log
        With the units of the values; gets the rows.
    beside : sequence of str
        Further values of the ranger, which belong to the measurement before, however often they come.
    """
    if not ranger or 2 * sum(bool(event.time) for event in events) <= len(events):
        return rows_by_order(events, ranger, log)
    places, records = _measurements(events, ranger, beside, log)
    name = next(name for event in events for name in event.time)
    times = pd.Series([event.time.get(name) for event in events], dtype=object, name=name)
    clock = clock_of(times)
    clock = replace(clock, times=spread(clock.times))
    for name in dict.fromkeys(n for event in events for n in event.holds if n not in {*ranger, *beside}):
        if 2 * sum(name in record for record in records) > len(records):
            continue  # written with the measurement itself
        where = [n for n, event in enumerate(events) if name in event.holds]
        own = [events[n].holds[name] for n in where]
        numbers = numeric(pd.Series(own, dtype=object))
        texts = not pd.api.types.is_numeric_dtype(numbers)
        values = (
            np.arange(len(own), dtype=np.float64) if texts else numbers.to_numpy(np.float64, na_value=np.nan)
        )
        smooth = not texts and changes_smoothly(name, log.units.get(name, ""))
        found, log.joined[name] = joined(clock, places, where, values, smooth=smooth)
        for record, value in zip(records, found.tolist(), strict=True):
            record[name] = own[int(value)] if texts and value == value else value
    log.records = records
    if log.joined:
        log.notes += [f"a row is a measurement of {' and '.join(map(repr, ranger))}", *told(log.joined)]
    return log


def rows_by_order(events: Sequence[Event], ranger: Sequence[str], log: Log) -> Log:
    """Rows end where a name comes again, or at blank lines if values stand in blocks between them."""
    records: list[Record] = []
    blocks = any(event.ends for event in events)
    for event in events:
        if event.ends or _is_next(event, records, ranger):
            records.append(dict(event.time))
        _add(event, records, ranger, log)
    log.records = records
    log.notes.append(f"values between two {'blank lines' if blocks else 'of the same name'} are one row")
    if ranger and not blocks:
        others = [
            name for name in dict.fromkeys(n for own in events for n in own.holds) if name not in ranger
        ]
        log.joined |= dict.fromkeys(others, Join("ordered", 0.0, 0.0, 0))
    return log


def of_several_messages(records: list[Record], log: Log) -> Log:
    """Rows of messages with their times: some have a reading, and others only further quantities."""
    names = list(dict.fromkeys(name for record in records for name in record))
    clocks = [name for name in names if is_time_name(name) and all(name in own for own in records)]
    ranger = ranger_names([name for name in names if not is_time_name(name)], log.units)
    apart = [own for own in records if not set(ranger) & set(own)]
    log.records = records
    if not ranger or not clocks or not apart or log.corrupt:
        return log
    clock = clocks[0]
    events = [Event({clock: own[clock]}, {n: v for n, v in own.items() if n != clock}) for own in records]
    count = len(records)
    log = rows_of(events, ranger, log)
    log.notes.insert(0, f"{len(apart)} of {count} messages have no reading and are no rows")
    return log


def _measurements(
    events: Sequence[Event], ranger: Sequence[str], beside: Sequence[str], log: Log
) -> tuple[list[int], list[Record]]:
    """Places of the first event of each measurement, and its record."""
    places: list[int] = []
    records: list[Record] = []
    for place, event in enumerate(events):
        if event.holds and not set(ranger) & set(event.holds):
            if records:
                records[-1] |= {name: own for name, own in event.holds.items() if name in beside}
            continue
        if _is_next(event, records, ranger):
            places.append(place)
            records.append(dict(event.time))
        _add(event, records, ranger, log)
    return places, records


def _is_next(event: Event, records: Sequence[Record], ranger: Sequence[str]) -> bool:
    """Whether an event begins a row: its name has come, or no echo came and the last measurement is whole."""
    last = set(records[-1]) if records else set()
    return not records or (bool(set(event.holds) & last) if event.holds else set(ranger) <= last)


def _add(event: Event, records: list[Record], ranger: Sequence[str], log: Log) -> None:
    records[-1] |= event.holds
    if not event.holds:
        records[-1] = {**dict.fromkeys(ranger), **records[-1]}
        log.corrupt[len(records) - 1] = event.said


def ranger_names(names: Sequence[str], units: Mapping[str, str]) -> list[str]:
    """Names that are the ranger's own: those that say a reading or an echo; else those that may be.

    Examples
    --------
    >>> ranger_names(["Temp", "Echo took", "Got distance"], {"Echo took": "us", "Got distance": "m"})
    ['Echo took', 'Got distance']
    >>> ranger_names(["outdoor", "tank"], {}), ranger_names(["a", "b"], {"b": "cm"})
    (['tank'], ['b'])
    """
    said = [name for name in names if _says(name, units.get(name, ""))]
    alike = [name for word in _LEADS for name in names if word in name.lower()]
    lengths = [name for name in names if (symbol_of(units.get(name, "")) or symbol_of(name)) in _LENGTHS]
    return said or alike[:1] or lengths[:1]


def changes_smoothly(name: str, unit: str) -> bool:
    """Whether a quantity is one of the air, which goes from one value to the next without a jump."""
    if (symbol_of(unit) or split_unit(name)[1] or symbol_of(name)) in _AIR_UNITS:
        return True
    return any(word in name.lower() for word in _AIR)


def _says(name: str, unit: str) -> bool:
    said = hint(name, unit)
    if said is not None:
        return said.name.startswith(("reading", "echo_")) and said.name != "echo_quality"
    return role_of(name) in {"reading", "echo"}
