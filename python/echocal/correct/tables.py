"""`echocal.correct`: append a corrected distance and a reason code to a table."""

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from echocal.correct.needed import needed, refuse_no_model
from echocal.correct.results import DISTANCE, LEVEL, RESULTS, STATUS, UNCERTAINTY, UNUSABLE
from echocal.correct.rows import Reading, Rows, correct_rows
from echocal.errors import DataError, UsageError
from echocal.model import Model
from echocal.observations.arrow import arrow
from echocal.observations.given import READ_OPTIONS, refuse_keywords
from echocal.observations.misspelled import naming
from echocal.observations.numbers import Missing
from echocal.observations.reading import understood
from echocal.observations.source import load
from echocal.observations.table import Observations

_ATTRS = {
    DISTANCE: {"units": "m", "long_name": "corrected distance"},
    LEVEL: {"units": "m", "long_name": "corrected level"},
    UNCERTAINTY: {"units": "m", "long_name": "standard uncertainty of the corrected distance"},
}
"""Attributes of the variables of xarray, as the CF conventions have them."""


@dataclass(frozen=True)
class Corrected:
    """A corrected table.

    Attributes
    ----------
    table : DataFrame of the library that was given, shape (n, m + 4)
        The unchanged table of pandas, polars, pyarrow or xarray (a dataset); of pandas for a file, a mapping
        and other libraries. It has ``corrected_distance_m`` [m], ``distance_standard_uncertainty_m`` [m],
        ``status``, a reason code, and ``unusable``, its former name, too; where the reading is a level,
        ``corrected_level_m`` in place of the distance. A row
        outside of the range of a smooth correction has a reason and the distance without this correction.
    rows : int
        Number of rows.
    unusable : dict of str to int
        Rows without a corrected distance, by reason code.
    notes : tuple of str
        Notes for the user.
    marked : dict of str to int
        Rows with a corrected distance and a reason code: outside of the range of a smooth correction.

    Examples
    --------
    >>> import echocal
    >>> echoes = {"echo_us": [11680.0, 0.0], "temperature_C": [20.0, 20.0]}
    >>> corrected = echocal.correct(echoes, echocal.Model("linear"))
    >>> corrected.rows, corrected.unusable
    (2, {'echo_us out of range': 1})
    """

    table: Any
    rows: int
    unusable: dict[str, int]
    notes: tuple[str, ...]
    marked: dict[str, int] = field(default_factory=dict)


def correct(
    table: Any,
    model: Model,
    columns: Mapping[str, str] | str | Path | None = None,
    *,
    reading_speed: str | float | None = None,
    mark_rows: bool = True,
    uncertainties: Sequence[str] | Mapping[str, float] = (),
    **options: Any,
) -> Corrected:
    """Correct every row of a table, in its order.

    `echocal.correct_files` corrects files of any size, and folders.

    Parameters
    ----------
    table : path, DataFrame of any library, or mapping of str to array_like, shape (n, m)
        Echoes; see `echocal.read_observations`.
    model : Model
        The model of air and device.
    columns : mapping of str to str, or path of a TOML file, optional
        Meaning of columns, by their names.
    reading_speed : str or float, optional
        Speed that the firmware made readings with; default: the law of the model.
    mark_rows : bool
        Whether rows that are as those which the diagnosis of the model left out get no corrected
        distance, but the name of the fault as reason.
    uncertainties : sequence of str, or mapping of str to float
        Standard uncertainties of recorded or assumed values: ``["temperature_C=0.5", "echo_us=10"]``.
    **options
        Further arguments of `echocal.read_observations`: ``missing``, ``trust``, ``time_zone``, ``at``, ...

    Returns
    -------
    Corrected
        As many rows as the table has; NaN and a reason code where a row could not be used.

    Raises
    ------
    UsageError
        If the model is none, or the table is one of `Observations`.
    DataError
        If the table cannot be read, lacks what the model needs, or was corrected before.

    Examples
    --------
    >>> import pandas as pd
    >>> import echocal
    >>> device = echocal.Model("linear", {"fixed_delay": {"delay": 30e-6}})
    >>> echoes = pd.DataFrame({"echo_us": [11680.0, 5860.0], "temperature_C": [20.0, 20.0]})
    >>> echocal.correct(echoes, device).table["corrected_distance_m"].round(6).tolist()
    [2.000305, 1.001011]
    """
    refuse_keywords(correct, options, READ_OPTIONS)
    refuse_no_model(model)
    if isinstance(table, Observations):
        raise UsageError(
            "correct appends columns to a table, got Observations; give the table that they were read from"
        )
    said = {"columns": columns, "reading_speed": reading_speed, **options}
    reading = Reading.of(said, uncertainties, mark_rows)
    whole = load(table, reading.layout, sheet=reading.sheet)
    refuse_corrected(whole.columns)
    requests, found, notes = understood(whole, reading.requests_of(whole.columns))
    reading = replace(reading, trust={*reading.trust, *found.sure})
    Missing(reading.missing).refuse_unknown(whole.columns)
    read = needed(
        list(whole.columns),
        model,
        requests,
        reading_speed=reading.reading_speed,
        trust=reading.trust,
        mark_rows=mark_rows,
    )
    with naming(list(whole.columns)):
        rows = correct_rows(whole, model, read, reading)
    for reason in dict.fromkeys(found.corrupt.values()):
        lost = [row for row, why in found.corrupt.items() if why == reason]
        rows = rows.lost(np.isin(np.arange(len(whole)), lost), reason)
    unusable, marked = ({why: count for why, (count, _) in own.items()} for own in counts(rows))
    notes = [*found.notes, *notes, *rows.notes, *said_of(marked)]
    return Corrected(appended(table, whole, results_of(rows)), len(whole), unusable, tuple(notes), marked)


