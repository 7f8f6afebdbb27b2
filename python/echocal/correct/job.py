"""What a task says beyond its files: models, options. Plain data in, objects out."""

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import lru_cache
from pathlib import Path
from typing import Any

from echocal.correct.rows import Reading
from echocal.correct.uncertainty import Uncertainties
from echocal.engines.checks import models_digest
from echocal.errors import ModelError
from echocal.model import Model
from echocal.model.folder import ModelFolder
from echocal.model.plain import from_plain
from echocal.observations.text import Layout

__all__ = ["Job", "Models", "plain_job"]


@dataclass(frozen=True)
class Models:
    """One model for all rows, or one for each key.

    Attributes
    ----------
    one : Model or None
    folder : ModelFolder or None
    by : str
        Column, or level of the folders (``sensor_id=17``), that has the key.
    """

    one: Model | None = None
    folder: ModelFolder | None = None
    by: str = ""

    def model(self, key: str) -> Model | None:
        """The model of a key; None where there is none."""
        return self.one if self.folder is None else self.folder.model(key)


@dataclass(frozen=True)
class Job:
    """How files are corrected.

    Attributes
    ----------
    models : Models
    requests : mapping of str to str
        Meaning of columns.
    reading : Reading
    layout : Layout
        How text files are written.
    append_only : tuple of str or None
        Columns to keep beside the results; None: all.
    round_m : float or None
        Distances are rounded to multiples of this [m].
    memory : int
        Bytes of memory that the process may use.
    threads : int
    metadata : mapping of str to str
        What an output says of its origin.
    several : bool
        Whether the file is one of several: a column without any value is then no mistake.
    logs : str or None
        Which files are one log, if the user says it.
    spreadsheet_safe : bool
        Whether texts that a spreadsheet takes for formulas are written as texts.
    """

    models: Models
    requests: Mapping[str, str] = field(default_factory=dict)
    reading: Reading = field(default_factory=Reading)
    layout: Layout = field(default_factory=Layout)
    append_only: tuple[str, ...] | None = None
    round_m: float | None = None
    memory: int = 512 << 20
    threads: int = 2
    metadata: Mapping[str, str] = field(default_factory=dict)
    several: bool = False
    logs: str | None = None
    spreadsheet_safe: bool = False

    @classmethod
    def of(cls, task: Mapping[str, Any]) -> "Job":
        """The job of a task.

        Raises
        ------
        ModelError
            If this process has other models than the one that made the task.
        """
        return _job(json.dumps(task["job"], sort_keys=True), task["digest"])


@lru_cache(maxsize=4)
def _job(text: str, digest: str) -> Job:
    plain = json.loads(text)
    models = plain["models"]
    if models_digest(models) != digest:
        message = (
            f"the models {models.get('folder', 'of the task')} are not those that the run was begun with; "
            "every process needs the same files, and they may not change while it runs"
        )
        raise ModelError(message)
    reading = plain["reading"]
    return Job(
        Models(from_plain(models["model"]))
        if "model" in models
        else Models(None, ModelFolder(Path(models["folder"])), models["by"]),
        plain["columns"],
        Reading(
            reading["missing"],
            tuple(reading["trust"]),
            reading["time_zone"],
            reading["reading_speed"],
            reading["mark_rows"],
            Uncertainties(reading["uncertainties"]),
            reading.get("at", {}),
            reading.get("time_format"),
        ),
        Layout(**plain["layout"]),
        None if plain["append_only"] is None else tuple(plain["append_only"]),
        plain["round_m"],
        plain["memory"],
        plain["threads"],
        plain["metadata"],
        plain["several"],
        plain["logs"],
        plain.get("spreadsheet_safe", False),
    )


def plain_job(
    models: Mapping[str, Any],
    columns: Mapping[str, str],
    reading: Mapping[str, Any],
    layout: Layout,
    metadata: Mapping[str, str],
    *,
    append_only: Sequence[str] | None = None,
    round_m: float | None = None,
    memory: int = 512 << 20,
    threads: int = 2,
    several: bool = False,
    logs: str | None = None,
    spreadsheet_safe: bool = False,
) -> dict[str, Any]:
    """A job as plain data; options that most jobs do not have are left out."""
    return {
        **({"spreadsheet_safe": True} if spreadsheet_safe else {}),
        "models": dict(models),
        "columns": dict(columns),
        "reading": dict(reading),
        "layout": {
            "skip_lines": layout.skip_lines,
            "decimal": layout.decimal,
            "encoding": layout.encoding,
        },
        "append_only": None if append_only is None else list(append_only),
        "round_m": round_m,
        "memory": memory,
        "threads": threads,
        "metadata": dict(metadata),
        "several": several,
        "logs": logs,
    }
