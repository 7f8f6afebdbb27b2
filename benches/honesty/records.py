"""Real records, their windows, and what the engine says about a window.

The records stand beside the repository: the folder `../shared`, or the one that ECHOCAL_SHARED names.
"""

import os
import warnings
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from common import ROOT, Record

import numpy as np  # isort: skip  (common limits the threads first)
import pandas as pd
from frozen.tables import ROOF
from numpy.typing import NDArray

import echocal
from echocal.correct import correct_table

Column = NDArray[np.float64]


@dataclass(frozen=True)
class Kind:
    """A record: where it is, how it is read, how long its windows are.

    Attributes
    ----------
    file : str
        In the folder of real records.
    time : str
        Its column of times.
    since : str
        First day that takes part.
    days : tuple of int
        Lengths of the windows [d].
    columns, options : mapping
        What `echocal.diagnose` gets.
    left_out : tuple of str
        Columns that nobody gets.
    """

    file: str
    time: str
    since: str
    days: tuple[int, ...]
    options: Mapping[str, Any]
    columns: Mapping[str, str] = field(default_factory=dict)
    left_out: tuple[str, ...] = ()


_ROOF_FILE = "roof-sr50/roof_fixed_target_tidy.csv"
_RAW = {"reading_speed": "331.4"}
_TOWN = "old-town-sr50/"
_SECOND = ("second_ranger_mm",)

RECORDS = {
    "roof": Kind(_ROOF_FILE, "TIMESTAMP", "2022-06-08", (5, 10), {"base": "linear", **_RAW}, ROOF),
    "roof from May": Kind(_ROOF_FILE, "TIMESTAMP", "2022-05-17", (5, 10), {"base": "linear", **_RAW}, ROOF),
    "ot-sw-2021": Kind(_TOWN + "ot-sw-2021.csv", "time", "2021-04-16", (30,), _RAW, left_out=_SECOND),
    "ot-hw-2022": Kind(_TOWN + "ot-hw-2022.csv", "time", "2022-04-10", (13,), _RAW, left_out=_SECOND),
    "ot-sw-ard-2021": Kind(_TOWN + "ot-sw-ard-2021.csv", "time", "2021-04-16", (30,), {}, left_out=_SECOND),
}
"""The last one compensates by itself. Its readings are taken as they are. `roof from May` has the time in
which the level jumps; its figures stand apart."""

EXTRA = frozenset({"roof from May"})


def folder() -> Path | None:
    """The folder of real records, if it is there."""
    path = Path(os.environ.get("ECHOCAL_SHARED", ROOT.parent / "shared")) / "data"
    return path if path.is_dir() else None


def load(name: str) -> pd.DataFrame:
    """The rows of a record that take part."""
    where, kind = folder(), RECORDS[name]
    if where is None:
        message = "real records are absent: no folder ../shared/data (set ECHOCAL_SHARED)"
        raise SystemExit(message)
    table = pd.read_csv(where / kind.file).drop(columns=list(kind.left_out))
    return table[pd.to_datetime(table[kind.time]) >= kind.since].reset_index(drop=True)


def windows(name: str, days: int) -> list[pd.DataFrame]:
    """Windows of some days, one after the other; a last one of less than three quarters is left out."""
    table, kind = load(name), RECORDS[name]
    past = (pd.to_datetime(table[kind.time]) - pd.Timestamp(kind.since)).dt.total_seconds() / 86400.0
    number = (past // days).astype(int)
    usual = number.value_counts().max()
    parts = [part.reset_index(drop=True) for _, part in table.groupby(number)]
    return [part for part in parts if len(part) >= 0.75 * usual]


@dataclass(frozen=True)
class Asked:
    """What the engine says about a table, and what a transfer to and from it needs.

    Attributes
    ----------
    said : Record
        Verdict, causes, gain: plain data.
    base, model : Model
        The model without effects that belong to one campaign.
    with_shape : Model or None
        The same with the unexplained term, where it may extend the model.
    rows, groups : ndarray
        Rows that the diagnosis used, and the segment of each.
    """

    said: Record
    base: echocal.Model
    model: echocal.Model
    with_shape: echocal.Model | None
    rows: NDArray[np.int64]
    groups: NDArray[np.int64]


def ask(table: pd.DataFrame, name: str) -> Asked:
    """Diagnose a table of a record."""
    kind = RECORDS[name]
    with warnings.catch_warnings(action="ignore"):
        diagnosis = echocal.diagnose(table, columns=kind.columns, constant_distance=True, **kind.options)
    rows = np.asarray(diagnosis.traces.row)
    begins = np.asarray(diagnosis.rows["level_steps_at_rows"], dtype=np.int64) - 1
    shape = (
        diagnosis.unexplained is not None and diagnosis.unexplained.shape and diagnosis.unexplained.extends
    )
    model = diagnosis.model.transferable()
    return Asked(
        said=said(diagnosis),
        base=echocal.Model(model.law, air=model.air),
        model=model,
        with_shape=diagnosis.model_with_shape.transferable() if shape else None,
        rows=rows,
        groups=np.searchsorted(begins, rows, side="right"),
    )


def said(diagnosis: echocal.Diagnosis) -> Record:
    """The answer in plain data."""
    answer = diagnosis.to_dict()
    gain = answer["gain"] or {}
    keys = ("id", "kind", "probability", "in_model", "doubt", "indistinguishable_from", "parameters")
    return {
        "verdict": answer["verdict"],
        "causes": [{key: cause[key] for key in keys} for cause in answer["causes"]],
        "refuted": [one["id"] for one in answer["refuted"]],
        "unexplained": answer["unexplained"] and answer["unexplained"]["against"],
        "gain": gain.get("variance_removed", 0.0),
        "gain_interval": gain.get("variance_removed_interval_95", [0.0, 0.0]),
        "level_steps": len(diagnosis.rows["level_steps_at_rows"]),
        "used": len(diagnosis.traces.row),
        "autocorrelation": diagnosis.noise["autoregression"],
        "noise_model": dict(diagnosis.noise),
    }


def corrected(table: pd.DataFrame, model: echocal.Model, name: str) -> Column:
    """Distance by a model [m], one entry per row."""
    kind = RECORDS[name]
    speed = kind.options.get("reading_speed")
    with warnings.catch_warnings(action="ignore"):
        outcome = correct_table(table, model, kind.columns, reading_speed=speed)
    return outcome.table["corrected_distance_m"].to_numpy(dtype=float)
