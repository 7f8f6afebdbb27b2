"""The pooled diagnosis that a user gets: its data and its methods."""

import json
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from echocal.diagnose.pooling.explain import explain
from echocal.diagnose.pooling.outcome import PooledOutcome
from echocal.diagnose.results.diagnosis import Diagnosis, plain
from echocal.model import Model
from echocal.outputs import replace_text

__all__ = ["PooledDiagnosis"]

SCHEMA = "echocal.pooled_diagnosis/1"


@dataclass(frozen=True)
class PooledDiagnosis(PooledOutcome):
    """What the base simulation gets wrong about several tables together.

    Its attributes are those of `echocal.diagnose.pooling.outcome.PooledOutcome`: ``verdict``, ``causes``,
    ``posterior``, ``credible_set``, ``gain``, ``tables``, ``skipped``, ``base``, ``notes``, ``settings``,
    ``model`` and ``seconds``.

    Examples
    --------
    >>> import numpy as np
    >>> import echocal
    >>> steps = np.arange(60.0)
    >>> unit = {"reading_m": 1.008 + 1e-3 * np.sin(steps**2), "temperature_C": 20 + 5 * np.sin(steps)}
    >>> other = {**unit, "reading_m": 1.007 + 1e-3 * np.cos(steps**2)}
    >>> found = echocal.diagnose_many({"first": unit, "second": other}, reference_distance=1.0)
    >>> list(found.tables), found.to_dict()["schema"]
    (['first', 'second'], 'echocal.pooled_diagnosis/1')
    """

    @property
    def diagnoses(self) -> dict[str, Diagnosis]:
        """Diagnosis of each table by itself."""
        return {name: table.diagnosis for name, table in self.tables.items()}

    @property
    def models(self) -> dict[str, Model]:
        """Model of each table: shared causes with the table's own sizes, and causes of its own."""
        return {name: table.model for name, table in self.tables.items()}

    def to_dict(self) -> dict[str, Any]:
        """As ``echocal.pooled_diagnosis/1``: plain data for JSON; what is not finite is None."""
        return {
            "schema": SCHEMA,
            "verdict": self.verdict,
            "causes": [plain(cause) for cause in self.causes],
            "posterior": [{"ids": list(ids), "probability": p} for ids, p in self.posterior],
            "credible_set": [list(ids) for ids in self.credible_set],
            "gain": plain(self.gain),
            "tables": [
                {
                    "name": name,
                    "own_causes": list(table.own_causes),
                    "transfer": plain(table.transfer),
                    "diagnosis": table.diagnosis.to_dict(),
                }
                for name, table in self.tables.items()
            ],
            "skipped": [plain(table) for table in self.skipped],
            "base": plain(self.base),
            "notes": list(self.notes),
            "settings": self.settings.to_dict(),
            "seconds": self.seconds,
        }

    def to_json(self, path: str | Path) -> None:
        """Write `to_dict` to a file."""
        replace_text(path, json.dumps(self.to_dict(), indent=2, allow_nan=False) + "\n")

    def explain(self) -> str:
        """The diagnosis in sentences that a user can check in the tables."""
        return explain(self)
