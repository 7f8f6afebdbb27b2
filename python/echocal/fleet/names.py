"""Names of the files of sensors, and the index of a folder of models."""

import hashlib
import json
from collections.abc import Mapping, Sequence

from echocal.fleet.index import Sensor
from echocal.model.folder import INDEX, file_name

__all__ = ["index_text", "named"]

_SCHEMA = "echocal.models/1"
_LONGEST = 100  # characters of a key that its file shows


def named(sensors: Sequence[Sensor]) -> dict[str, str]:
    """File of each sensor: its key with signs that a file name may have; one that is taken gets a number.

    Examples
    --------
    >>> from echocal.fleet.index import Sensor
    >>> named([Sensor("tank 7"), Sensor("tank_7")])
    {'tank 7': 'tank_7.json', 'tank_7': 'tank_7-3de28510.json'}
    """
    files: dict[str, str] = {}
    taken = {INDEX}
    for sensor in sensors:
        stem = file_name(sensor.key[:_LONGEST]).removesuffix(".json")
        name = f"{stem}.json"
        if name.lower() in taken:
            name = f"{stem}-{hashlib.sha256(sensor.key.encode()).hexdigest()[:8]}.json"
        taken.add(name.lower())
        files[sensor.key] = name
    return files


def index_text(models: Mapping[str, str]) -> str:
    """The index of a folder of models: which file has the model of which key."""
    return json.dumps({"schema": _SCHEMA, "models": dict(models)}, indent=1, ensure_ascii=False) + "\n"
