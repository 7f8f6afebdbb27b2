"""What a task says beyond its files: models, options. Plain data in, objects out."""

import json
from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import lru_cache
from pathlib import Path
from typing import Any

from echocal.budget.stated import Uncertainties
from echocal.correct.rows import Reading
from echocal.engines.worker import models_digest
from echocal.errors import ModelError
from echocal.model import Model
from echocal.model.folder import ModelFolder
from echocal.model.plain import from_plain


@dataclass(frozen=True)
class Models:
    """One model for all rows, or one for each key."""

    one: Model | None = None
    folder: ModelFolder | None = None
    by: str = ""  # column, or level of the folders (``sensor_id=17``), that has the key

    def model(self, key: str) -> Model | None:
        """The model of a key; None where there is none."""
        return self.one if self.folder is None else self.folder.model(key)


@dataclass(frozen=True)
class Job:
    """How files are corrected."""

    models: Models
    reading: Reading = field(default_factory=Reading)
    append_only: tuple[str, ...] | None = None  # columns to keep beside the results; None: all
    round_m: float | None = None  # distances are rounded to multiples of this [m]
    memory: int = 512 << 20  # bytes of memory that the process may use
    threads: int = 2
    metadata: Mapping[str, str] = field(default_factory=dict)  # what an output says of its origin
    several: bool = False  # whether the file is one of several: a column without any value is then no mistake
    logs: str | None = None  # which files are one log, if the user says it
    spreadsheet_safe: bool = False  # whether texts that a spreadsheet takes for formulas are written as texts

    @classmethod
    def of(cls, task: Mapping[str, Any]) -> "Job":
        """The job of a task.

        Raises `ModelError` if this process has other models than the one that made the task.
        """
        return _job(json.dumps(task["job"], sort_keys=True), task["digest"])


@lru_cache(maxsize=4)
def _job(text: str, digest: str) -> Job:
    plain = json.loads(text)
    models = plain["models"]
    if models_digest(models) != digest:
        raise ModelError(
            f"the models {models.get('folder', 'of the task')} are not those that the run was begun with; "
            "every process needs the same files, and they may not change while it runs"
        )
    stated = Uncertainties.from_plain(plain["reading"]["uncertainties"])
    reading = Reading(**{**plain["reading"], "uncertainties": stated})
    one = Models(from_plain(models["model"])) if "model" in models else None
    each = one or Models(None, ModelFolder(Path(models["folder"])), models["by"])
    return Job(**{**plain, "models": each, "reading": reading})
