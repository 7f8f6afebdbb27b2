"""JSON: one record a line, a list of records, columns, or records within a message (TTN, ThingSpeak)."""

from collections import Counter
from collections.abc import Mapping, Sequence
from typing import Any

from echocal.errors import DataError
from echocal.observations.limits import from_json
from echocal.observations.readers.events import of_several_messages
from echocal.observations.readers.log import Log

NAME = "JSON"

_CHANNEL = "channel"


def recognizes(lines: Sequence[str]) -> bool:
    """Whether the text begins as JSON does."""
    first = lines[0].lstrip("﻿ \t")
    return first.startswith(("{", "[{", "[")) and (first.strip() in "[{" or '"' in first or first[:2] == "[[")


def read(lines: Sequence[str], path: str) -> Log:
    """Read the records; names of nested values are joined by points."""
    text = "\n".join(lines).lstrip("﻿")
    try:
        whole = from_json(text)
    except ValueError:
        return _lines(lines, path)
    log, records = Log(), _records(whole)
    if not records:
        raise DataError(
            f'{path} is JSON without records; a record is {{"distance_cm": 12.3, ...}}, one a line'
        )
    return of_several_messages(_short([flat(record) for record in records]), log)


def _lines(lines: Sequence[str], path: str) -> Log:
    log, why = Log(), ""
    for line in filter(str.strip, lines):
        try:
            record = from_json(line.strip().rstrip(","))
        except ValueError as error:
            record, why = None, why or str(error)
        if isinstance(record, Mapping):
            log.records.append(flat(record))
        else:
            log.lose(line)
    if 2 * len(log.corrupt) >= len(log.records):
        raise DataError(
            f"{path} is JSON that cannot be read{why and f' ({why})'}; write one record a line, or save the "
            "table as CSV"
        )
    return of_several_messages(_short(log.records), log)


def _records(whole: Any) -> list[Mapping[str, Any]]:
    if isinstance(whole, list):
        if whole and all(isinstance(item, list) for item in whole):
            if all(isinstance(item, Mapping) for part in whole for item in part):  # Home Assistant's history
                return [item for part in whole for item in part]
            names = whole[0] if all(isinstance(name, str) for name in whole[0]) else None
            names = names or [f"column {n + 1}" for n in range(len(whole[0]))]
            rows = whole[1:] if names == whole[0] else whole
            return [dict(zip(names, row, strict=False)) for row in rows]
        return [item for item in whole if isinstance(item, Mapping)]
    if not isinstance(whole, Mapping):
        return []
    lists = {name: own for name, own in whole.items() if isinstance(own, list) and own}
    records = {name: own for name, own in lists.items() if all(isinstance(item, Mapping) for item in own)}
    if records:
        name = max(records, key=lambda own: len(records[own]))
        fields = whole.get(_CHANNEL, {})
        return [{_named(key, fields): value for key, value in record.items()} for record in records[name]]
    if lists and len({len(own) for own in lists.values()}) == 1:
        return [dict(zip(lists, row, strict=True)) for row in zip(*lists.values(), strict=True)]
    columns = {name: own for name, own in whole.items() if isinstance(own, Mapping)}
    if (
        columns
        and len(columns) == len(whole)
        and not any(isinstance(v, Mapping) for c in columns.values() for v in c.values())
    ):
        keys = dict.fromkeys(key for own in columns.values() for key in own)
        return [{name: own.get(key) for name, own in columns.items()} for key in keys]
    return [whole]


def _named(key: str, channel: Any) -> str:
    """The name that a channel gives its field (ThingSpeak)."""
    name = channel.get(key) if isinstance(channel, Mapping) and key.startswith("field") else None
    return str(name) if name else key


def flat(record: Mapping[str, Any], before: str = "") -> dict[str, Any]:
    """Values of a record and of the records in it; names are joined by points."""
    found: dict[str, Any] = {}
    for name, value in record.items():
        if isinstance(value, Mapping):
            found |= flat(value, f"{before}{name}.")
        elif not isinstance(value, list):
            found[f"{before}{name}"] = value
    return found


def _short(records: list[dict[str, Any]]) -> list[dict[str, Any]]:
    """The last part of each name, where no other name has it."""
    names = dict.fromkeys(name for record in records for name in record)
    last = [name.rpartition(".")[2] for name in names]
    times = Counter(last)
    short = {name: own if times[own] == 1 else name for name, own in zip(names, last, strict=True)}
    return [{short[name]: value for name, value in record.items()} for record in records]
