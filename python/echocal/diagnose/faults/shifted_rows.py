"""Readings that are some rows too low or too high in the table."""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from echocal.diagnose.faults.common.fault import Fault
from echocal.diagnose.findings.facts import CauseFacts, Columns, Quantity
from echocal.diagnose.findings.finding import Finding
from echocal.diagnose.findings.parts import Parameter
from echocal.diagnose.preprocess.view import View
from echocal.diagnose.settings.faults import FaultSettings
from echocal.diagnose.settings.threshold import threshold
from echocal.observations import Observations

__all__ = ["FAULT"]

Column = NDArray[np.float64]

_FARTHEST = 12
_SHIFTS = tuple(sign * rows for rows in range(1, _FARTHEST + 1) for sign in (1, -1))


@dataclass(frozen=True)
class Thresholds:
    """Numbers that decide about this fault."""

    fewest: float = threshold(8, "1", "rows of a table; judgement")
    near: float = threshold(
        0.05, "m", "what no effect on the mean exceeds, besides a part of the distance; judgement"
    )
    near_part: float = threshold(0.06, "1", "that part: no law or thermometer is wrong by more")
    off: float = threshold(0.1, "m", "deviation from which on a row needs an explanation; judgement")
    wide: float = threshold(10, "1", "the same in robust standard deviations; judgement")
    cap: float = threshold(0.5, "m", "deviation beyond which a row is wrong, however far; judgement")
    unexplained: float = threshold(
        0.3, "1", "weight of a row that neither distance explains, of one that the shift explains; judgement"
    )
    against: float = threshold(4.0, "1", "log Bayes factor of a row that the shift contradicts; judgement")


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


def detect(view: View, settings: FaultSettings) -> Finding | None:
    """Find the row from which on readings fit the references of rows before, or after."""
    own = settings.of(FACTS, Thresholds)
    if view.reference is None or view.given is not None or len(view) < own.fewest:
        return None
    if view.farthest < 0.999 * min(own.off, own.wide * view.scatter + 5e-3):
        return None  # no row is explained by a neighbor's distance better than by its own
    usual = view.indication, view.reference
    straight = _misfit(*usual, 0, own.cap)
    best: tuple[float, int, int] = (0.0, 0, 0)
    for shift in _SHIFTS:
        gain = np.nan_to_num(straight - _misfit(*usual, shift, own.cap))
        suffix = np.cumsum(gain[::-1])[::-1]
        first = len(suffix) - 1 - int(np.argmax(suffix[::-1]))
        best = max(best, (float(suffix[first]), first, shift))
    total, first, shift = best
    if total <= 0 or abs(shift) == _FARTHEST:  # the best of all may be farther still
        return None
    evidence = min(_evidence(view, first, shift, own), settings.cap)
    if evidence <= 0:
        return None
    row, whence = first + 1, first + 1 - shift
    side = f"{abs(shift)} row{'s' if abs(shift) > 1 else ''} {'above' if shift > 0 else 'below'}"
    own, fits = view.reference[first], view.reference[whence - 1]
    because = (
        f"from row {row} on readings fit the reference distance {side}: row {row} reads "
        f"{view.indication[first]:.3f} m, {own:.3f} m is its own, {fits:.3f} m that of {whence}; moved back"
    )
    parameters = (Parameter("first_row", float(row), 0.0, "1"), Parameter("shift", float(shift), 0.0, "1"))
    rows = np.arange(len(view)) >= first
    return Finding(FACTS, evidence, because, parameters, rows, _moved(view, first, shift))


def _misfit(indication: Column, reference: Column, shift: int, cap: float) -> Column:
    """How far each reading is from the reference `shift` rows before, capped [m]; NaN at the ends."""
    moved = np.full(len(reference), np.nan)
    if shift > 0:
        moved[shift:] = reference[:-shift]
    elif shift < 0:
        moved[:shift] = reference[-shift:]
    else:
        moved = reference
    return np.asarray(np.minimum(np.abs(indication - moved), cap))


def _evidence(view: View, first: int, shift: int, settings: Thresholds) -> float:
    """Rows that only the shift explains against rows that it contradicts."""
    assert view.reference is not None
    near = (settings.near + settings.near_part * view.reference)[first:]
    close = np.minimum(0.4 * near, 6 * view.scatter + 1e-3)
    wide = np.minimum(np.maximum(near, settings.off), settings.wide * view.scatter + 5e-3)
    usual = view.indication - (view.expected - view.reference)
    own, moved = (_misfit(usual, view.reference, k, settings.cap)[first:] for k in (0, shift))
    with np.errstate(invalid="ignore"):
        explained = int(((own > wide) & (moved < close)).sum())
        unexplained = int((own > wide).sum()) - explained
        against = int(((own < close) & (moved > wide)).sum())
    spread = float(np.nanmax(view.reference) - np.nanmin(view.reference))
    # an outlier would fit the neighbor's reference by chance
    each = np.log(max(spread / (2 * float(np.nanmedian(close))), 1.5))
    given = view.reference[np.isfinite(view.reference)]
    places = len(_SHIFTS) * (1 + np.count_nonzero(np.diff(given) != 0))  # where one could begin to show
    net = explained - settings.unexplained * unexplained
    return float(net * each - settings.against * against - np.log(places))


def _moved(view: View, first: int, shift: int) -> Observations:
    """Every reading back to its row; rows whose reading is lost are marked."""
    observations = view.observations
    n = len(view)
    source = np.arange(n)
    source[first:] += shift
    lost = (source >= n) | (source < 0)
    if shift < 0:  # rows lost in the table: readings come from above, and the first have none
        lost |= (np.arange(n) >= first) & (source < first) & (np.arange(n) < first - shift)
    source = np.where(lost, np.arange(n), source)
    two = np.full(n, 2.0)
    speed = view.base.indication(two, observations.conditions)
    reading = None if observations.reading is None else observations.reading[source]
    echo_time = observations.echo_time[source]
    if reading is not None:
        moved = 2 * view.indication[source] / speed
        echo_time = np.where(np.arange(n) < first, observations.echo_time, moved)
    unusable = observations.unusable.astype(object)
    unusable[lost & (unusable == "")] = FACTS.id
    return replace(observations, echo_time=echo_time, reading=reading, unusable=unusable.astype(str))


def spoil(table: Columns, random: np.random.Generator) -> None:
    """Copy a line or two somewhere in the middle: readings below are too low in the table."""
    shift, first = int(random.integers(1, 3)), int(random.integers(30, len(table["reading_m"]) - 60))
    table["reading_m"][first + shift :] = table["reading_m"][first:-shift].copy()


FAULT = Fault(FACTS, detect, spoil, Thresholds())
