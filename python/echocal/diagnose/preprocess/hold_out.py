"""Rows that the user holds out: apart from all others before anything is computed."""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from echocal.diagnose.preprocess.window import instant, times
from echocal.errors import UsageError
from echocal.observations import Observations
from echocal.observations.derived import derived
from echocal.quantities import QUANTITIES

__all__ = ["HELD_OUT_ROW", "NOT_HELD_OUT", "blanked", "split"]

Mask = NDArray[np.bool_]
Column = NDArray[np.float64]

HELD_OUT_ROW = "held out"
"""Reason for which such a row takes no part."""

NOT_HELD_OUT = "not held out"
"""Reason for which any other row takes no part among the held-out rows."""


def split(
    observations: Observations, after: str | float | None, fewest: int
) -> tuple[Observations, Observations | None]:
    """Separate the rows from a time on.

    Each part keeps the length of the table. It has no measured value of a row of the other part, and what is
    derived from several rows, such as a rate of change, is derived from its own rows.

    Parameters
    ----------
    observations : Observations
    after : str, float or None
        ISO 8601, or seconds since the first row. With None, all rows are in the first part.
    fewest : int
        Rows that each part needs.

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
    judged, seen = int(held.sum()), int((~held).sum())  # usable or not: a fault may still be repaired
    if min(judged, seen) < fewest:
        message = (
            f"with rows held out from {after} on, {seen} rows are left to fit and {judged} to "
            f"validate; both numbers must be at least {fewest}"
        )
        raise UsageError(message)
    return blanked(observations, held, HELD_OUT_ROW), blanked(observations, ~held, NOT_HELD_OUT)


def _from(observations: Observations, after: str | float) -> Mask:
    if isinstance(after, str):
        return np.asarray(times(observations, after) >= instant(after))
    elapsed = observations.conditions.get("elapsed_time")
    if elapsed is None:
        message = "rows cannot be held out by time: the table has no column of times (map one to time_s)"
        raise UsageError(message)
    return np.asarray(elapsed >= after)


def blanked(observations: Observations, rows: Mask, reason: str) -> Observations:
    """The table without the values of some rows, also not in what is derived from several rows."""

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
    reasons[rows & (observations.unusable == "")] = reason
    reading, reference = observations.reading, observations.reference_distance
    return replace(
        observations,
        echo_time=blank(observations.echo_time),
        conditions=conditions,
        reference_distance=None if reference is None else blank(reference),
        unusable=reasons.astype(str),
        reading=None if reading is None else blank(reading),
        extra={name: blank(column) for name, column in observations.extra.items()},
        thermometers={name: blank(column) for name, column in observations.thermometers.items()},
    )
