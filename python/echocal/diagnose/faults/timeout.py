"""No echo: a constant in place of a time."""

from dataclasses import dataclass

import numpy as np

from echocal.diagnose.faults.common.fault import Fault
from echocal.diagnose.faults.common.values import far, recorded, repeats
from echocal.diagnose.findings.facts import CauseFacts, Columns, Quantity
from echocal.diagnose.findings.finding import Finding, listed
from echocal.diagnose.findings.parts import Parameter
from echocal.diagnose.preprocess.view import View
from echocal.diagnose.settings.faults import FaultSettings
from echocal.diagnose.settings.threshold import threshold
from echocal.observations.marks import RowRule

__all__ = ["FAULT"]

_SAME = 1e-10  # relative; what arithmetic leaves of one constant
_KNOWN = 38e-3  # s, length of the HC-SR04's pulse without an echo (data sheet)


@dataclass(frozen=True)
class Thresholds:
    """Numbers that decide about this fault."""

    tolerance: float = threshold(
        5e-5, "s", "around the 38 ms of the data sheet: clones differ by tens of us; judgement"
    )
    lone: float = threshold(3, "1", "far rows among which a single one at 38 ms means something; judgement")
    part: float = threshold(0.5, "1", "part of the far rows that share the constant; judgement")
    many: float = threshold(5, "1", "rows that share the constant, of which no part is asked; judgement")
    each: float = threshold(
        8.0, "1", "largest log Bayes factor of a row that repeats a far value exactly; judgement"
    )
    cloud: float = threshold(
        5.0,
        "1",
        "robust standard deviations, or steps of the readings, around the constant, in which other far rows "
        "show the scatter of an echo; judgement",
    )
    repeats: float = threshold(
        0.1, "1", "part of the rows that repeat a value, from which readings have a step; judgement"
    )
    alone: float = threshold(
        0.1, "1", "other far rows that near, as a part of those at the constant, that are chance; judgement"
    )


FACTS = CauseFacts(
    id="timeout",
    kind="row",
    sentence="No echo came back; the device reports a constant instead.",
    signature="one value far from all others, repeated exactly: 38 ms, 0, a largest range",
    source="HC-SR04 data sheet (38 ms); forum.arduino.cc 613370: plateaus at 16 to 18 and 70 ms on a clone",
    parameters=(Quantity("echo_time", "s", "time reported without an echo"), Quantity("rows", "1", "rows")),
    check="point the sensor into the open: what it then reports is its timeout",
    prior=0.02,
    formula="echo time' = echo_time, a constant, in single rows",
    repair="leaves the rows out",
)


def detect(view: View, settings: FaultSettings) -> Finding | None:
    """Look for a far value that repeats exactly, as a time or as a reading."""
    own = settings.of(FACTS, Thresholds)
    outliers = np.flatnonzero(far(view, settings.far))
    candidates = [_largest(view.observations.echo_time, outliers), _largest(recorded(view), outliers)]
    known = outliers[np.abs(view.observations.echo_time[outliers] - _KNOWN) < own.tolerance]
    rows = max([*candidates, known if len(outliers) <= own.lone else outliers[:0]], key=len)
    if not len(rows) or (len(rows) < own.many and len(rows) < own.part * len(outliers)):
        return None
    time = float(np.median(view.observations.echo_time[rows]))
    mask = np.zeros(len(view), dtype=bool)
    mask[rows] = True
    because = (
        f"{listed(mask)}: an echo time of {1e3 * time:.3f} ms ({view.indication[rows[0]]:.2f} m) again and "
        f"again, where {view.expected[rows[0]]:.2f} m is expected; left out"
    )
    parameters = (Parameter("echo_time", time, 0.0, "s"), Parameter("rows", float(len(rows)), 0.0, "1"))
    evidence = min(_constant(view, outliers, rows, own), settings.cap)
    return Finding(
        FACTS,
        evidence,
        because,
        parameters,
        mask,
        view.without(mask, FACTS.id),
        rules=_rules(view, rows, own),
    )


def _rules(view: View, rows: np.ndarray, own: Thresholds) -> tuple[RowRule, ...]:
    """The constant, as a time or as a reading; as both, where one temperature does not tell them apart."""
    times, readings = view.observations.echo_time[rows], recorded(view)[rows]
    time, reading = float(np.median(times)), float(np.median(readings))
    one_time, one_reading = np.ptp(times) <= _SAME * time, np.ptp(readings) <= _SAME * reading
    of_reading = RowRule(reason=FACTS.id, kind="equals", quantity="reading", value=reading)
    if one_reading and not one_time:
        return (of_reading,)
    tolerance = 0.0 if one_time else own.tolerance
    of_time = RowRule(reason=FACTS.id, kind="equals", quantity="echo_time", value=time, tolerance=tolerance)
    recorded_both = one_reading and view.observations.reading is not None
    return (of_time, of_reading) if recorded_both else (of_time,)


def _constant(view: View, outliers: np.ndarray, rows: np.ndarray, own: Thresholds) -> float:
    """Log Bayes factor of a constant against echoes from one place, whose readings repeat by their step.

    Such echoes scatter: far rows that read nearly the same tell how many fall on one step by chance.
    """
    count = len(rows)
    step = view.resolution
    if not step and repeats(recorded(view)) > own.repeats:
        step = view.scatter / own.cloud  # there is one that was not found
    if count < 2 or not step:
        return own.each * count  # readings without a step do not repeat by chance
    off = np.abs(view.indication[outliers] - float(np.median(view.indication[rows])))
    wide = own.cloud * max(view.scatter, step)
    near, around = (max(int((off < width).sum()) - count, 0) for width in (own.cloud * step, wide))
    if near > own.alone * count:
        return -own.each
    chance = (around + 0.5) * step / (2 * wide)  # rows that one step holds
    by_chance = count * np.log(count / chance) - (count - chance) - np.log(len(outliers))
    return float(min(own.each * count, by_chance))


def _largest(values: np.ndarray, rows: np.ndarray) -> np.ndarray:
    """Rows of the largest group of one value, two at least."""
    if len(rows) < 2:
        return rows[:0]
    order = rows[np.argsort(values[rows], kind="stable")]
    sorted_ = values[order]
    new = np.concatenate([[True], np.diff(sorted_) > _SAME * np.abs(sorted_[1:])])
    group = np.cumsum(new) - 1
    counts = np.bincount(group)
    best = int(counts.argmax())
    return order[group == best] if counts[best] > 1 else rows[:0]


def spoil(table: Columns, random: np.random.Generator) -> None:
    """Report 38 ms in rows without an echo."""
    rows = random.choice(len(table["reading_m"]), 5, replace=False)
    speed = 331.4 + 0.6 * table["temperature_C"][rows]
    table["reading_m"][rows] = 0.5 * speed * _KNOWN


FAULT = Fault(FACTS, detect, spoil, Thresholds())
