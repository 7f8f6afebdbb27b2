"""A reading that froze."""

import numpy as np
from numpy.typing import NDArray

from echocal.diagnose.facts import CauseFacts, Quantity
from echocal.diagnose.faults.finding import Finding
from echocal.diagnose.faults.values import recorded
from echocal.diagnose.faults.view import View
from echocal.diagnose.result import Parameter

__all__ = ["FACTS", "detect"]

_SHORTEST = 4  # rows of one value
_MOST = 5  # runs; more of them are how this sensor is
_COARSE = 0.1  # part of neighbors that are equal anyhow, above which a run means nothing

FACTS = CauseFacts(
    id="stuck_reading",
    kind="row",
    sentence="The reading froze and was logged again and again.",
    signature="one value in a run of rows, far longer than chance makes runs",
    source="arendst/Tasmota #2763: stuck at 283 cm after five minutes",
    parameters=(
        Quantity("first_row", "1", "first row of the run"),
        Quantity("length", "1", "rows of the longest run"),
        Quantity("value", "m", "the frozen reading"),
    ),
    check="log an age or a counter beside the reading",
    prior=0.01,
)


def runs(values: NDArray[np.float64]) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """First rows and lengths of runs of one value."""
    new = np.ones(len(values), dtype=bool)
    new[1:] = ~(values[1:] == values[:-1])
    starts = np.flatnonzero(new)
    return starts, np.diff(np.append(starts, len(values)))


def detect(view: View) -> Finding | None:
    """Compare the longest runs with how often neighbors are equal elsewhere."""
    values = np.where(view.good, recorded(view), np.nan)
    starts, lengths = runs(values)
    longest = int(np.argmax(lengths))
    if lengths[longest] < _SHORTEST:
        return None
    elsewhere = np.delete(lengths, longest)
    rows_elsewhere = max(int(elsewhere.sum()), 1)
    equal = (float((elsewhere - 1).sum()) + 0.5) / rows_elsewhere
    if equal > _COARSE or rows_elsewhere < 8:
        return None
    # a run of length L somewhere among n rows has probability n equal^(L-1)
    surprise = -(lengths - 1) * np.log(equal) - np.log(len(values))
    long = (lengths >= _SHORTEST) & (surprise > 0.5 * surprise[longest]) & (surprise > 0)
    if not long.any() or long.sum() > _MOST:
        return None
    evidence = float(surprise[longest])
    frozen = np.zeros(len(values), dtype=bool)
    for start, length in zip(starts[long], lengths[long], strict=True):
        frozen[start + 1 : start + length] = True  # the first row of a run was measured
    first, length = int(starts[longest]), int(lengths[longest])
    value = float(view.indication[first])
    because = (
        f"rows {first + 1} to {first + length} all read {value:.4f} m, where elsewhere "
        f"{100 * equal:.1f} % of neighbors are equal; repeated rows are left out"
    )
    parameters = (
        Parameter("first_row", first + 1.0, 0.0, "1"),
        Parameter("length", float(length), 0.0, "1"),
        Parameter("value", value, 0.0, "m"),
    )
    return Finding(FACTS, min(evidence, 60.0), because, parameters, frozen, view.without(frozen, FACTS.id))
