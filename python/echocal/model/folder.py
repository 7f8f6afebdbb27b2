"""Folders of models, one for each key: how files are named, and how they are read.

The model of a key is in the file of its name, with signs that a file name may not have replaced by ``_``, and
with a hash in place of the end where it is too long (`echocal.diagnose_fleet` writes them so).
An ``index.json`` in the folder names them instead: ``{"schema": "echocal.models/1", "models": {"KEY":
"FILE.json", ...}}``.
"""

import hashlib
import json
import os
import re
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

from echocal.errors import DataError, ModelError
from echocal.keywords import keyword
from echocal.model.composition import Model

INDEX = "index.json"
_SCHEMA = "echocal.models/1"
_UNSAFE = re.compile(r"[^\w.-]+")
_LONGEST = 250  # bytes before ".json": file systems have names of 255 bytes at most

WHOLE = r"^(-?(?:0|[1-9][0-9]*))\.0+$"
"""Text of a whole number with a fraction, as tables with gaps write ids."""


def file_name(key: str, *, taken: bool = False) -> str:
    """Name of the file that the model of a key is in; with a hash of the key where it is long.

    Where another key has taken that name, this one has the hash, too.

    Examples
    --------
    >>> file_name("tank 7/a"), file_name("tank 7/a", taken=True)
    ('tank_7_a.json', 'tank_7_a-d9e82171.json')
    """
    stem = (_UNSAFE.sub("_", key).strip(".") or "_").encode()
    if taken or len(stem) > _LONGEST:
        told = f"-{hashlib.sha256(key.encode('utf-8', 'surrogatepass')).hexdigest()[:8]}".encode()
        whole = stem[: _LONGEST - len(told)].decode(errors="ignore")  # no letter is cut in two
        stem = whole.encode() + told
    return f"{stem.decode()}.json"


def label(value: Any) -> str:
    """A key as text; empty where there is none. Whole numbers have no fraction.

    Examples
    --------
    >>> label(7.0), label("7.0"), label("007"), label(" a "), label(None)
    ('7', '7', '007', 'a', '')
    """
    try:
        absent = value is None or bool(value != value)  # not a number, not a time
    except TypeError:  # missing, as pandas has it
        absent = True
    if absent:
        return ""
    if isinstance(value, float) and value.is_integer():
        return str(int(value))
    return re.sub(WHOLE, r"\1", str(value).strip())


class ModelFolder:
    """Models by key, read when they are asked for.

    Raises `ModelError` if the folder or its index cannot be read.
    """

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        if not folder.is_dir():
            raise ModelError(f"{keyword('models', str(folder))} is no folder of models")
        self._index = _read_index(folder / INDEX)
        self._models: dict[str, Model | None] = {}
        self._claimed: dict[str, str] = {}

    def model(self, key: str) -> Model | None:
        """The model of a key; None where there is none.

        Raises `ModelError` if its file is no model, and `DataError` if two keys would have the same file.
        """
        if key not in self._models:
            file = self._file(key)
            if file is None and key.isdecimal():  # 007 in a text is 7 in a table of numbers
                file = self._file(str(int(key)))
            self._models[key] = None if file is None else Model.load(self.folder / file)
        return self._models[key]

    def digest(self) -> str:
        """SHA-256 of the names and contents of all files. Raises `ModelError` if one cannot be read."""
        total = hashlib.sha256()
        for file in sorted(self.folder.glob("*.json")):
            try:
                content = hashlib.sha256(file.read_bytes())
            except OSError as error:
                raise ModelError(f"{file} cannot be read: {error.strerror or error}") from None
            total.update(os.fsencode(file.name) + b"\0" + content.digest())
        return total.hexdigest()

    def _file(self, key: str) -> str | None:
        if self._index is not None:
            return self._index.get(key)
        file = file_name(key)
        first = self._claimed.setdefault(file.lower(), key)
        if first != key:
            raise DataError(
                f"the keys '{first}' and '{key}' would have the same model file {file}; name the files in "
                f"{self.folder / INDEX}"
            )
        return file if (self.folder / file).is_file() else None


def _read_index(file: Path) -> Mapping[str, str] | None:
    if not file.is_file():
        return None
    try:
        content = json.loads(file.read_text(encoding="utf-8"))
        models = content["models"]
        if content["schema"] != _SCHEMA or not all(isinstance(name, str) for name in models.values()):
            raise ValueError("another schema")
    except (OSError, ValueError, KeyError, TypeError, AttributeError) as error:
        raise ModelError(
            f'{file} is no index of models ({error}); it is {{"schema": "{_SCHEMA}", "models": {{...}}}}'
        ) from None
    return {str(key): name for key, name in models.items()}


def named(keys: Iterable[str], taken: Iterable[str] = ()) -> dict[str, str]:
    """File of each key: the key with signs that a file name may have; one that is taken gets a number.

    `taken` are names of other files, besides the index.

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
