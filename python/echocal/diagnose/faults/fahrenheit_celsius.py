"""Fahrenheit in a column of degrees Celsius."""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from echocal.diagnose.findings.facts import CauseFacts, Quantity
from echocal.diagnose.findings.finding import Finding, listed
from echocal.diagnose.findings.parts import Parameter
from echocal.diagnose.preprocess.scene import some
from echocal.diagnose.preprocess.view import View
from echocal.observations import Observations

__all__ = ["FACTS", "detect"]

Column = NDArray[np.float64]
Mask = NDArray[np.bool_]

_HABIT = (18.0, 15.0)  # degC: center and spread of air that people measure in
_HALF_WINDOW = 3  # rows on each side that vouch for a row's temperature
_ODD = 8.0  # K, and more than the neighbors scatter, for a row to stand out
_HOTTEST = 45.0  # degC, of air; of colder ones nothing could be surprising enough
_EVERY_ROW = 6.0  # log Bayes factor of one row that stands out and fits its neighbors as Fahrenheit

FACTS = CauseFacts(
    id="fahrenheit_celsius",
    kind="gross",
    sentence="Temperatures in degrees Fahrenheit stand in a column of degrees Celsius, in all rows or some.",
    signature="T = 32 + 1.8 T_true: rows that jump, or a column that no air is as warm as",
    source="range check; CATALOGUE",
    parameters=(Quantity("rows", "1", "rows concerned"),),
    check="read a thermometer beside the logger",
    prior=0.01,
)


def celsius(fahrenheit: Column) -> Column:
    """Convert."""
    return (fahrenheit - 32.0) / 1.8


def detect(view: View) -> Finding | None:
    """Ask whether all rows, or rows that stand out, make sense as Fahrenheit."""
    recorded = view.temperature
    if recorded is None:
        return None
    known = np.isfinite(recorded)
    if known.sum() < 5:
        return None
    rows = _single(recorded, known)
    evidence, why = min(_EVERY_ROW * float(rows.sum()), 60.0), listed(rows)
    if not rows.any() or rows.mean() > 0.4:
        if np.fmax.reduce(recorded) <= _HOTTEST and np.fmin.reduce(recorded) > -_HOTTEST:
            return None
        rows, why = known, "the whole column"
        evidence = _whole(recorded[known])
        if evidence < 0.0 or _contradicted(view):
            return None
    low, high = (float(np.quantile(recorded[rows], q)) for q in (0.0, 1.0))
    because = (
        f"{why}: {low:.1f} .. {high:.1f} in a column of degC is, read as Fahrenheit, "
        f"{celsius(np.array(low)):.1f} .. {celsius(np.array(high)):.1f} degC, which fits the air"
        f"{'' if rows is known else ' of the rows around'}; the diagnosis goes on with these"
    )
    return Finding(
        FACTS,
        float(evidence),
        because,
        (Parameter("rows", float(rows.sum()), 0.0, "1"),),
        rows,
        _converted(view, rows),
    )


def _whole(recorded: Column) -> float:
    """Log Bayes factor of Fahrenheit against Celsius, by what air is like."""
    center, spread = _HABIT
    ends = np.quantile(recorded, [0.5, 0.98])

    def surprise(values: Column) -> float:
        return float(3.0 * np.log1p(((values - center) / spread) ** 2 / 4).sum())

    return surprise(ends) - surprise(celsius(ends)) - (0.0 if ends[1] > _HOTTEST else 30.0)


def _contradicted(view: View) -> bool:
    """Whether recorded echo times are further from the reference with every row taken for Fahrenheit."""
    reference, good = view.reference, view.good
    if reference is None or view.observations.reading is not None or not good.any():
        return False  # a reading tells no air: the device knew it
    looks = (view, view.after(_converted(view, good)))
    as_it_is, converted = (np.median(np.abs(look.indication - reference)[good]) for look in looks)
    return bool(converted >= as_it_is)


def _single(recorded: Column, known: Mask) -> Mask:
    """Rows that stand out from their neighbors, and do not once converted."""
    rows = np.zeros(len(recorded), dtype=bool)
    at = np.flatnonzero(known)
    values = some(recorded, at)
    if _HALF_WINDOW * np.abs(np.diff(values)).max(initial=0.0) <= _ODD:
        return rows  # no row can be that far from its neighbors
    import pandas as pd  # takes long to import

    around = pd.Series(values).rolling(2 * _HALF_WINDOW + 1, center=True, min_periods=3).median().to_numpy()
    scatter = 1.4826 * float(np.median(np.abs(values - around)))
    limit = max(_ODD, 8 * scatter)
    off, off_converted = np.abs(values - around), np.abs(celsius(values) - around)
    rows[at] = (off > limit) & (off_converted < np.minimum(0.5 * off, max(4.0, 5 * scatter)))
    return rows


def _converted(view: View, rows: Mask) -> Observations:
    observations = view.observations
    recorded = observations.conditions["temperature"]
    temperature = np.where(rows, celsius(recorded), recorded)
    unusable = observations.unusable.astype(object)
    name = observations.source_names.get("temperature", "temperature_C")
    unusable[rows & (unusable == f"{name} out of range")] = ""
    echo_time = observations.echo_time
    if observations.reading is not None:  # the device knew its air; its reading stands
        speed = view.base.indication(np.full(len(view), 2.0), {**observations.conditions})
        right = view.base.indication(
            np.full(len(view), 2.0), {**observations.conditions, "temperature": temperature}
        )
        echo_time = np.where(rows, echo_time * speed / right, echo_time)
    return replace(
        observations,
        echo_time=echo_time,
        conditions={**observations.conditions, "temperature": temperature},
        unusable=unusable.astype(str),
    )
