"""Append a corrected distance and a reason code to a table."""

import warnings
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from echocal.correct.marks import reference_of, with_marks
from echocal.errors import DataError, DataWarning, UsageError
from echocal.model import Model
from echocal.observations import read_observations
from echocal.observations.correction import corrected_distance, outside_smooth
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
        The unchanged table, and ``corrected_distance_m`` [m] and ``unusable``, a reason code. A row
        outside of the range of a smooth correction has a reason and the distance without this correction.
    rows : int
        Number of rows.
    unusable : dict of str to int
        Rows without a corrected distance, by reason code.
    notes : tuple of str
        Notes for the user.
    marked : dict of str to int
        Rows with a corrected distance and a reason code: outside of the range of a smooth correction.
    """

    table: pd.DataFrame
    rows: int
    unusable: dict[str, int]
    notes: tuple[str, ...]
    marked: dict[str, int] = field(default_factory=dict)


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
    notes: tuple[str, ...] = observations.notes
    if mark_rows and MARKS in model.provenance:
        reference = reference_of(table, requests, options.get("missing", ()), model)
        distance, faults, more = with_marks(observations, distance, reference, model)
        reasons, notes = np.where(reasons == "", faults, reasons), (*notes, *more)
    marks = np.where(reasons == "", outside_smooth(observations, model), "")
    unusable, marked = _counts(reasons), _counts(marks)
    if marked:
        said = "; ".join(f"{count} x {reason}" for reason, count in marked.items())
        notes += (f"rows with the distance by the model without its smooth correction: {said}",)
    results: tuple[NDArray[Any], ...] = (distance, np.where(marks == "", reasons, marks))
    whole = table.assign(**dict(zip(RESULTS, results, strict=True)))
    return Corrected(whole, len(table), unusable, notes, marked)


def _counts(reasons: NDArray[Any]) -> dict[str, int]:
    codes, counts = np.unique(reasons[reasons != ""], return_counts=True)
    return dict(zip(codes.tolist(), counts.tolist(), strict=True))


def _without_references(table: pd.DataFrame, requests: dict[str, str], model: Model) -> dict[str, str]:
    """Requests that ignore columns that a correction does not need, so that they make no row unusable."""
    held = make(list(load(table).columns), requests).assignments
    needed = _BURSTS if "position_in_group" in model.reads else ()
    return requests | {
        held[role].column: IGNORE for role in _REFERENCES if role in held and role not in needed
    }
