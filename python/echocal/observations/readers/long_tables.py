"""Tables with a row for each value: the name of the quantity is in one column, its value in another."""

from __future__ import annotations

from dataclasses import replace

import pandas as pd

from echocal.observations.found import Found
from echocal.observations.hints import hint

__all__ = ["step"]

_NAMES = (
    "_field",
    "entity_id",
    "metric",
    "field",
    "sensor_type",
    "variable",
    "parameter",
    "measurement",
    "series",
    "topic",
    "quantity",
)
_VALUES = ("_value", "state", "value", "payload", "wert")
_TIMES = ("_time", "last_changed", "last_updated", "time", "timestamp", "datetime", "created_at", "ts")
_UNITS = ("unit", "unit_of_measurement", "units", "einheit")
_MOST = 50
_LEADS = (
    "distance",
    "dist",
    "abstand",
    "entfernung",
    "echo",
    "reading",
    "range",
    "ultrasonic",
    "sonar",
    "tank",
    "level",
)


def step(table: pd.DataFrame, found: Found) -> tuple[pd.DataFrame, Found]:
    """One column for each quantity: a row for each value of the ranger, with the last ones of the others."""
    lower = {str(name).lower(): str(name) for name in table.columns}
    name, value, time = (
        next((lower[own] for own in known if own in lower), None) for known in (_NAMES, _VALUES, _TIMES)
    )
    if name is None or value is None or time is None or pd.api.types.is_numeric_dtype(table[name]):
        return table, found
    kinds = [str(own) for own in table[name].dropna().unique()]
    if not 1 <= len(kinds) <= _MOST:
        return table, found
    units = _units(table, name, lower)
    lead = _lead(kinds, units)
    values = pd.to_numeric(table[value], errors="coerce")
    if lead is None:
        return table, found
    own = table[name].astype(object) == lead
    wide = table.loc[own, [c for c in table.columns if c == time or _is_tag(str(c), lower)]].reset_index(
        drop=True
    )
    wide.insert(0 if time not in wide.columns else 1, lead, values[own].reset_index(drop=True))
    seconds = pd.to_datetime(table[time].astype(str), format="mixed", utc=True, errors="coerce")
    base = (
        pd.DataFrame({"t": seconds[own].to_numpy(), "row": range(len(wide))})
        .dropna()
        .sort_values("t", kind="stable")
    )
    for kind in kinds:
        if kind == lead:
            continue
        other = table[name].astype(object) == kind
        right = pd.DataFrame({"t": seconds[other].to_numpy(), kind: values[other].to_numpy()}).dropna()
        right = right.sort_values("t", kind="stable")
        if right.empty or base.empty:
            continue
        joined = pd.merge_asof(base, right, on="t").set_index("row")[kind]
        wide[kind] = joined.reindex(range(len(wide)))
    note = (
        f"the log has a row for each value: {len(table)} rows of {len(kinds)} quantities become {len(wide)} rows, "
        f"one for each '{lead}', with the last value of {', '.join(repr(k) for k in kinds if k != lead) or 'no other'}"
    )
    return wide, replace(
        found, units={**found.units, **units}, notes=(*found.notes, note), corrupt={}, streams=False
    )


def _units(table: pd.DataFrame, name: str, lower: dict[str, str]) -> dict[str, str]:
    column = next((lower[own] for own in _UNITS if own in lower), None)
    if column is None:
        return {}
    pairs = table[[name, column]].dropna().drop_duplicates(name)
    return {str(kind): str(unit) for kind, unit in pairs.itertuples(index=False)}


def _lead(kinds: list[str], units: dict[str, str]) -> str | None:
    said = [
        kind
        for kind in kinds
        if (h := hint(kind, units.get(kind, ""))) and h.name.startswith(("reading", "echo"))
    ]
    alike = [kind for word in _LEADS for kind in kinds if word in kind.lower()]
    return next(iter([*said, *alike]), kinds[0] if len(kinds) == 1 else None)


def _is_tag(name: str, lower: dict[str, str]) -> bool:
    """Whether a column says which sensor a row is of."""
    known = {lower.get(own) for own in (*_NAMES, *_VALUES, *_TIMES, *_UNITS)}
    return (
        name not in known
        and not name.startswith("_")
        and name.lower() not in {"result", "table", "unnamed 1"}
    )
