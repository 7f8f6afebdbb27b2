"""Columns that are not taken for a quantity by their names alone, and columns that tell sensors apart."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import pandas as pd

from echocal.keywords import keyword
from echocal.observations.fields import shown, span
from echocal.observations.hints import hint, role_of

if TYPE_CHECKING:
    from collections.abc import Mapping

    import pandas as pd

_GAPS = 0.1  # of the rows with a reading: they would be lost for a quantity that is not needed
_MOST = 0.5  # of them, for the temperature, which nearly every law needs
_STEPS = (1e-3, 7 * 86400.0)  # s: between two rows of a log
_CODES = 10  # different values: a quality number has more, a flag of a quality control has fewer
_NAMES = (
    "sensor", "sensor_id", "device", "device_id", "dev_eui", "deveui", "node", "unit", "id", "mac", "host",
    "station_id", "serial", "sn",
)  # fmt: skip
_FEW = 5  # rows of a sensor on average, at least


def doubtful_in(table: pd.DataFrame, requests: Mapping[str, str] | None = None) -> dict[str, str]:
    """Why a column is not used unless somebody asks for it, by column.

    Only gaps in rows with a reading count: a row without a reading is lost anyway. The requests are what the
    user and the log say about columns.

    Examples
    --------
    >>> import pandas as pd
    >>> doubtful_in(pd.DataFrame({"humidity_percent": [40.0, None], "quality": [0, 1]}))
    {'humidity_percent': 'has no value in 1 of 2 rows', 'quality': 'has few different values, as a code has,'}
    >>> doubtful_in(pd.DataFrame({"echo_us": [1.0, None, 3.0], "Humidity (%)": [40.0, None, 41.0]}))
    {}
    """
    said = {str(name): (requests or {}).get(str(name), str(name)) for name in table.columns}
    roles = {name: role_of(own) for name, own in said.items()}
    ranger = [
        name
        for name, role in roles.items()
        if role in {"reading", "echo"} and not said[name].startswith("distance_")
    ]
    try:
        measured = table[ranger].notna().any(axis="columns") if ranger else None
    except ArithmeticError:  # a signaling NaN, which the reader names
        measured = None
    rows = table if measured is None or not measured.any() else table[measured]
    empty = rows.select_dtypes("number").isna().sum()
    of = "rows" if len(rows) == len(table) else "rows with a reading"
    found = {
        str(name): f"has no value in {count} of {len(rows)} {of}"
        for name, count in empty.items()
        if count > (_MOST if roles[str(name)] == "temperature" else _GAPS) * len(rows)
    }
    for name in table.columns:
        if roles[str(name)] == "echo_quality" and table[name].nunique() < _CODES:
            found.setdefault(str(name), "has few different values, as a code has,")
    for column in map(str, table.select_dtypes("number")):
        clock = None if column in (requests or {}) else hint(column)
        if clock is not None and clock.name == "time":
            found[column] = _without_unit(column, table[column])
    return found


def _without_unit(name: str, values: pd.Series[float]) -> str:
    """What to say of a count of time whose unit nothing tells."""
    steps = np.abs(np.diff(values.dropna().to_numpy(dtype=np.float64)))
    steps = steps[steps > 0.0]
    step = float(np.median(steps)) if len(steps) else 0.0
    units = {"time_s": 1.0, "time_ms": 1e-3, "time_us": 1e-6}
    ways = {unit: step * by for unit, by in units.items() if _STEPS[0] <= step * by <= _STEPS[1]} or {
        "time_s": step
    }
    told = ", ".join(f"{keyword('columns', {name: unit})} ({span(own)})" for unit, own in ways.items())
    use = "to use it, say the step between rows:"
    return f"counts time in an unknown unit and is not used; {use} {told}"


def sensors_in(table: pd.DataFrame) -> dict[str, int]:
    """Columns called as ids of sensors are, with the number of their different values, if these are few."""
    found = {}
    for name in table.columns:
        if str(name).strip().lower().replace(" ", "_") not in _NAMES:
            continue
        try:
            count = int(table[name].nunique())
        except TypeError:  # lists, which have no hash
            continue
        if 1 < count <= max(len(table) // _FEW, 1):
            found[str(name)] = count
    return found


def note_of(table: pd.DataFrame, used: set[str]) -> str:
    """Say that a table that is taken for one sensor holds several, by a column that the user does not use."""
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
