"""Conditions that a table has no column for, stated by the user."""

import re
from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np
import pandas as pd

from echocal.errors import UsageError, among
from echocal.keywords import keyword
from echocal.model import Model
from echocal.observations.echoes import DEFAULT_SPEED
from echocal.observations.names import by_name
from echocal.observations.table import Observations
from echocal.observations.units import NAMES
from echocal.quantities import QUANTITIES

ALSO = {"temperature": "temperature_C", "humidity": "humidity_percent", "pressure": "pressure_hPa"}
"""Names without a unit: degC, percent, hPa."""

_VALUE = re.compile(r"\s*(?P<value>[-+]?\d*\.?\d+)\s*(?:(?:\+-|\+/-|±)\s*(?P<u>\d*\.?\d+))?\s*")
_PER_KELVIN = 0.5 / 293.15
"""Part of a distance that a kelvin makes: half of its part of the absolute temperature."""


def parsed(texts: Mapping[str, Any]) -> dict[str, tuple[str, float, float]]:
    """Column, value and standard uncertainty by quantity, in the unit of the column.

    Raises `UsageError` if a name is none of a condition, or a value no number.

    Examples
    --------
    >>> parsed({"temperature": "20+-2"})
    {'temperature': ('temperature_C', 20.0, 2.0)}
    """
    found = {}
    for name, given in texts.items():
        column = ALSO.get(name, name)
        if column not in NAMES or NAMES[column][0].quantity not in QUANTITIES:
            known = [*ALSO, *(own for own, (form, _) in NAMES.items() if form.quantity in QUANTITIES)]
            raise UsageError(
                f"{keyword('at', {name: given})}: no such condition{among(name, known, 'there are')}"
            )
        match = _VALUE.fullmatch(str(given))
        if match is None:
            raise UsageError(
                f"{keyword('at', {name: given})}: not a number; give a value, or with its uncertainty: 20+-2"
            )
        found[NAMES[column][0].quantity] = (column, float(match["value"]), float(match["u"] or 0.0))
    return found


def conditions_at(given: Mapping[str, Any] | None, table: pd.DataFrame) -> dict[str, tuple[float, float]]:
    """Add a column for each stated condition; values and standard uncertainties [SI] by quantity.

    Raises `UsageError` if the table has a column of this condition.
    """
    stated = {}
    for quantity, (column, value, uncertainty) in parsed(given or {}).items():
        form, symbol = NAMES[column]
        for name in table.columns:
            if name in NAMES and (found := by_name(name)) and found[0].quantity == quantity:
                one = keyword("at", {quantity: value})
                raise UsageError(f"{one}: the table has it in column '{name}'; leave one out")
        low, high = form.physical
        unit = form.units[symbol]
        if not low <= unit.to_si(value) <= high:
            raise UsageError(
                f"{keyword('at', {quantity: value})} is outside of {unit.from_si(low):g} to "
                f"{unit.from_si(high):g}"
            )
        table[column] = value
        stated[quantity] = (unit.to_si(value), unit.to_si(value + uncertainty) - unit.to_si(value))
    return stated


def uncertainties_of(texts: Mapping[str, Any]) -> dict[str, float]:
    """Standard uncertainty [SI] of each stated condition that has one, by quantity."""
    found = {}
    for quantity, (column, _, uncertainty) in parsed(texts).items():
        form, symbol = NAMES[column]
        if uncertainty:
            found[quantity] = uncertainty * form.units[symbol].numerator / form.units[symbol].denominator
    return found


def sentences(stated: Mapping[str, tuple[float, float]]) -> list[str]:
    """What a result must say of conditions that nobody recorded."""
    said = []
    for quantity, (value, uncertainty) in stated.items():
        known = QUANTITIES[quantity].shown
        spread = f" +- {uncertainty * known.factor:g}" if uncertainty else ""
        more = "" if uncertainty else ", no uncertainty given"
        if uncertainty and quantity == "temperature":
            more = f"; this leaves {_PER_KELVIN * uncertainty:.2%} of each distance open"
        shown = f"{value * known.factor:g}{spread} {known.unit}".rstrip()
        said.append(f"the {quantity.replace('_', ' ')} is stated for all rows, not recorded: {shown}{more}")
    return said


def uncertain(observations: Observations) -> dict[str, float]:
    """Standard uncertainty [SI] of the conditions that are stated with one."""
    return {name: u for name, (_, u) in observations.stated.items() if u > 0.0}


def shifted(observations: Observations, quantity: str, step: float) -> Observations:
    """The observations if a stated condition were higher by a step [SI].

    Readings that a firmware made with this condition become other echo times.
    """
    value, _ = observations.stated[quantity]
    conditions = {**observations.conditions, quantity: observations.conditions[quantity] + step}
    changed = replace(
        observations,
        conditions=conditions,
        stated={**observations.stated, quantity: (value + step, 0.0)},
        notes=(),
    )
    reading = observations.reading
    if reading is None or "echo_time" in observations.source_names:
        return changed
    firmware = Model(observations.reading_speed or DEFAULT_SPEED)
    given: Mapping[str, np.ndarray | float] = {n: v for n, v in conditions.items() if n in firmware.reads}
    return replace(changed, echo_time=firmware.time_of_flight(reading, **(given or {"temperature": 0.0})))
