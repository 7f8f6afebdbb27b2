"""Rows that the user holds out: apart from all others before anything is computed."""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from echocal.diagnose.preprocess.window import instant, times
from echocal.errors import UsageError
from echocal.observations import Observations
from echocal.observations.derived import derived
from echocal.quantities import QUANTITIES

__all__ = ["HELD_OUT_ROW", "split"]

Mask = NDArray[np.bool_]
Column = NDArray[np.float64]

HELD_OUT_ROW = "held out"
"""Reason for which such a row takes no part."""


def split(
    observations: Observations, after: str | float | None, fewest: int
) -> tuple[Observations, Observations | None]:
    """Separate the rows from a time on.

    Each part keeps the length of the table. It has no value of a row of the other part, and what is derived
    from several rows, such as a rate of change, is derived from its own rows.

    Parameters
    ----------
    observations : Observations
    after : str, float or None
        ISO 8601, or seconds since the first row. With None, all rows are in the first part.
    fewest : int
        Usable rows that each part needs.

    Returns
    -------
    Observations
        The rows before that time.
    Observations or None
        The held-out rows.

    Raises
    ------
    UsageError
        If the table has no times, or a part has too few usable rows.
    """
    if after is None:
        return observations, None
    held = _from(observations, after)
    judged, seen = (int((observations.usable & part).sum()) for part in (held, ~held))
    if min(judged, seen) < fewest:
        message = (
            f"with rows held out from {after} on, {seen} rows are left to fit and {judged} to "
            f"validate; both numbers must be at least {fewest}"
        )
        raise UsageError(message)
    return _without(observations, held), _without(observations, ~held)


def _from(observations: Observations, after: str | float) -> Mask:
    if isinstance(after, str):
        return np.asarray(times(observations, after) >= instant(after))
    elapsed = observations.conditions.get("elapsed_time")
    if elapsed is None:
        message = "rows cannot be held out by time: the table has no column of times (map one to time_s)"
        raise UsageError(message)
    return np.asarray(elapsed >= after)


def _without(observations: Observations, rows: Mask) -> Observations:
    """The table without the values of some rows."""

    def blank(column: Column) -> Column:
        return np.where(rows, np.nan, column)

    recorded = {n: c for n, c in observations.conditions.items() if QUANTITIES[n].derived_from is None}
    kept = np.flatnonzero(~rows)
    own = derived(
        {name: column[kept] for name, column in recorded.items()},
        {name: labels[kept] for name, labels in observations.labels.items()},
    )
    conditions = {name: blank(column) for name, column in observations.conditions.items()}
    for name, values in own.items():
        conditions[name][kept] = values
    reasons = observations.unusable.astype(object)
    reasons[rows & (observations.unusable == "")] = HELD_OUT_ROW
    reading, reference = observations.reading, observations.reference_distance
    return replace(
        observations,
        echo_time=blank(observations.echo_time),
        conditions=conditions,
        reference_distance=None if reference is None else blank(reference),
        unusable=reasons.astype(str),
        reading=None if reading is None else blank(reading),
        extra={name: blank(column) for name, column in observations.extra.items()},
    )