correct_table = correct
"""The name that the function had before; scripts call it."""


def results_of(rows: Rows) -> dict[str, NDArray[Any]]:
    """The appended columns by name."""
    reasons = np.array(rows.reasons)[rows.codes]
    return {rows.first: rows.distance, UNCERTAINTY: rows.uncertainty, STATUS: reasons, UNUSABLE: reasons}


def refuse_corrected(names: Collection[str]) -> None:
    """Raise `DataError` for a table that has a column which a correction appends."""
    taken = [name for name in (*RESULTS, LEVEL) if name in names]
    if taken:
        again = taken[0] in (DISTANCE, LEVEL)
        before = "it was corrected before" if again else "a correction adds one of that name"
        raise DataError(f"the table already has a column '{taken[0]}': {before}; rename or remove it")


def counts(rows: Rows) -> tuple[dict[str, tuple[int, int]], dict[str, tuple[int, int]]]:
    """Number and first of the rows without a distance, and of those with one and a reason; by reason."""
    found = np.bincount(rows.codes, minlength=len(rows.reasons)).tolist()
    by_kind: tuple[dict[str, tuple[int, int]], dict[str, tuple[int, int]]] = ({}, {})
    for place, (reason, count) in enumerate(zip(rows.reasons, found, strict=True)):
        if count and reason:
            by_kind[0 if rows.unusable[place] else 1][reason] = count, int(np.argmax(rows.codes == place))
    return by_kind


def said_of(marked: Mapping[str, int]) -> tuple[str, ...]:
    """A sentence on rows outside of the range of a smooth correction."""
    if not marked:
        return ()
    said = "; ".join(f"{count} x {reason}" for reason, count in marked.items())
    return (f"rows with the distance by the model without its smooth correction: {said}",)


def appended(table: Any, whole: pd.DataFrame, results: Mapping[str, NDArray[Any]]) -> Any:
    """A table with columns more; nothing that it holds is changed.

    `whole` is what was loaded of the table: the result where its kind holds no columns, or is not known.
    """
    library = type(table).__module__.partition(".")[0]
    if isinstance(table, pd.DataFrame):
        return table.assign(**results)
    if library == "polars":
        import polars as pl  # the user has it

        columns = {name: v if v.dtype.kind == "f" else v.tolist() for name, v in results.items()}
        return table.with_columns([pl.Series(name, values) for name, values in columns.items()])
    if library == "pyarrow":
        for name, values in results.items():
            table = table.append_column(name, arrow().array(values))
        return table
    if library == "xarray":
        return _xarray(table, results)
    return whole.assign(**results)


def _xarray(table: Any, results: Mapping[str, NDArray[Any]]) -> Any:
    """A dataset; an array becomes one that holds it. The rows are its points, the last dimension first."""
    dims = {dim: table.sizes[dim] for dim in (table.dims if hasattr(table, "dtype") else table.sizes)}
    held = table.to_dataset() if hasattr(table, "dtype") else table
    shape = tuple(dims.values())
    return held.assign(
        {
            name: (tuple(dims), np.reshape(values, shape), _ATTRS.get(name, {}))
            for name, values in results.items()
        }
    )
