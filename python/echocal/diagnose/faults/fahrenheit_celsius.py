"""Fahrenheit in a column of degrees Celsius, or the other way round."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.special import binom

from echocal.diagnose.faults.common.fault import Fault, Found
from echocal.diagnose.faults.common.likelihood import by_echoes
from echocal.diagnose.faults.common.repair import with_values
from echocal.diagnose.faults.common.values import at_power_on
from echocal.diagnose.findings.facts import CauseFacts, Columns, Quantity
from echocal.diagnose.findings.finding import listed
from echocal.diagnose.preprocess.usable import some
from echocal.diagnose.preprocess.view import View
from echocal.diagnose.settings.faults import FaultSettings
from echocal.diagnose.settings.threshold import threshold
from echocal.keywords import keyword
from echocal.observations.quantiles import MAD_TO_SD
from echocal.observations.units import split_unit, symbol_of

__all__ = ["FAULT"]

Column = NDArray[np.float64]
Mask = NDArray[np.bool_]
Conversion = Callable[[Column], Column]

_FEWEST = 5  # rows with a temperature
_HALF_WINDOW = 3  # rows on each side that vouch for a row's temperature


@dataclass(frozen=True)
class Thresholds:
    """Numbers that decide about this fault."""

    usual: float = threshold(18.0, "degC", "center of the air that people measure in; judgement")
    spread: float = threshold(15.0, "K", "its spread; judgement")
    back: float = threshold(4.0, "K", "two standard deviations from the neighbors, at least; judgement")
    hottest: float = threshold(
        45.0, "degC", "of air outdoors and in rooms: a column that stays colder is no surprise"
    )
    each: float = threshold(
        6.0,
        "1",
        "least log likelihood ratio of a row that fits its neighbors as Fahrenheit; judgement",
    )


FACTS = CauseFacts(
    id="fahrenheit_celsius",
    kind="gross",
    sentence="Temperatures in degrees Fahrenheit are in a column of degrees Celsius, in all rows or some; or "
    "those in degrees Celsius are in a column that is called Fahrenheit.",
    signature="T = 32 + 1.8 T_true: rows that jump, or a column that no air is as warm as; or the reverse",
    source="range check; CATALOGUE",
    parameters=(Quantity("rows", "1", "rows concerned"),),
    check="read a thermometer beside the logger",
    prior=0.01,
    formula="T' = 32 + 1.8 T, in all rows or in some; or T = 32 + 1.8 T'",
    needs=("temperature",),
    repair="converts the rows to degrees Celsius",
)


def celsius(fahrenheit: Column) -> Column:
    """Convert."""
    return (fahrenheit - 32.0) / 1.8


def written(read: Column) -> Column:
    """Values of a column that is called Fahrenheit, as they stand in it."""
    return 32.0 + 1.8 * read


def detect(view: View, own: Thresholds, settings: FaultSettings) -> Found | None:
    """Ask whether outliers, or else all rows, make sense as Fahrenheit."""
    recorded = view.observations.conditions["temperature"]
    known = np.isfinite(recorded)
    if (known & ~at_power_on(recorded)).sum() < _FEWEST:
        return None
    column = view.observations.source_names.get("temperature", "")
    if symbol_of(split_unit(column)[1]) == "F":
        return _found(view, known, _whole(recorded[known], written, own), written, settings)
    rows, evidence = _single(recorded, known, own)
    if not rows.any():
        if np.fmax.reduce(recorded) <= own.hottest or abs(np.nanmedian(celsius(recorded))) > own.hottest:
            return None  # no surprise; or no air either way: kelvin, for example
        rows, evidence = known, _whole(recorded[known], celsius, own)
    return _found(view, rows, evidence, celsius, settings)


def _found(view: View, rows: Mask, evidence: float, convert: Conversion, settings: FaultSettings) -> Found:
    """Say what the rows are, once converted."""
    recorded = view.observations.conditions["temperature"]
    repaired = with_values(view, rows, FACTS.id, temperature=convert(recorded))
    evidence = min(evidence, settings.cap) + by_echoes(view, repaired, rows)  # echoes outweigh any neighbors
    ends = np.array([recorded[rows].min(), recorded[rows].max()])
    (low, high), (air_low, air_high) = written(ends) if convert is written else ends, convert(ends)
    held, read = ("degF", "degrees Celsius") if convert is written else ("degC", "Fahrenheit")
    all_rows = rows.sum() == np.isfinite(recorded).sum()
    because = (
        f"{'the whole column' if all_rows else listed(rows)}: {low:.1f} .. {high:.1f} in a column of {held} "
        f"is, read as {read}, {air_low:.1f} .. {air_high:.1f} degC, which fits the air"
        f"{'' if all_rows else ' of the rows around'}; the diagnosis goes on with these"
    )
    if all_rows:
        name = view.observations.source_names.get("temperature", "temperature")
        right = {name: "temperature_C" if convert is written else "temperature_F"}
        because += f", and a correction reads them so with {keyword('columns', right)}"
    return Found(rows, evidence, because, (rows.sum(),), repaired)


def _whole(recorded: Column, convert: Conversion, own: Thresholds) -> float:
    """Log Bayes factor of the other unit for all rows, by what air is like."""
    ends = np.quantile(recorded, [0.5, 0.98])
    as_it_is, converted = (
        3.0 * np.log1p(((values - own.usual) / own.spread) ** 2 / 4).sum() for values in (ends, convert(ends))
    )
    return float(as_it_is - converted)


def _single(recorded: Column, known: Mask, own: Thresholds) -> tuple[Mask, float]:
    """Rows that their neighbors make more probable once converted, and the log Bayes factor of them all.

    Neighbors scatter, or are in any order. Any rows could have been these.
    """
    rows = np.zeros(len(recorded), dtype=bool)
    at = np.flatnonzero(known & ~at_power_on(recorded))  # 85 degC is a reset, not 29.4 degC
    values = some(recorded, at)
    if _HALF_WINDOW * np.abs(np.diff(values)).max(initial=0.0) <= own.back:
        return rows, 0.0  # no row can be that far from its neighbors
    import pandas as pd  # takes long to import

    around = pd.Series(values).rolling(2 * _HALF_WINDOW + 1, center=True, min_periods=3).median().to_numpy()
    off, off_converted = np.abs(values - around), np.abs(celsius(values) - around)
    near = max(own.back, 2 * MAD_TO_SD * float(np.median(off)))  # two standard deviations
    evidence = 2.0 * (off**2 - off_converted**2) / near**2
    found = (off_converted < near) & (evidence > own.each)
    rows[at] = found
    return rows, float(evidence[found].sum() - np.log(binom(len(at), found.sum())))


def spoil(table: Columns, random: np.random.Generator) -> None:
    """Write some temperatures down in Fahrenheit."""
    rows = random.choice(len(table["temperature_C"]), 5, replace=False)
    table["temperature_C"][rows] = 32 + 1.8 * table["temperature_C"][rows]


FAULT = Fault(FACTS, detect, spoil, Thresholds())
