"""Readings that are some rows too low or too high in the table."""

import numpy as np
from numpy.typing import NDArray

from echocal.diagnose.faults.common.fault import Fault, Found
from echocal.diagnose.faults.common.likelihood import log_density, log_likelihood
from echocal.diagnose.faults.common.repair import with_values
from echocal.diagnose.findings.facts import CauseFacts, Columns, Quantity
from echocal.diagnose.preprocess.view import View
from echocal.diagnose.settings.faults import FaultSettings
from echocal.observations import Observations
from echocal.observations.quantiles import MAD_TO_SD

__all__ = ["FAULT"]

Column = NDArray[np.float64]

_FEWEST = 8  # rows of a table
_FARTHEST = 12
_SHIFTS = tuple(sign * rows for rows in range(1, _FARTHEST + 1) for sign in (1, -1))
_OFF = 0.1, 10.0  # m and scatters: where no row is off by either, no other distance explains it better

FACTS = CauseFacts(
    id="shifted_rows",
    kind="row",
    sentence="From some row on, each reading is some rows away from the distance that it belongs to.",
    signature="the reading of each row fits the reference distance of a neighbor",
    source="CATALOGUE, bookkeeping",
    parameters=(
        Quantity("first_row", "1", "first row that is shifted"),
        Quantity("shift", "1", "rows by which readings are too low"),
    ),
    check="look for a line that was copied or lost in the table",
    prior=0.01,
    formula="reading'[row] = reading[row - shift], from first_row on",
    needs=("reference_distance",),
    repair="moves readings back to their rows; rows whose reading is lost are marked",
)


def detect(view: View, _: object, settings: FaultSettings) -> Found | None:
    """Find the row from which on readings fit the references of rows before, or after.

    The table with readings moved back is compared with the table as it is, each with an error of its own
    that is smooth in distance and temperature.
    """
    if view.reference is None or view.given is not None or len(view) < _FEWEST:
        return None
    if view.farthest < min(_OFF[0], _OFF[1] * view.scatter):
        return None
    _, first, shift = max(_candidates(view), default=(0.0, 0, 0))
    if not shift or abs(shift) == _FARTHEST:  # the best of all may be farther still
        return None
    moved = view.after(_moved(view, first, shift))
    rows = view.good & moved.good
    changes = 1 + np.count_nonzero(np.diff(view.reference[view.good]))  # where one could begin to show
    evidence = log_likelihood(moved, rows) - log_likelihood(view, rows) - np.log(len(_SHIFTS) * changes)
    whence = first - shift
    because = (
        f"from row {first + 1} on readings fit the reference distance {abs(shift)} "
        f"row{'s' if abs(shift) > 1 else ''} {'above' if shift > 0 else 'below'}: row {first + 1} reads "
        f"{view.indication[first]:.3f} m, {view.reference[first]:.3f} m is its own, "
        f"{view.reference[whence]:.3f} m that of {whence + 1}; moved back"
    )
    after = np.arange(len(view)) >= first
    return Found(after, evidence, because, (first + 1, shift), moved.observations)


def _candidates(view: View) -> list[tuple[float, int, int]]:
    """For each shift the log likelihood ratio of the rows from the best row on, this row, and the shift."""
    assert view.reference is not None
    own, wide, found = np.abs(view.indication - view.reference), float(np.nanmax(view.indication)), []
    for shift in _SHIFTS:
        off = np.abs(view.indication - _earlier(view.reference, shift))
        scatter = max(MAD_TO_SD * float(np.nanmedian(np.fmin(own, off))), view.resolution, 1e-3)
        gain = np.nan_to_num(log_density(off, scatter, wide) - log_density(own, scatter, wide))
        suffix = np.cumsum(gain[::-1])[::-1]
        first = len(suffix) - 1 - int(np.argmax(suffix[::-1]))
        if suffix[first] > 0.0:
            found.append((float(suffix[first]), first, shift))
    return found


def _earlier(values: Column, rows: int) -> Column:
    """The value so many rows before each row; NaN where there is none."""
    at = np.arange(len(values)) - rows
    inside = (at >= 0) & (at < len(values))
    return np.where(inside, values[np.where(inside, at, 0)], np.nan)


def _moved(view: View, first: int, shift: int) -> Observations:
    """Every reading back to its row; rows whose reading is lost are marked."""
    data, row = view.observations, np.arange(len(view))
    after = row >= first
    held = {"echo_time": data.echo_time} if data.reading is None else {"reading": data.reading}
    back = {name: _earlier(column, -shift) for name, column in held.items()}
    lost = after & ~np.isfinite(next(iter(back.values())))
    lost |= after & (shift < 0) & (row < first - shift)  # readings come from above, and the first have none
    repaired = with_values(view, after & ~lost, FACTS.id, **back)
    return view.after(repaired).without(lost, FACTS.id)


def spoil(table: Columns, random: np.random.Generator) -> None:
    """Copy a line or two somewhere in the middle: readings below are too low in the table."""
    shift, first = int(random.integers(1, 3)), int(random.integers(30, len(table["reading_m"]) - 60))
    table["reading_m"][first + shift :] = table["reading_m"][first:-shift].copy()


FAULT = Fault(FACTS, detect, spoil)
