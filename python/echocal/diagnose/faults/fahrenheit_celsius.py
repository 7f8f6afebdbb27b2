"""Fahrenheit in a column of degrees Celsius."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from echocal.diagnose.faults.common.fault import Fault, Found
from echocal.diagnose.faults.common.repair import with_values
from echocal.diagnose.faults.common.values import at_power_on
from echocal.diagnose.findings.facts import CauseFacts, Columns, Quantity
from echocal.diagnose.findings.finding import listed
from echocal.diagnose.preprocess.usable import some
from echocal.diagnose.preprocess.view import View
from echocal.diagnose.settings.faults import FaultSettings
from echocal.diagnose.settings.threshold import threshold
from echocal.observations import Observations

__all__ = ["FAULT"]

Column = NDArray[np.float64]
Mask = NDArray[np.bool_]

_HALF_WINDOW = 3  # rows on each side that vouch for a row's temperature


@dataclass(frozen=True)
class Thresholds:
    """Numbers that decide about this fault."""

    usual: float = threshold(18.0, "degC", "center of the air that people measure in; judgement")
    spread: float = threshold(15.0, "K", "its spread; judgement")
    odd: float = threshold(8.0, "K", "deviation from the neighbors for a row to be an outlier; judgement")
    deviations: float = threshold(
        8.0, "1", "the same in robust standard deviations of the neighbors; judgement"
    )
    back: float = threshold(4.0, "K", "deviation from the neighbors once converted; judgement")
    back_deviations: float = threshold(
        5.0, "1", "the same in robust standard deviations of the neighbors; judgement"
    )
    hottest: float = threshold(
        45.0, "degC", "of air outdoors and in rooms: a column that stays colder is no surprise"
    )
    each: float = threshold(
        6.0,
        "1",
        "log Bayes factor of one outlier that fits its neighbors as Fahrenheit; judgement",
    )
    most: float = threshold(0.4, "1", "part of the rows that may be single outliers; judgement")
    cold: float = threshold(
        30.0, "1", "log Bayes factor against a whole column in Fahrenheit that air may have had; judgement"
    )


FACTS = CauseFacts(
    id="fahrenheit_celsius",
    kind="gross",
    sentence="Temperatures in degrees Fahrenheit are in a column of degrees Celsius, in all rows or some.",
    signature="T = 32 + 1.8 T_true: rows that jump, or a column that no air is as warm as",
    source="range check; CATALOGUE",
    parameters=(Quantity("rows", "1", "rows concerned"),),
    check="read a thermometer beside the logger",
    prior=0.01,
    formula="T' = 32 + 1.8 T, in all rows or in some",
    needs=("temperature",),
    repair="converts the rows to degrees Celsius",
)


def celsius(fahrenheit: Column) -> Column:
    """Convert."""
    return (fahrenheit - 32.0) / 1.8


def detect(view: View, own: Thresholds, _: FaultSettings) -> Found | None:
    """Ask whether all rows, or outliers, make sense as Fahrenheit."""
    recorded = view.observations.conditions["temperature"]
    known = np.isfinite(recorded)
    if (known & ~at_power_on(recorded)).sum() < 5:
        return None
    rows = _single(recorded, known, own)
    evidence, why = own.each * float(rows.sum()), listed(rows)
    if not rows.any() or rows.mean() > own.most:
        if np.fmax.reduce(recorded) <= own.hottest and np.fmin.reduce(recorded) > -own.hottest:
            return None
        rows, why = known, "the whole column"
        evidence = _whole(recorded[known], own)
        if abs(np.median(celsius(recorded[known]))) > own.hottest:
            return None  # no air either way: kelvin, for example
        if evidence < 0.0 or _contradicted(view):
            return None
    low, high = (float(np.quantile(recorded[rows], q)) for q in (0.0, 1.0))
    because = (
        f"{why}: {low:.1f} .. {high:.1f} in a column of degC is, read as Fahrenheit, "
        f"{celsius(np.array(low)):.1f} .. {celsius(np.array(high)):.1f} degC, which fits the air"
        f"{'' if rows is known else ' of the rows around'}; the diagnosis goes on with these"
    )
    return Found(rows, evidence, because, (rows.sum(),), _converted(view, rows))


def _whole(recorded: Column, own: Thresholds) -> float:
    """Log Bayes factor of Fahrenheit against Celsius, by what air is like."""
    ends = np.quantile(recorded, [0.5, 0.98])

    def surprise(values: Column) -> float:
        return float(3.0 * np.log1p(((values - own.usual) / own.spread) ** 2 / 4).sum())

    return surprise(ends) - surprise(celsius(ends)) - (0.0 if ends[1] > own.hottest else own.cold)


def _contradicted(view: View) -> bool:
    """Whether recorded echo times are further from the reference with every row taken for Fahrenheit."""
    reference, good = view.reference, view.good
    if reference is None or view.observations.reading is not None or not good.any():
        return False  # a reading tells no air: the device knew it
    looks = (view, view.after(_converted(view, good)))
    as_it_is, converted = (np.median(np.abs(look.indication - reference)[good]) for look in looks)
    return bool(converted >= as_it_is)


def _single(recorded: Column, known: Mask, own: Thresholds) -> Mask:
    """Rows that deviate from their neighbors, and do not once converted."""
    rows = np.zeros(len(recorded), dtype=bool)
    at = np.flatnonzero(known & ~at_power_on(recorded))  # 85 degC is a reset, not 29.4 degC
    values = some(recorded, at)
    if _HALF_WINDOW * np.abs(np.diff(values)).max(initial=0.0) <= own.odd:
        return rows  # no row can be that far from its neighbors
    import pandas as pd  # takes long to import

    around = pd.Series(values).rolling(2 * _HALF_WINDOW + 1, center=True, min_periods=3).median().to_numpy()
    scatter = 1.4826 * float(np.median(np.abs(values - around)))
    limit = max(own.odd, own.deviations * scatter)
    off, off_converted = np.abs(values - around), np.abs(celsius(values) - around)
    near = max(own.back, own.back_deviations * scatter)
    rows[at] = (off > limit) & (off_converted < np.minimum(0.5 * off, near))
    return rows


def _converted(view: View, rows: Mask) -> Observations:
    recorded = view.observations.conditions["temperature"]
    return with_values(view, rows, FACTS.id, temperature=celsius(recorded))


def spoil(table: Columns, random: np.random.Generator) -> None:
    """Write some temperatures down in Fahrenheit."""
    rows = random.choice(len(table["temperature_C"]), 5, replace=False)
    table["temperature_C"][rows] = 32 + 1.8 * table["temperature_C"][rows]


FAULT = Fault(FACTS, detect, spoil, Thresholds())
