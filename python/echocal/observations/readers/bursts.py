"""Wide bursts: one row of n readings (``obs 1`` ... ``obs 10``) becomes n rows."""

import re
from collections.abc import Mapping
from dataclasses import replace

import pandas as pd

from echocal.errors import DataError
from echocal.observations.found import Found
from echocal.observations.hints import hint
from echocal.observations.names import by_name
from echocal.observations.units import symbol_of

_NUMBERED = re.compile(
    r"(?P<stem>.*?[^\d\s])[\s_.#-]*(?P<place>\d{1,3})(?P<unit>\s*[\[(].*[\])]|[ _](?:cm|mm|m|us|ms|in|inch))?"
)
_STEMS = {
    "obs", "reading", "echo", "distance", "dist", "ping", "sample", "measurement", "shot", "trial", "range",
    "burst", "messung", "abstand", "read", "meas", "m", "d", "r", "echotime", "tof", "pulse", "value", "rep",
    "repeat", "wert", "observation",
}  # fmt: skip
_LEAST = 3


def step(table: pd.DataFrame, found: Found) -> tuple[pd.DataFrame, Found]:
    """One row for each reading of a burst, in the order of the columns."""
    if _has_echo(table, found.units):
        return table, found
    groups: dict[tuple[str, str], list[tuple[int, str]]] = {}
    for name in map(str, table.columns):
        match = _NUMBERED.fullmatch(name.strip())
        if match and match["stem"].strip(" _.#-").lower() in _STEMS and _ours(name) is None:
            key = (match["stem"].strip(" _.#-"), (match["unit"] or "").strip(" _"))
            groups.setdefault(key, []).append((int(match["place"]), name))
    whole = {key: sorted(own) for key, own in groups.items() if len(own) >= _LEAST}
    if len(whole) != 1:
        return table, found
    (stem, unit), columns = next(iter(whole.items()))
    if not all(pd.api.types.is_numeric_dtype(table[name]) for _, name in columns):
        return table, found
    name = stem if not unit else f"{stem} {unit}" if unit[0] in "[(" else f"{stem}_{unit}"
    said = next((found.units[c] for _, c in columns if c in found.units), "") or symbol_of(
        unit.strip("()[] ")
    )
    count = len(columns)
    rest = table.drop(columns=[c for _, c in columns])
    long = rest.loc[rest.index.repeat(count)].reset_index(drop=True)
    long[name] = table[[c for _, c in columns]].to_numpy().reshape(-1)
    names = {
        "group": [n for n in range(len(table)) for _ in range(count)],
        "order": [p for p, _ in columns] * len(table),
    }
    for label, values in names.items():
        if label not in long.columns:
            long[label] = values
    units = {**found.units, **({name: said} if said else {})}
    corrupt = {row * count + n: why for row, why in found.corrupt.items() for n in range(count)}
    note = (
        f"{count} columns '{columns[0][1]}' to '{columns[-1][1]}' are bursts: {len(table)} rows become "
        f"{len(long)} readings '{name}', row 1 of the file is rows 1 to {count} here"
    )
    return long, replace(found, units=units, notes=(*found.notes, note), corrupt=corrupt, streams=False)


def _ours(name: str) -> object:
    try:
        return by_name(name)
    except DataError:
        return name if name.lower() in {"distance", "reading", "echo"} else None


def _has_echo(table: pd.DataFrame, units: Mapping[str, str]) -> bool:
    for name in map(str, table.columns):
        if _NUMBERED.fullmatch(name.strip()):
            continue
        ours = _ours(name)
        if isinstance(ours, tuple) and ours[0].quantity in {"echo_time", "reading"}:
            return True
        said = hint(name, units.get(name, ""))
        if said is not None and said.name.startswith(("reading", "echo")) and said.sure:
            return True
    return False
