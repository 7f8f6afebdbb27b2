"""Append a corrected distance and a reason code to a table."""

import warnings
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
import pandas as pd

from echocal.correct.marks import reference_of, with_marks
from echocal.errors import DataError, DataWarning, UsageError
from echocal.model import Model
from echocal.observations import read_observations
from echocal.observations.correction import corrected_distance
from echocal.observations.marks import MARKS
from echocal.observations.names import IGNORE
from echocal.observations.plan import make, read_columns
from echocal.observations.source import load

__all__ = ["RESULTS", "Corrected", "correct_table"]

RESULTS = ("corrected_distance_m", "unusable")
"""Names of the two columns that a correction appends."""

_REFERENCES = ("reference_distance", "stand", "group", "order")
_BURSTS = ("group", "order")  # what the position in a burst is derived from


@dataclass(frozen=True)
class Corrected:
    """A corrected table.

    Attributes
    ----------
    table : pandas.DataFrame, shape (n, m + 2)
        The unchanged table, and ``corrected_distance_m`` [m] and ``unusable``, a reason code.
    rows : int
        Number of rows.
    unusable : dict of str to int
        Rows without a corrected distance, by reason code.
    notes : tuple of str
        Notes for the user.
    """

    table: pd.DataFrame
    rows: int
    unusable: dict[str, int]
    notes: tuple[str, ...]


def correct_table(
    table: pd.DataFrame,
    model: Model,
    columns: Mapping[str, str] | None = None,
    *,
    reading_speed: str | None = None,
    mark_rows: bool = True,
    **options: Any,
) -> Corrected:
    """Correct every row of a table, in its order.

    Parameters
    ----------
    table : pandas.DataFrame, shape (n, m)
        Echoes; see `echocal.read_observations`.
    model : Model
        The model of air and device.
    columns : mapping of str to str, optional
        Meaning of columns, by their names.
    reading_speed : str, optional
        Speed that the firmware made readings with; default: the law of the model.
    mark_rows : bool
        Whether rows that are as those which the diagnosis of the model left out get no corrected
        distance, but the name of the fault as reason.
    **options
        As in `echocal.read_observations`.

    Returns
    -------
    Corrected
        As many rows as the table has; NaN and a reason code where a row could not be used.

    Raises
    ------
    DataError
        If the table cannot be read, lacks what the model needs, or was corrected before.

    Examples
    --------
    >>> import pandas as pd
    >>> import echocal
    >>> from echocal.correct import correct_table
    >>> device = echocal.Model("linear", {"fixed_delay": {"delay": 30e-6}})
    >>> echoes = pd.DataFrame({"echo_us": [11680.0, 5860.0], "temperature_C": [20.0, 20.0]})
    >>> correct_table(echoes, device).table["corrected_distance_m"].round(6).tolist()
    [2.000305, 1.001011]
    """
    if not isinstance(table, pd.DataFrame):
        message = f"correct_table corrects a pandas table, got {type(table).__name__}"
        raise UsageError(message)
    taken = [name for name in RESULTS if name in table.columns]
    if taken:
        message = f"the table already has a column '{taken[0]}': it was corrected before; rename or remove it"
        raise DataError(message)
    requests = read_columns(columns)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", DataWarning)  # the notes say the same
        observations = read_observations(
            table,
            _without_references(table, requests, model),
            reading_speed=reading_speed or model.law,
            **options,
        )
    distance = corrected_distance(observations, model)
    reasons = np.where(observations.usable & np.isnan(distance), "no distance fits", observations.unusable)
    for column in model.columns.values():
        lacks = observations.usable & np.isnan(observations.thermometers[column])
        reasons = np.where(lacks, f"{column} missing", reasons)
    notes: tuple[str, ...] = ()
    if mark_rows and MARKS in model.provenance:
        reference = reference_of(table, requests, options.get("missing", ()), model)
        distance, marks, notes = with_marks(observations, distance, reference, model)
        reasons = np.where(reasons == "", marks, reasons)
    codes, counts = np.unique(reasons[reasons != ""], return_counts=True)
    return Corrected(
        table.assign(**dict(zip(RESULTS, (distance, reasons), strict=True))),
        len(table),
        dict(zip(codes.tolist(), counts.tolist(), strict=True)),
        (*observations.notes, *notes),
    )


def _without_references(table: pd.DataFrame, requests: dict[str, str], model: Model) -> dict[str, str]:
    """Requests that ignore columns that a correction does not need, so that they make no row unusable."""
    held = make(list(load(table).columns), requests).assignments
    needed = _BURSTS if "position_in_group" in model.reads else ()
    return requests | {
        held[role].column: IGNORE for role in _REFERENCES if role in held and role not in needed
    }
