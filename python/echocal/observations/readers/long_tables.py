"""Tables with a row for each value: the name of the quantity is in one column, its value in another."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pandas as pd

from echocal.arrays import Column, Labels, Mask
from echocal.observations.fields import floats
from echocal.observations.found import Found, Join, told
from echocal.observations.in_time import Clock, clock_of, joined
from echocal.observations.readers.events import changes_smoothly, ranger_names

_NAMES = (
    "_field", "entity_id", "metric", "field", "sensor_type", "variable", "parameter", "measurement",
    "series", "topic", "quantity",
)  # fmt: skip
_ALSO_SENSORS = ("type", "sensor", "name", "channel", "key", "kind", "sensor_name")
"""Names of columns that may as well say which sensor a row is of: then all of them are rangers."""
_VALUES = ("_value", "state", "value", "payload", "wert")
_TIMES = (
    *("_time", "last_changed", "last_updated", "time", "timestamp", "datetime", "created_at", "ts"),
    *("time_s", "time_ms", "time_us", "time_min", "time_h", "epoch", "zeit", "datum"),
)
_UNITS = ("unit", "unit_of_measurement", "units", "einheit")
_MOST = 50


def step(table: pd.DataFrame, found: Found) -> tuple[pd.DataFrame, Found]:
    """One column for each quantity: a row for each value of the ranger, with the others at its time."""
    lower = {str(name).lower(): str(name) for name in table.columns}
    name, value, time = (
        next((lower[own] for own in known if own in lower), None)
        for known in (_NAMES + _ALSO_SENSORS, _VALUES, _TIMES)
    )
    if name is None or value is None or time is None or pd.api.types.is_numeric_dtype(table[name]):
        return table, found
    kinds = [str(own) for own in table[name].dropna().unique()]
    units = _units(table, name, lower)
    lead = next(iter(ranger_names(kinds, units)), kinds[0] if len(kinds) == 1 else None)
    if not 1 <= len(kinds) <= _MOST or lead is None:
        return table, found
    if name.lower() in _ALSO_SENSORS and not any(changes_smoothly(n, units.get(n, "")) for n in kinds):
        return table, found
    of_kind = table[name].astype(object)
    values = floats(table[value])
    own = (of_kind == lead).to_numpy()
    tags = [str(c) for c in table.columns if c != name and _is_tag(str(c), lower)]
    wide = table.loc[own, [c for c in table.columns if c == time or c in tags]].reset_index(drop=True)
    wide.insert(0 if time not in wide.columns else 1, lead, values[own])
    clock, sensors = clock_of(table[time]), _sensors(table[tags])
    joins: dict[str, Join] = {}
    for kind in kinds:
        where = (of_kind == kind).to_numpy() & np.isfinite(clock.times)
        if kind != lead and np.isfinite(values[where]).any():
            smooth = changes_smoothly(kind, units.get(kind, ""))
            wide[kind], joins[kind] = _of_each(clock, values, sensors, own, where, smooth=smooth)
    note = (
        f"the log has a row for each value: {len(table)} rows of {len(kinds)} quantities become {len(wide)} "
        f"rows, one for each '{lead}'"
    )
    return wide, replace(
        found, units={**found.units, **units}, notes=(*found.notes, note, *told(joins)), corrupt={},
        streams=False, joined={**found.joined, **joins},
    )  # fmt: skip


def _of_each(
    clock: Clock,
    values: Column,
    sensors: Labels,
    own: Mask,
    where: Mask,
    *,
    smooth: bool,
) -> tuple[Column, Join]:
    """Values at the times of the ranger: of the same sensor where each has the quantity, else of any."""
    apart = set(sensors[own].tolist())
    if apart != set(sensors[where].tolist()):
        sensors = np.zeros_like(sensors)
        apart = {0}
    taken = np.full(int(own.sum()), np.nan)
    joins = []
    for sensor in sorted(apart):
        mine = sensors == sensor
        place = mine[own]
        taken[place], join = joined(clock, own & mine, where & mine, values[where & mine], smooth=smooth)
        joins.append(join)
    longest = max(joins, key=lambda join: join.interval_s)
    return taken, replace(longest, without=sum(join.without for join in joins))


def _sensors(tags: pd.DataFrame) -> Labels:
    """Number of the sensor that each row is of, by its tags."""
    if tags.empty:
        return np.zeros(len(tags), dtype=np.int64)
    codes: Any = tags.astype(str).agg("\0".join, axis=1).factorize()[0]
    return np.asarray(codes, dtype=np.int64)


def _units(table: pd.DataFrame, name: str, lower: dict[str, str]) -> dict[str, str]:
    column = next((lower[own] for own in _UNITS if own in lower), None)
    if column is None:
        return {}
    pairs = table[[name, column]].dropna().drop_duplicates(name)
    return {str(kind): str(unit) for kind, unit in pairs.itertuples(index=False)}


def _is_tag(name: str, lower: dict[str, str]) -> bool:
    """Whether a column says which sensor a row is of."""
    known = {lower.get(own) for own in (*_NAMES, *_VALUES, *_TIMES, *_UNITS)}
    return (
        name not in known
        and not name.startswith("_")
        and name.lower() not in {"result", "table", "unnamed 1"}
    )
