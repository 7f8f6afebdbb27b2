"""Columns that tell several sensors apart."""

from typing import Any

import pandas as pd

from echocal.keywords import keyword
from echocal.observations.fields import shown

__all__ = ["note_of", "sensors_in"]

_NAMES = (
    "sensor",
    "sensor_id",
    "device",
    "device_id",
    "dev_eui",
    "deveui",
    "node",
    "unit",
    "id",
    "mac",
    "host",
    "station_id",
    "serial",
    "sn",
)
_FEW = 5  # rows of a sensor on average, at least


def sensors_in(table: pd.DataFrame) -> dict[str, int]:
    """Columns called as ids of sensors are, with the number of their different values, if these are few."""
    found = {}
    for name in table.columns:
        if str(name).strip().lower().replace(" ", "_") not in _NAMES:
            continue
        count = _distinct(table[name])
        if 1 < count <= max(len(table) // _FEW, 1):
            found[str(name)] = count
    return found


def note_of(table: pd.DataFrame, used: set[str]) -> str:
    """Say that a table that is taken for one sensor holds several; empty if it does not.

    Parameters
    ----------
    used : set of str
        Columns that the user gives a meaning.
    """
    for name, count in sensors_in(table).items():
        if name not in used:
            values = ", ".join(shown(str(value)) for value in table[name].dropna().unique()[:3])
            more = ", ..." if count > 3 else ""
            return (
                f"column '{name}' has {count} values ({values}{more}), which may be as many sensors; they "
                f"are taken for one. Each alone: {keyword('by', name)}; if they are one: "
                f"{keyword('columns', {name: 'extra'})}"
            )
    return ""


def _distinct(values: "pd.Series[Any]") -> int:
    try:
        return int(values.nunique())
    except TypeError:  # lists, which have no hash
        return 0
