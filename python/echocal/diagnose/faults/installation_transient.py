"""The first rows of a log, while the sensor is being installed.

What follows a law is no matter of this file. A thermometer that its board warms, and a mount that settles,
approach their end exponentially, with a size and a time constant: these are the effects
`temperature_self_heating` and `drift`, and a model corrects them. A constant offset of many rows is a
`step_change`. What is left is a time in which the sensor did not measure its target: an installer stands in
the beam, the sensor is turned in his hands, the target is still being put up. No size describes such rows,
and any cause that grows or fades with time would be fitted to them. They are left out.

Rows are named only if no other stretch of the log, of as many rows, is nearly as far from the rows after it.
Slow noise, weather and a level that moves make all stretches differ, so they need no noise model here. And
they must be farther off than air or a thermometer can explain; less is left to the effects, and to the rule
that a cause which few rows carry is not named.
"""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from echocal.diagnose.faults.common.fault import Fault, Found
from echocal.diagnose.faults.common.values import millimeters
from echocal.diagnose.findings.facts import CauseFacts, Columns, Quantity
from echocal.diagnose.findings.finding import listed
from echocal.diagnose.preprocess.view import View
from echocal.diagnose.preprocess.window import OUTSIDE
from echocal.diagnose.settings.faults import FaultSettings
from echocal.diagnose.settings.threshold import threshold
from echocal.observations.marks import RowRule, seconds
from echocal.observations.quantiles import MAD_TO_SD

__all__ = ["FAULT"]

Column = NDArray[np.float64]
Labels = NDArray[np.int64]

_BLOCKS = 400  # stretches that are enough for a quantile
_STEADY = 5  # rows of a constant offset from which on it is a step: where onsets are tried
_AFTER = 13  # rows whose median a stretch is compared with, at least
_TIME_CONSTANTS = (
    60  # tried for an exponential approach: neighbors differ by 8 % where 1 % of the rows is off
)


@dataclass(frozen=True)
class Thresholds:
    """Numbers that decide about this fault."""

    fewest: int = threshold(3, "1", "rows from which on it is no lone outlier; judgement")
    part: float = threshold(0.1, "1", "largest part of the log that is its beginning; judgement")
    off: float = threshold(6.0, "1", "robust standard deviations from which on a row is off; judgement")
    usual: float = threshold(0.05, "1", "part of the other stretches that may be farther off; judgement")
    tail: float = threshold(
        3.0, "1", "exponent of the tail beyond them: that of Student's t with 3 degrees; judgement"
    )
    described: float = threshold(
        0.25, "1", "part of the deviation that a law may leave in nine of ten rows; judgement"
    )


FACTS = CauseFacts(
    id="installation_transient",
    kind="row",
    sentence="The log begins before the installation is finished: somebody stands in the beam, or holds the "
    "sensor.",
    signature="the first rows are farther off than any other stretch of rows, by no law, and then it ends",
    source="five rows of an installation were fitted as a self-heating of 9.8 K, on a record of an installed "
    "sensor; a regulator beside a thermometer gives 0.5 to 3 K (general knowledge)",
    parameters=(
        Quantity("rows", "1", "rows until the end of the installation"),
        Quantity("duration", "s", "from the first row of the log to the first row after the installation"),
        Quantity("off", "m", "median deviation of the rows from those after them, without a sign"),
    ),
    check="the log book: when was the installation finished? Leave the rows before it out",
    prior=0.02,
    formula="reading' = anything, where s < duration, with s the time since the first row",
    needs=("elapsed_time",),
    repair="leaves out the rows up to the end of the installation",
)


@dataclass(frozen=True)
class _Beginning:
    """Rows before an end of the installation.

    Attributes
    ----------
    off, usual : float
        Deviation of these rows from those after them, and of other stretches of the log [m].
    """

    count: int
    log_bayes: float
    off: float
    usual: float


def detect(view: View, own: Thresholds, settings: FaultSettings) -> Found | None:
    """Look for a beginning that is farther off than any other part of the log."""
    time = view.observations.conditions["elapsed_time"]
    rows = np.flatnonzero(view.good & np.isfinite(time) & np.isfinite(view.deviation))
    rows = rows[np.argsort(time[rows], kind="stable")]
    if not len(rows) or _cut_off(view, time, float(time[rows[0]])):
        return None
    value = (view.deviation if view.known else view.indication)[rows]
    found = max(_ends(value, view.scatter, own), key=lambda one: one.log_bayes, default=None)
    if found is None:
        return None
    count, expected, since = found.count, view.expected[rows], time[rows] - time[rows[0]]
    if found.off < settings.far.part * np.median(np.abs(expected[count:])):  # a warm thermometer may do that
        return None
    if _lawful(value, since, expected, found, own) or _confounded(view, rows, count):
        return None
    first = np.isin(np.arange(len(view)), rows[:count])
    duration = float(since[count])
    because = (
        f"{listed(first)}, the first {_lasting(duration)} of the log, are {millimeters(found.off)} off the "
        f"rows after them (median), where {100 * (1 - own.usual):g} % of the other stretches of {count} rows "
        f"are at most {millimeters(found.usual)} off; left out"
    )
    sizes = (count, duration, found.off)
    return Found(first, found.log_bayes, because, sizes, rules=_rules(view, rows, count))


