"""No echo: a constant in place of a time."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from echocal.diagnose.faults.common.constant import log_choices
from echocal.diagnose.faults.common.fault import Fault, Found
from echocal.diagnose.faults.common.one_value import one_value
from echocal.diagnose.faults.common.values import expected_everywhere, far, recorded
from echocal.diagnose.findings.facts import CauseFacts, Columns, Quantity
from echocal.diagnose.findings.finding import listed
from echocal.diagnose.preprocess.view import View
from echocal.diagnose.settings.faults import FaultSettings
from echocal.diagnose.settings.threshold import threshold
from echocal.observations.marks import RowRule
from echocal.time_outs import HC_SR04

__all__ = ["FAULT"]

Column = NDArray[np.float64]

_SAME = 1e-10  # relative; what arithmetic leaves of one constant


@dataclass(frozen=True)
class Thresholds:
    """Numbers that decide about this fault."""

    tolerance: float = threshold(
        5e-5, "s", "around the 38 ms of the data sheet: clones differ by tens of us; judgement"
    )
    reach: float = threshold(
        4.0,
        "m",
        "up to there things are about as probable, and beyond the echo is fainter: HC-SR04 data sheet",
    )
    another: float = threshold(
        0.25, "1", "part of the tables with echoes over a longer way in which one thing makes them; judgement"
    )
    twice: float = threshold(
        0.25, "1", "part of these tables in which it is the second round trip; judgement"
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
    found = one_value(view, far(view, settings.far) & (values > 0), values, settings, FACTS.id)
    if found is None:
        return -np.inf, np.empty(0, dtype=np.int64)
    place = float(np.median(view.indication[found.rows]))
    echo = float(np.median(view.observations.echo_time[found.rows]))
    known = _normal(echo / HC_SR04, own.tolerance / HC_SR04)
    among_good = settings.constant.among if place <= found.longest else 1.0
    here = float(np.log(0.5 * among_good / settings.constant.range + 0.5 * known))
    there = _log_of_a_place(place, float(np.median(found.expected)), settings, own)
    chosen = log_choices(len(found.rows), len(found.rows) + found.others)
    as_constant, as_echoes = (log - chosen for log in (found.as_constant + here, found.as_echoes + there))
    rivals = [found.as_wild, as_echoes, found.as_frozen]
    return float(as_constant - np.logaddexp.reduce(rivals)), found.rows


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
    table["reading_m"][rows] = 0.5 * speed * HC_SR04


FAULT = Fault(FACTS, detect, spoil, Thresholds())
