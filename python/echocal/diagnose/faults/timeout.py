"""No echo: a constant in place of a time."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from echocal.diagnose.faults.common.constant import finest, log_choices, log_constant
from echocal.diagnose.faults.common.fault import Fault, Found
from echocal.diagnose.faults.common.values import expected_everywhere, far, limit_of, recorded
from echocal.diagnose.findings.facts import CauseFacts, Columns, Quantity
from echocal.diagnose.findings.finding import listed
from echocal.diagnose.preprocess.view import View
from echocal.diagnose.settings.faults import FaultSettings
from echocal.diagnose.settings.threshold import threshold
from echocal.observations.marks import RowRule
from echocal.observations.quantiles import MAD_TO_SD

__all__ = ["FAULT"]

Column = NDArray[np.float64]

_SAME = 1e-10  # relative; what arithmetic leaves of one constant
_KNOWN = 38e-3  # s, length of the HC-SR04's pulse without an echo (data sheet)


@dataclass(frozen=True)
class Thresholds:
    """Numbers that decide about this fault."""

    tolerance: float = threshold(
        5e-5, "s", "around the 38 ms of the data sheet: clones differ by tens of us; judgement"
    )
    window: float = threshold(
        0.01, "1", "of the logarithm, in which the rows of one constant lie: twice the largest jitter"
    )
    reach: float = threshold(
        4.0,
        "m",
        "up to there things are about as probable, and beyond the echo is fainter: HC-SR04 data sheet",
    )
    another: float = threshold(
        0.25, "1", "part of the tables with echoes over a longer way in which one thing makes them; judgement"
    )
    scatter: float = threshold(
        1.5, "1", "standard deviation of the log scatter of its echoes: they vary four times as much or less"
    )
    twice: float = threshold(
        0.25, "1", "part of these tables in which it is the second round trip; judgement"
    )
    among: float = threshold(
        0.05,
        "1",
        "prior of a constant that is not longer than every good reading, over that of others; judgement",
    )
    impossible: float = threshold(
        8.0, "1", "log Bayes factor of a row that repeats a value which no echo has; judgement"
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


def detect(view: View, own: Thresholds, settings: FaultSettings) -> Found | None:
    """Compare one constant with rows that lie anywhere, and with another thing's echoes."""
    times, readings = view.observations.echo_time, recorded(view)
    found = [_constant(view, values, settings, own) for values in (times, readings)]
    found.append(_impossible(view, own))
    evidence, rows = max(found, key=lambda one: one[0])
    if not len(rows):
        return None
    mask = np.zeros(len(view), dtype=bool)
    mask[rows] = True
    time, expected = float(np.median(times[rows])), float(expected_everywhere(view)[rows[0]])
    because = (
        f"{listed(mask)}: an echo time of {1e3 * time:.3f} ms ({view.indication[rows[0]]:.2f} m) again and "
        f"again, where {expected:.2f} m is expected; left out"
    )
    repaired = view.without(mask, FACTS.id, anyhow=True)
    return Found(mask, evidence, because, (time, len(rows)), repaired, _rules(view, rows, own))


