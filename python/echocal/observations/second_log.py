"""A reference from another log: a tide gauge, a second logger; joined by time."""

from collections.abc import Mapping

import numpy as np
import pandas as pd

from echocal.arrays import Column
from echocal.errors import DataError, UsageError
from echocal.keywords import keyword
from echocal.observations import clock
from echocal.observations.found import Join, found_in, told
from echocal.observations.hints import completed
from echocal.observations.in_time import Clock, joined
from echocal.observations.marks import seconds
from echocal.observations.numbers import Missing, to_numbers
from echocal.observations.options import ReadOptions
from echocal.observations.plan import Assignment, make, refuse_absent
from echocal.observations.source import load

_FEWEST = 3  # values of which one is predicted by its neighbors
_APART = 1.5
"""Variance of a value less the mean of its neighbors, of independent errors with variance 1."""


def with_reference(
    table: pd.DataFrame, requests: Mapping[str, str], how: ReadOptions
) -> tuple[pd.DataFrame, dict[str, str], dict[str, Join], float, list[str]]:
    """A table with the reference of another log at its times; what the user says of a column is of both logs.

    Raises `DataError` if one of both has no time, the other has no reference, or no row has a value near in
    time.

    Returns
    -------
    DataFrame
    dict
        Meaning of its columns.
    dict
        How the reference came to the rows, by its column.
    float
        Standard uncertainty of the reference by the join [m].
    list of str
        What a person should know.
    """
    if how.reference_join not in ("interpolated", "nearest"):
        raise UsageError(f"{keyword('reference_join', how.reference_join)}: interpolated or nearest")
    other = load(how.reference, how.layout)
    refuse_absent(how.requests, list(dict.fromkeys([*table.columns, *other.columns])))
    own, said = _completed(other, how.requests_of(other.columns))
    held = make(list(other.columns), own).assignments
    source = held.get("reference_distance")
    if source is None:
        raise DataError(
            f"the reference has no column of reference distances; it has {', '.join(other.columns)}: "
            f"{keyword('columns', {'NAME': 'distance_m'})}, or 'reference_level_m'"
        )
    planned = make(list(table.columns), _completed(table, requests)[0]).assignments
    if "reference_distance" in planned:
        raise DataError(
            f"the table has a reference distance, '{planned['reference_distance'].column}', and so has "
            f"the reference, '{source.column}'; leave one out: "
            f"{keyword('columns', {planned['reference_distance'].column: 'ignore'})}"
        )
    rows, times = _times(table, planned, "the table", how), _times(other, held, "the reference", how)
    if rows[1] != times[1]:
        raise DataError(
            "the times of the table and of the reference have no common zero: one has dates, and the "
            "other counts; give both dates"
        )
    values = to_numbers(other[source.column], source.column, Missing(how.missing), [])
    at = Clock(np.concatenate([rows[0], times[0]]))
    count, smooth = len(table), how.reference_join != "nearest"
    places = np.arange(count), np.arange(count, count + len(values))
    taken, join = joined(at, *places, values, smooth=smooth)
    if not np.isfinite(taken).any():
        raise DataError(
            f"no row of the table has a value of '{source.column}' near in time: the table goes from "
            f"{_shown(rows)}, the reference from {_shown(times)}; a zone: {keyword('time_zone', '+01:00')}"
        )
    name = source.column if source.column not in table.columns else f"{source.column} (reference)"
    u = abs(source.unit.numerator / source.unit.denominator) * _uncertainty(times[0], values)
    said.append(
        f"{told({name: join})[0]}; standard uncertainty of a value {1e3 * u:.2g} mm, by how well its "
        "neighbors predict a value of the reference"
    )
    meaning = {**requests, name: own.get(source.column, source.name)}
    return table.assign(**{name: taken}), meaning, {name: join}, u, said


def _completed(table: pd.DataFrame, requests: Mapping[str, str]) -> tuple[dict[str, str], list[str]]:
    return completed(list(table.columns), requests, found_in(table))


def _times(
    table: pd.DataFrame, held: Mapping[str, Assignment], whose: str, how: ReadOptions
) -> tuple[Column, bool]:
    """Seconds of each row, and whether they are those of a date."""
    source = held.get("elapsed_time")
    if source is None:
        raise DataError(
            f"{whose} has no time, by which a reference is joined; it has {', '.join(table.columns)}: "
            f"{keyword('columns', {'NAME': 'time'})}"
        )
    if source.name != "time":
        return np.asarray(
            source.unit.to_si(to_numbers(table[source.column], source.column, Missing(()), []))
        ), False
    zone = clock.zone_of(source.column, how.time_zone)
    instants, _ = clock.instants(table[source.column], source.column, zone, how.time_format)
    return seconds(instants), True


def _uncertainty(times: Column, values: Column) -> float:
    """Standard uncertainty of a value between two others: how far each is from the line of its neighbors.

    This spans twice the interval, so it is an upper bound for a smooth quantity, and the scatter of the
    values for one that scatters.
    """
    known = np.isfinite(times) & np.isfinite(values)
    order = np.argsort(times[known], kind="stable")
    t, v = times[known][order], values[known][order]
    keep = np.append(np.diff(t) > 0.0, True) if len(t) else np.zeros(0, dtype=np.bool_)
    t, v = t[keep], v[keep]
    if len(t) < _FEWEST:
        return 0.0
    part = (t[1:-1] - t[:-2]) / (t[2:] - t[:-2])
    off = v[1:-1] - (v[:-2] + part * (v[2:] - v[:-2]))
    return float(np.sqrt(np.mean(off**2) / _APART))


def _shown(times: tuple[Column, bool]) -> str:
    ends = np.nanmin(times[0]), np.nanmax(times[0])
    if not times[1]:
        return f"{ends[0]:g} s to {ends[1]:g} s"
    first, last = (str(pd.Timestamp(end, unit="s").floor("s")) for end in ends)
    return f"{first} to {last} UTC"
