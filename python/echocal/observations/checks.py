"""What values can physically be: single impossible rows, and columns in another unit."""

from __future__ import annotations

from collections.abc import Collection
from typing import Any

import numpy as np
import pandas as pd

from echocal.arrays import Column, Mask
from echocal.errors import DataError
from echocal.keywords import keyword
from echocal.observations.fields import row, rows
from echocal.observations.plan import EVERYTHING, Assignment
from echocal.observations.quantiles import median as middle
from echocal.observations.table import Observations
from echocal.observations.units import FORMS, NAMES
from echocal.quantities import QUANTITIES, Form, Unit

CODES = (-9999.0, -999.0, 999.0, 9999.0, 32767.0, 65535.0, 99999.0)
_REPEATED = 0.5  # of the rows: a value that is no measurement

Ends = tuple[float, float]


def refuse_without_values(values: Column, source: Assignment, trusted: Collection[str]) -> None:
    """Refuse a column that would make every row unusable; but a diagnosis names a dead sensor.

    Raises `DataError` if no row has a value.
    """
    column = source.column
    if EVERYTHING in trusted and source.form.quantity in QUANTITIES and len(values):
        return
    if not len(values) or (np.isnan(values[0]) and np.isnan(values).all()):
        raise DataError(
            f"column '{column}' has no value in any of {len(values)} rows; "
            f"if it is not needed: {keyword('columns', {column: 'ignore'})}"
        )


def refuse_truth(values: pd.Series[Any], assignment: Assignment) -> None:
    """Refuse true and false where a quantity is measured.

    Raises `DataError` if the column holds truth values.
    """
    if pd.api.types.is_bool_dtype(values):
        column, what = assignment.column, assignment.form.role.replace("_", " ")
        raise DataError(
            f"column '{column}' holds true and false, and a {what} is a number; "
            f"if it is something else: {keyword('columns', {column: 'extra'})} (or "
            f"{keyword('columns', {column: 'ignore'})})"
        )


def refuse_other_unit(values: Column, seen: Ends, assignment: Assignment, trusted: Collection[str]) -> None:
    """Refuse a column that is in another unit than its name says, by the look of its median.

    `seen` are the `ends` of the values; columns that are trusted are right by the user's word. Raises
    `DataError` if the median cannot be, or is ordinary only in another unit.
    """
    column, form, unit = assignment.column, assignment.form, assignment.unit
    usual = form.typical or form.physical
    if all(_within(unit, end, usual) for end in seen):
        return  # and so is their median
    finite = np.isfinite(values)
    known = values if finite.all() else values[finite]
    if form.label or column in trusted or EVERYTHING in trusted or not known.any():
        return
    wrong = impossible(known, seen, assignment)[0]  # single impossible rows are another matter
    possible = known[~wrong] if wrong.any() else known
    median = middle(possible if 2 * len(possible) >= len(known) else known)
    if _within(unit, median, usual):
        return
    others = _ordinary_as(median, form)
    if not others and _within(unit, median, form.physical):
        return  # unusual, and no other unit makes it usual
    if not others:
        low, high = sorted(unit.from_si(bound) for bound in form.physical)
        code = median in CODES or bool(np.mean(known == median) > _REPEATED)
        advice = (
            f"an error code? {keyword('missing', {column: median})}"
            if code
            else f"values in another unit, or in tenths, must be converted before; without it: "
            f"{keyword('columns', {column: 'ignore'})}"
        )
        raise DataError(
            f"column '{column}' has a median of {median:g}, outside {low:g} .. {high:g}; {advice}"
        )
    said = {assignment.name: unit.to_si(median), **others}
    symbol = {"echo_time": "s", "reading": "m", "reference_distance": "m"}.get(form.quantity)
    symbol = QUANTITIES[form.quantity].unit if symbol is None else symbol
    read_as = ", ".join(f"as {name} {value:.4g} {symbol}".removesuffix(" 1") for name, value in said.items())
    raise DataError(
        f"column '{column}' has a median of {median:g}: {read_as}. "
        f"Say which it is: {keyword('columns', {column: next(iter(others))})} (or rename it), "
        f"or if it is right as it stands: {keyword('trust', [column])}"
    )


