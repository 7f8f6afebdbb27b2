"""A reading that froze."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from echocal.diagnose.faults.common.fault import Fault
from echocal.diagnose.faults.common.values import recorded
from echocal.diagnose.findings.facts import CauseFacts, Columns, Quantity
from echocal.diagnose.findings.finding import Finding
from echocal.diagnose.findings.parts import Parameter
from echocal.diagnose.preprocess.view import View
from echocal.diagnose.settings.faults import FaultSettings
from echocal.diagnose.settings.threshold import threshold

__all__ = ["FAULT"]

_FINEST = 1e-6  # m; below it no two readings are equal by chance


@dataclass(frozen=True)
class Thresholds:
    """Numbers that decide about this fault."""

    shortest: float = threshold(4, "1", "rows of one value; judgement")
    most: float = threshold(5, "1", "runs: more of them are how this sensor is; judgement")
    hidden: float = threshold(
        0.75, "1", "part of neighbors that are equal anyhow, above which a run means nothing; judgement"
    )
    elsewhere: float = threshold(
        8, "1", "rows outside of the longest run that tell how often neighbors are equal; judgement"
    )


FACTS = CauseFacts(
    id="stuck_reading",
    kind="row",
    sentence="The reading froze and was logged again and again.",
    signature="one value in a run of rows, far longer than the readings' step and noise make runs",
    source="arendst/Tasmota #2763: stuck at 283 cm after five minutes",
    parameters=(
        Quantity("first_row", "1", "first row of the run"),
        Quantity("length", "1", "rows of the longest run"),
        Quantity("value", "m", "the frozen reading"),
    ),
    check="log an age or a counter beside the reading",
    prior=0.01,
    formula="reading' = value, in length rows from first_row on",
    repair="leaves out the rows of a run after its first",
)


def runs(values: NDArray[np.float64]) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """First rows and lengths of runs of one value."""
    new = np.ones(len(values), dtype=bool)
    new[1:] = ~(values[1:] == values[:-1])
    starts = np.flatnonzero(new)
    return starts, np.diff(np.append(starts, len(values)))


def detect(view: View, settings: FaultSettings) -> Finding | None:
    """Compare the longest runs with how often neighbors would be equal by themselves."""
    own = settings.of(FACTS, Thresholds)
    values = np.where(view.good, recorded(view), np.nan)
    starts, lengths = runs(values)
    longest = int(np.argmax(lengths))
    if lengths[longest] < own.shortest:
        return None
    elsewhere = np.delete(lengths, longest)
    rows_elsewhere = max(int(elsewhere.sum()), 1)
    equal = (float((elsewhere - 1).sum()) + 0.5) / rows_elsewhere
    if equal > own.hidden or rows_elsewhere < own.elsewhere:
        return None
    at = np.flatnonzero(lengths >= own.shortest)
    surprise = np.zeros(len(lengths))
    for run in at:  # somewhere among n rows
        rows = slice(starts[run], starts[run] + lengths[run])
        surprise[run] = -_by_chance(view, rows, equal) - np.log(len(values))
    longest = int(at[np.argmax(surprise[at])])
    long = (surprise > 0.5 * surprise[longest]) & (surprise > 0)
    if not long.any() or long.sum() > own.most:
        return None
    evidence = float(surprise[longest])
    frozen = np.zeros(len(values), dtype=bool)
    for start, length in zip(starts[long], lengths[long], strict=True):
        frozen[start + 1 : start + length] = True  # the first row of a run was measured
    first, length = int(starts[longest]), int(lengths[longest])
    value = float(view.indication[first])
    usual = np.exp(-(evidence + np.log(len(values))) / (length - 1))
    because = (
        f"rows {first + 1} to {first + length} all read {value:.4f} m; by the readings' step and their noise "
        f"{100 * usual:.2g} % of such neighbors would be equal; repeated rows are left out"
    )
    parameters = (
        Parameter("first_row", first + 1.0, 0.0, "1"),
        Parameter("length", float(length), 0.0, "1"),
        Parameter("value", value, 0.0, "m"),
    )
    evidence = min(evidence, settings.cap)
    return Finding(FACTS, evidence, because, parameters, frozen, view.without(frozen, FACTS.id))


def _by_chance(view: View, rows: slice, equal: float) -> float:
    """Log probability that all rows of a run fall into one step of the readings by themselves.

    Noise carries each row's expectation into the run's step, or not; as often as neighbors are equal
    elsewhere they are equal here at least.
    """
    from scipy.special import ndtr  # takes long to import

    half = 0.5 * max(view.resolution, _FINEST)
    noise = _noise(view)
    off = view.expected[rows] - np.median(view.expected[rows])  # the run's own level is its business
    inside = ndtr((half - off) / noise) - ndtr((-half - off) / noise)
    return float(np.log(np.clip(inside, max(equal, 1e-12), 1.0))[1:].sum())


def _noise(view: View) -> float:
    """Standard deviation of a reading without its step, from its changes from row to row [m]."""
    changes = np.abs(np.diff(view.deviation[view.good & np.isfinite(view.deviation)]))
    step = view.resolution
    robust = 1.4826 / np.sqrt(2) * float(np.median(changes)) if len(changes) else 0.0
    return float(np.sqrt(max(robust**2 - step**2 / 12, (0.05 * step) ** 2, _FINEST**2)))


def spoil(table: Columns, random: np.random.Generator) -> None:
    """Freeze the reading for some rows."""
    first, length = int(random.integers(0, len(table["reading_m"]) - 40)), int(random.integers(10, 40))
    table["reading_m"][first : first + length] = table["reading_m"][first]


FAULT = Fault(FACTS, detect, spoil, Thresholds())