def _constant(
    view: View, values: Column, settings: FaultSettings, own: Thresholds
) -> tuple[float, NDArray[np.int64]]:
    """The most far rows with about one value, and their evidence: docs/method/faults.md, Eq. 31b."""
    outliers = np.flatnonzero(far(view, settings.far) & (values > 0))
    if not len(outliers):
        return -np.inf, outliers
    logs = np.log(np.where(values > 0, values, np.nan))
    ordered = np.sort(logs[outliers])
    ends = np.searchsorted(ordered, ordered + own.window, side="right")
    first = int((ends - np.arange(len(ordered))).argmax())
    inside = view.good & (np.abs(logs - np.median(ordered[first : ends[first]])) <= own.window)
    rest = view.after(view.without(inside, FACTS.id))
    if not rest.good.any():
        return -np.inf, outliers[:0]
    expected = view.expected if view.known else expected_everywhere(rest)
    limit = limit_of(rest.scatter, expected, settings.far)
    rows = np.flatnonzero(inside & (np.abs(view.indication - expected) > limit))
    if not len(rows):
        return -np.inf, rows
    place, least = view.indication[rows], finest(view.indication[rows], view.resolution)
    off = np.abs(place - expected[rows])
    chosen = log_choices(len(rows), len(rows) + int(far(rest, settings.far).sum()))
    echo = float(np.median(view.observations.echo_time[rows]))
    known = _normal(echo / _KNOWN, own.tolerance / _KNOWN)
    good = rest.indication[rest.good]
    among_good = own.among if np.median(place) <= good.max() else 1.0
    here = float(np.log(0.5 * among_good / settings.constant.range + 0.5 * known))
    slow = 0.0 if view.known else MAD_TO_SD * float(np.median(np.abs(good - np.median(good))))
    half = 0.5 * float(np.log(max(slow / rest.scatter, 1.0)))  # of the way from scatter to slow changes
    jitter = rest.scatter * np.exp(half) / float(np.median(place)), float(np.hypot(own.scatter, half))
    there = _log_of_a_place(float(np.median(place)), float(np.median(expected[rows])), settings, own)
    orders = np.maximum(np.log(off / limit[rows]), 1.0)
    wild = np.log(0.5 / settings.constant.range + 0.5 * place / (2 * off * orders)).sum()
    as_constant = log_constant(values[rows], least, settings.constant) + here - chosen
    as_echoes = log_constant(values[rows], least, settings.constant, jitter) + there - chosen
    return float(as_constant - np.logaddexp(wild, as_echoes)), rows


def _log_of_a_place(place: float, expected: float, settings: FaultSettings, own: Thresholds) -> float:
    """Log prior density of the log distance of another thing, or of the second round trip."""
    fainter = min(1.0, (own.reach / place) ** 4)
    twice = _normal(place / expected / 2, settings.factor.spread)
    there = (1 - own.twice) * 0.75 * place / own.reach * fainter + own.twice * twice
    return float(np.log(settings.outliers.usual * own.another * there))


def _normal(ratio: float, spread: float) -> float:
    """Density of a log ratio around zero."""
    return float(np.exp(-0.5 * (np.log(ratio) / spread) ** 2) / (spread * np.sqrt(2 * np.pi)))


def _impossible(view: View, own: Thresholds) -> tuple[float, NDArray[np.int64]]:
    """Rows that repeat a value which no echo has, as 0, -1 or 9999."""
    values, data = recorded(view), view.observations
    names = [f"{data.source_names.get(name, name)} out of range" for name in ("reading", "echo_time")]
    rows = np.flatnonzero(np.isin(data.unusable.astype(str), names) & np.isfinite(values))
    if not len(rows):
        return -np.inf, rows
    each, counts = np.unique(values[rows], return_counts=True)
    value, count = each[counts.argmax()], int(counts.max())
    # one value may be wild, but none is the length of a way back
    return own.impossible * (count - (value > 0)), rows[values[rows] == value]


def _rules(view: View, rows: NDArray[np.int64], own: Thresholds) -> tuple[RowRule, ...]:
    """The constant, as a time or as a reading; as both, where one temperature does not tell them apart."""
    times, readings = view.observations.echo_time[rows], recorded(view)[rows]
    time, reading = float(np.median(times)), float(np.median(readings))
    one_time, one_reading = np.ptp(times) <= _SAME * abs(time), np.ptp(readings) <= _SAME * abs(reading)
    of_reading = RowRule(reason=FACTS.id, kind="equals", quantity="reading", value=reading)
    if one_reading and not one_time:
        return (of_reading,)
    tolerance = 0.0 if one_time else max(own.tolerance, float(np.abs(times - time).max()))
    of_time = RowRule(reason=FACTS.id, kind="equals", quantity="echo_time", value=time, tolerance=tolerance)
    recorded_both = one_reading and view.observations.reading is not None
    return (of_time, of_reading) if recorded_both else (of_time,)


def spoil(table: Columns, random: np.random.Generator) -> None:
    """Report 38 ms in rows without an echo."""
    rows = random.choice(len(table["reading_m"]), 5, replace=False)
    speed = 331.4 + 0.6 * table["temperature_C"][rows]
    table["reading_m"][rows] = 0.5 * speed * _KNOWN


FAULT = Fault(FACTS, detect, spoil, Thresholds())
