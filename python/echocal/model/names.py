"""Names of the files of a folder of models, and its index."""

import json
from collections.abc import Iterable, Mapping

from echocal.model.folder import INDEX, file_name

__all__ = ["index_text", "named"]

_SCHEMA = "echocal.models/1"


def named(keys: Iterable[str], taken: Iterable[str] = ()) -> dict[str, str]:
    """File of each key: the key with signs that a file name may have; one that is taken gets a number.

    Parameters
    ----------
    keys : iterable of str
    taken : iterable of str
        Names of other files, besides the index.

    Examples
    --------
    >>> named(["tank 7", "tank_7"])
    {'tank 7': 'tank_7.json', 'tank_7': 'tank_7-3de28510.json'}
    """
    files: dict[str, str] = {}
    used = {INDEX, *taken}
    for key in keys:
        name = file_name(key)
        if name.lower() in used:
            name = file_name(key, taken=True)
        used.add(name.lower())
        files[key] = name
    return files


def index_text(models: Mapping[str, str]) -> str:
    """The index of a folder of models: which file has the model of which key."""
    return json.dumps({"schema": _SCHEMA, "models": dict(models)}, indent=1, ensure_ascii=False) + "\n"