def still_refused(observations: Observations) -> str:
    """Why the first column is refused that looked as if in another unit, and does so after a repair.

    Empty where a repair explains each of them.
    """
    repaired = {
        **observations.conditions,
        "echo_time": observations.echo_time,
        "reading": observations.reading,
        "reference_distance": observations.reference_distance,
    }
    for quantity, why in observations.refused.items():
        if quantity == "elapsed_time":
            return why  # no repair changes a clock
        column = repaired.get(quantity)
        if column is None:
            continue  # the repair left it out
        form = next(form for form in FORMS if form.quantity == quantity)
        low, high = form.typical or form.physical
        known = column[observations.usable & np.isfinite(column)]
        if len(known) and not low <= middle(known) <= high:
            return why
    return ""


def impossible(values: Column, seen: Ends, assignment: Assignment) -> tuple[Mask, list[str]]:
    """Rows whose value cannot be, and a sentence on each kind of them.

    Values are in the unit that the column's name says; `seen` are their `ends`.
    """
    form = assignment.form
    low, high = sorted(assignment.unit.from_si(bound) for bound in form.physical)
    least, most = seen
    open_below, open_above = form.positive and not form.level, form.positive and form.level
    if (least > low if open_below else least >= low) and (most < high if open_above else most <= high):
        return np.zeros(len(values), dtype=np.bool_), []
    with np.errstate(invalid="ignore"):
        below = values <= low if open_below else values < low
        above = values >= high if open_above else values > high
    kinds = [
        (below, "at or below" if open_below else "below", low),
        (above, "at or above" if open_above else "above", high),
    ]
    column = assignment.column
    notes = [_count(values, mask, column, f"{word} {bound:g}") for mask, word, bound in kinds if mask.any()]
    return np.asarray(below | above, dtype=np.bool_), notes


def suspected_codes(values: Column, seen: Ends, assignment: Assignment) -> list[str]:
    """A sentence on each value that loggers write where they have none.

    A single one between others is a value like any other.
    """
    codes = (*assignment.form.error_codes.get(assignment.unit_name, ()), *CODES)
    least, most = seen
    found = {code: int((values == code).sum()) for code in codes if least <= code <= most}
    column = assignment.column
    return [
        f"{column} holds {code:g} in {rows(count)}; if it is an error code: "
        f"{keyword('missing', {column: code})}"
        for code, count in found.items()
        if count and not assignment.form.label and not (count == 1 and least < code < most)
    ]


def ends(values: Column) -> Ends:
    """Least and largest of the values that are known; most tables need no closer look."""
    if not len(values):
        return np.nan, np.nan
    least, most = float(values.min()), float(values.max())  # several times as fast as fmin and fmax
    if least == least:
        return least, most
    return float(np.fmin.reduce(values)), float(np.fmax.reduce(values))


def _count(values: Column, mask: Mask, column: str, where: str) -> str:
    first = int(np.flatnonzero(mask)[0])
    number = int(mask.sum())
    noun = "value" if number == 1 else "values"
    return f"{column} has {number} {noun} {where}, first at {row(first)}: {float(values[first])}"


def _ordinary_as(median: float, form: Form) -> dict[str, float]:
    """Names of other units that make a median ordinary, with its SI value."""
    found: dict[str, float] = {}
    for name in (*form.names, *form.also):
        other, unit = NAMES[name]
        other = form if name in form.names else other  # whose units count down from the mount height
        value = other.units[unit].to_si(median)
        low, high = other.typical or other.physical
        if low <= value <= high and value not in found.values():
            found[name] = value
    return found


def _within(unit: Unit, value: float, bounds: tuple[float, float]) -> bool:
    return bounds[0] <= unit.to_si(value) <= bounds[1]
