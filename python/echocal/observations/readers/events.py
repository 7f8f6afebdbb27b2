"""Values that a log gives one after the other, each with its time: those of the ranger are its rows."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import pandas as pd

from echocal.observations.in_time import joined, seconds_of, spread
from echocal.observations.join import told
from echocal.observations.readers.leads import changes_smoothly
from echocal.observations.readers.log import Log

__all__ = ["Event", "rows_of"]


@dataclass(frozen=True)
class Event:
    """What a line of a log says at its time.

    Attributes
    ----------
    time : mapping of str to str
        The clock of the line by its column.
    values : mapping of str to object
        Empty where the line says that no echo came.
    said : str
        The line.
    """

    time: Mapping[str, Any]
    values: Mapping[str, Any]
    said: str = ""


def rows_of(events: Sequence[Event], ranger: Sequence[str], log: Log, beside: Sequence[str] = ()) -> Log:
    """A row for each measurement of the ranger, with the values that other quantities have at its time.

    Parameters
    ----------
    events : sequence of Event
    ranger : sequence of str
        Names of the values that a measurement has. One ends where a name comes again.
    log : Log
        With the units of the values; gets the rows.
    beside : sequence of str
        Further values of the ranger, which belong to the measurement before, however often they come.
    """
    places, records = _measurements(events, ranger, beside, log)
    times = pd.Series([next(iter(event.time.values()), None) for event in events], dtype=object)
    seconds = spread(seconds_of(times))
    for name in dict.fromkeys(name for event in events for name in event.values if name not in {*ranger, *beside}):
        where = [n for n, event in enumerate(events) if name in event.values]
        if set(where) <= set(places):
            continue  # written with the measurement itself
        values = pd.to_numeric(pd.Series([events[n].values[name] for n in where]), errors="coerce")
        numbers = values.to_numpy(dtype=np.float64, na_value=np.nan)
        smooth = changes_smoothly(name, log.units.get(name, ""))
        found, log.joined[name] = joined(seconds[places], seconds[where], numbers, smooth=smooth)
        for record, value in zip(records, found.tolist(), strict=True):
            record[name] = value
    log.records = records
    if log.joined:
        log.notes += [f"a row is a measurement of {' and '.join(map(repr, ranger))}", *told(log.joined)]
    return log


def _measurements(
    events: Sequence[Event], ranger: Sequence[str], beside: Sequence[str], log: Log
) -> tuple[list[int], list[dict[str, Any]]]:
    """Places of the first event of each measurement, and its record."""
    places: list[int] = []
    records: list[dict[str, Any]] = []
    for place, event in enumerate(events):
        last = set(records[-1]) if records else set()
        if event.values and not set(ranger) & set(event.values):
            if records:
                records[-1] |= {name: own for name, own in event.values.items() if name in beside}
            continue
        # no echo ends the measurement that has begun, or is one of its own
        if not records or (set(event.values) & last if event.values else set(ranger) <= last):
            places.append(place)
            records.append(dict(event.time))
        records[-1] |= event.values
        if not event.values:
            records[-1] = {**dict.fromkeys(ranger), **records[-1]}
            log.corrupt[len(records) - 1] = event.said
    return places, records
