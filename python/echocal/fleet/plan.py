"""Tasks: sensors that are diagnosed together, so many that their rows fit into the memory."""

import hashlib
import json
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from echocal._core import __version__
from echocal.fleet.index import Sensor

__all__ = ["BYTES_A_ROW", "SCHEMA", "digest", "tasks_of"]

SCHEMA = "echocal.fleet_task/1"

_SENSORS = 16
"""Sensors of a task at most: what a killed worker loses is seconds."""

BYTES_A_ROW = 400
"""What a row takes while a group of sensors is read and one of them is diagnosed; judgement."""


def tasks_of(
    sensors: Sequence[Sensor], names: Mapping[str, str], by: str | None, job: Mapping[str, Any], memory: int
) -> list[dict[str, Any]]:
    """Tasks as plain data. The same sensors and the same job make the same tasks.

    Parameters
    ----------
    names : mapping of str to str
        File of each sensor.
    by : str or None
        Column or level of the folders that has the key.
    job : mapping
        What all tasks share, as plain data.
    memory : int
        Bytes that one process may use for rows.
    """
    places: dict[Path, int] = {}
    for sensor in sensors:
        for file, _ in sensor.files:
            places.setdefault(file.file, len(places))
    most = max(memory // BYTES_A_ROW, 1)
    groups: list[list[Sensor]] = [[]]
    rows = 0
    for sensor in sensors:
        if groups[-1] and (len(groups[-1]) == _SENSORS or rows + sensor.rows > most):
            groups.append([])
            rows = 0
        groups[-1].append(sensor)
        rows += sensor.rows
    return [
        {
            "schema": SCHEMA,
            "version": __version__,
            "number": number,
            "sensors": [
                {
                    "key": s.key,
                    "kind": s.kind,
                    "file": names[s.key],
                    "files": [
                        [str(file.file), by in file.partition, places[file.file]] for file, _ in s.files
                    ],
                }
                for s in group
            ],
            "job": dict(job),
        }
        for number, group in enumerate(groups)
    ]


def digest(data: Any) -> str:
    """SHA-256 of plain data."""
    return hashlib.sha256(json.dumps(data, sort_keys=True).encode()).hexdigest()
