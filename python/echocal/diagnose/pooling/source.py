"""The tables of a pool: given one by one, or the rows of one table divided by a column."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from echocal.errors import DataError, UsageError, among
from echocal.keywords import keyword
from echocal.model.folder import label as label_of
from echocal.observations import Observations

__all__ = ["Sources", "sources_of"]


@dataclass(frozen=True)
class Sources:
    """Tables by name.

    Attributes
    ----------
    unlabeled : int
        Rows of a divided table that have no label.
    how : mapping of str to object
        Arguments of `echocal.read_observations`.
    by : str
        Column whose labels divide the rows; empty for tables that were given one by one.
    """

    tables: Mapping[str, Any]
    how: Mapping[str, Any]
    unlabeled: int = 0
    by: str = ""


def sources_of(tables: Any, by: str | Sequence[str] | None, how: Mapping[str, Any]) -> Sources:
    """Tables by name: given one by one, or the rows of one table divided by a column."""
    if isinstance(tables, Sources):
        return tables
    return given_one_by_one(tables, how) if by is None else divided(tables, by, how)


def given_one_by_one(tables: Any, how: Mapping[str, Any]) -> Sources:
    """Name tables: a mapping has names, a file its own, another table its place."""
    if isinstance(tables, Mapping):
        named = {str(name): table for name, table in tables.items()}
        if len(named) < len(tables):
            message = "two tables have the same name as text; give each another name"
            raise UsageError(message)
    elif isinstance(tables, Sequence) and not isinstance(tables, str | bytes):
        named = dict(zip(_names(tables), tables, strict=True))
    else:
        message = (
            f"several tables are a mapping of names to tables, or a sequence; got {type(tables).__name__}; "
            "by= divides one table by a column"
        )
        raise UsageError(message)
    bare = next((name for name, table in named.items() if np.ndim(table) == 1 and _is_column(table)), None)
    if bare is not None:
        message = (
            f"'{bare}' is a column, not a table; give several tables by name, or divide one table with "
            "by='COLUMN'"
        )
        raise UsageError(message)
    missing = [str(t) for t in named.values() if isinstance(t, str | Path) and not Path(t).exists()]
    if missing:
        message = f"no file {missing[0]}"
        raise DataError(message)
    return Sources(named, how)


def _is_column(table: Any) -> bool:
    return not isinstance(table, str | Path | Mapping | Observations) and not hasattr(table, "columns")


def _names(tables: Sequence[Any]) -> list[str]:
    """Stems of files, or as much of their paths as makes them differ; places of other tables."""
    names = [
        Path(table).stem if isinstance(table, str | Path) else f"table {place}"
        for place, table in enumerate(tables, start=1)
    ]
    if len(set(names)) < len(names):
        names = [
            str(table) if isinstance(table, str | Path) else name
            for table, name in zip(tables, names, strict=True)
        ]
    repeated = next((name for name in names if names.count(name) > 1), None)
    if repeated is not None:
        message = f"the table {repeated} is given twice; the same rows would count twice"
        raise UsageError(message)
    return names


def divided(table: Any, by: str | Sequence[str], how: Mapping[str, Any]) -> Sources:
    """Divide the rows of one table by the labels of a column, in the order in which they appear.

    Names of several columns divide it into rangers beside each other.

    Raises
    ------
    DataError
        If the column is absent or has no label; the text lists the columns.
    UsageError
        If `by` names no column.
    """
    from echocal.observations.found import found_in, keep
    from echocal.observations.options import ReadOptions
    from echocal.observations.source import load  # slow import: only reading a table needs pandas

    if isinstance(table, Observations):
        message = "by= divides a file or a table; Observations have no such column"
        raise UsageError(message)
    rangers = by.split(",") if isinstance(by, str) else list(by) if isinstance(by, Sequence) else []
    if not rangers or not all(isinstance(name, str) for name in rangers):
        message = f"{keyword('by', by)} is no name of a column, and no names"
        raise UsageError(message)
    listed = not isinstance(by, str) and len(rangers) > 1
    by, rangers = by if isinstance(by, str) else ",".join(rangers), [name.strip() for name in rangers]
    options = ReadOptions(**how)
    whole = load(table, replace(options.layout, text_column=by), sheet=options.sheet)
    if (listed or by not in whole.columns) and len(rangers) > 1 and {*rangers} <= {*whole.columns}:
        return _side_by_side(whole, by, rangers, options)
    absent = next((name for name in (rangers if listed else [by]) if name not in whole.columns), None)
    if absent is not None:
        message = f"there is no column '{absent}' to divide the table by{among(absent, whole.columns)}"
        raise DataError(message)
    labels = [label_of(value) for value in whole[by].tolist()]
    if not any(labels):
        message = f"column '{by}' is empty in every row, so it cannot divide the table"
        raise DataError(message)
    rows: dict[str, list[int]] = {}
    for place, label in enumerate(labels):
        if label:
            rows.setdefault(label, []).append(place)
    found = replace(found_in(whole), corrupt={}, notes=())  # rows of the parts have other places
    parts = {label: keep(whole.iloc[places].reset_index(drop=True), found) for label, places in rows.items()}
    own = replace(options, columns={**options.requests, by: "ignore"}).given()
    return Sources(parts, own, sum(not label for label in labels), by)


def _side_by_side(table: Any, by: str, rangers: Sequence[str], options: Any) -> Sources:
    """A table for each of several rangers that have columns beside each other; the other columns are all's.

    Raises
    ------
    UsageError
        If nothing says what one of the columns holds, or it is no reading and no echo time.
    """
    from echocal.observations.found import found_in, keep
    from echocal.observations.hints import of_ranger
    from echocal.observations.names import by_request

    found = found_in(table)
    requests = {name: own for name, own in options.requests.items() if name not in rangers}
    parts = {}
    for ranger in rangers:
        request = options.requests.get(ranger) or of_ranger(ranger, found.units.get(ranger, ""))
        held = by_request(ranger, request) if request else None
        if held is None or held[0].level or held[0].quantity not in ("reading", "echo_time"):
            meant = keyword("columns", {ranger: "reading_cm"})
            message = f"{keyword('by', by)}: say what '{ranger}' holds, a reading or an echo time: {meant}"
            raise UsageError(message)
        name = f"{held[0].role}_{held[1]}"
        others = [other for other in rangers if other != ranger]
        if name in table.columns and name not in rangers:
            way = keyword("by", f"{by},{name}")
            message = f"the table has a column '{name}' beside '{ranger}'; is it a ranger, too? {way}"
            raise UsageError(message)
        parts[ranger] = keep(table.drop(columns=others).rename(columns={ranger: name}), found)
    own = replace(options, columns=requests).given()
    return Sources(parts, own, 0, by)