def _lasting(seconds: float) -> str:
    for size, unit in ((3600.0, "hours"), (60.0, "minutes")):
        if seconds >= 2 * size:
            return f"{seconds / size:.3g} {unit}"
    return f"{seconds:.3g} seconds"


def _cut_off(view: View, time: Column, begin: float) -> bool:
    """Whether the user leaves out rows before these: then they are not the beginning of the log."""
    outside = view.observations.unusable.astype(str) == OUTSIDE
    return bool(outside.any() and np.nanmin(np.where(outside, time, np.nan)) < begin)


def _ends(value: Column, scatter: float, own: Thresholds) -> Iterator[_Beginning]:
    """Ends of the installation that are more likely than none, from beginnings of more and more rows."""
    most, length = int(own.part * len(value)), own.fewest
    while length < most:
        length = min(2 * length, most)
        count = _last(value, length, scatter, own)
        off, usual, rank = (0.0, np.inf, 1.0) if count is None else _contrast(value, count, scatter, own)
        if count is not None and off > usual:
            log = float(own.tail * np.log(off / usual) - np.log(rank) - np.log(most))
            yield _Beginning(count, log, off, usual)


def _last(value: Column, length: int, scatter: float, own: Thresholds) -> int | None:
    """Where a wide distribution gives way to that of the rows after `length` rows: number of rows before.

    None where no row is off, or where it has not ended by then.
    """
    ahead = value[length : 2 * length + _AFTER]
    if len(ahead) < _AFTER:
        return None
    center = float(np.median(ahead))
    scale = max(MAD_TO_SD * float(np.median(np.abs(ahead - center))), scatter)
    unit = np.abs(value[:length] - center) / scale
    far = unit > own.off
    if far.sum() < own.fewest:
        return None
    wide = float(np.median(unit[far]))
    gain = _log_tailed(unit / wide, own.tail) - np.log(wide) - _log_tailed(unit, own.tail)
    count = int(np.cumsum(gain).argmax()) + 1
    most_off = far[:count].sum() >= max(own.fewest, 0.5 * count)
    return count if count < length and most_off else None


def _log_tailed(unit: Column, freedom: float) -> Column:
    """Log density of Student's t, without its constant."""
    return np.asarray(-0.5 * (freedom + 1) * np.log1p(unit**2 / freedom))


def _contrast(value: Column, count: int, scatter: float, own: Thresholds) -> tuple[float, float, float]:
    """How far the first stretch is from the rows after it, how far others are, and their rank as a part.

    These are the terms of docs/method/faults.md, Eq. 30a.
    """
    after = max(count, _AFTER)
    blocks = (len(value) - after) // count
    if blocks < 2:
        return 0.0, np.inf, 1.0
    firsts = np.arange(blocks)[:: -(-blocks // _BLOCKS)] * count
    inside = value[firsts[:, None] + np.arange(count)]
    level = np.median(value[firsts[:, None] + count + np.arange(after)], axis=1, keepdims=True)
    off = np.median(np.abs(inside - level), axis=1)
    others = np.sort(off[1:])
    place = 1 + int(own.usual * len(others))
    return float(off[0]), max(float(others[-place]), scatter), place / (len(others) + 1)


def _lawful(value: Column, since: Column, distance: Column, found: _Beginning, own: Thresholds) -> bool:
    """Whether a step or an exponential approach, with its time constant, describes the beginning.

    The approach is that of a mount [m], or that of a thermometer, in proportion to the distance.
    """
    span = min(4 * found.count, len(value))
    y, s, early = value[:span], since[:span], np.arange(span) < found.count
    shortest = 3.0 * float(np.median(np.diff(s)))  # that rows show
    constants = np.geomspace(shortest, s[-1], _TIME_CONSTANTS) if 0 < shortest < s[-1] else ()
    laws = [each * np.exp(-s / constant) for constant in constants for each in (1.0, distance[:span])]
    laws += [early.astype(np.float64)] if found.count > _STEADY else []
    least = max(2.0 * found.usual, own.described * found.off)
    for law in laws:
        basis = np.stack([np.ones(span), law], axis=1)
        left = y - basis @ np.linalg.lstsq(basis, y, rcond=None)[0]
        if np.quantile(np.abs(left[: 2 * found.count]), 0.9) <= least:
            return True
    return False


def _confounded(view: View, rows: Labels, count: int) -> bool:
    """Whether these rows have distances of their own: then a cause of the distance explains them, too."""
    if view.reference is None or view.given is not None:
        return False
    own, others = view.reference[rows[:count]], view.reference[rows[count:]]
    return bool(np.mean((own >= others.min()) & (own <= others.max())) < 0.5)


def _rules(view: View, rows: Labels, count: int) -> tuple[RowRule, ...]:
    """The period, where instants are recorded: the beginning of another log is another matter."""
    time = view.observations.time
    if time is None:
        return ()
    begin, end = seconds(time[rows[[0, count]]]).tolist()
    return (RowRule(reason=FACTS.id, kind="during", quantity="time", value=begin, tolerance=end - begin),)


def spoil(table: Columns, random: np.random.Generator) -> None:
    """Hear the installer, at any distance before the target, in the first three of a hundred rows."""
    count = max(3 * len(table["reading_m"]) // 100, 4)
    table["reading_m"][:count] *= random.uniform(0.2, 0.9, count)


FAULT = Fault(FACTS, detect, spoil, Thresholds())
