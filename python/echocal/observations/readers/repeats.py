"""The same quantity in two units, or with fewer digits: ``Distance (cm)`` beside ``Distance (in)``."""

from dataclasses import replace
from itertools import combinations

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from echocal.errors import DataError
from echocal.observations.alike import is_set, resolution
from echocal.observations.found import Found
from echocal.observations.hints import hint, role_of
from echocal.observations.names import EXTRA, by_name
from echocal.observations.units import NAMES

__all__ = ["step"]

Column = NDArray[np.float64]


def step(table: pd.DataFrame, found: Found) -> tuple[pd.DataFrame, Found]:
    """Leave the one with the coarser steps aside, where two are the same within their rounding."""
    held: dict[str, list[tuple[str, str]]] = {}
    for name in map(str, table.columns):
        said = _said(name, found)
        if said and pd.api.types.is_numeric_dtype(table[name]):
            held.setdefault(NAMES[said][0].quantity, []).append((name, said))
    requests, notes = dict(found.requests), list(found.notes)
    for pairs in held.values():
        for first, second in combinations(pairs, 2):
            coarser = _coarser(table, first, second) if {first[0], second[0]}.isdisjoint(requests) else None
            if coarser is not None:
                other = second if coarser == first else first
                requests[coarser[0]] = EXTRA
                notes.append(f"'{coarser[0]}' is '{other[0]}' within its rounding, and is left aside")
    return table, replace(found, requests=requests, notes=tuple(notes))


def _said(name: str, found: Found) -> str:
    """Which quantity a column holds by its name, in echocal's way; empty for none."""
    try:
        ours = by_name(name)
    except DataError:
        ours = None
    if ours is None:
        said = hint(name, found.units.get(name, ""))
        return "" if said is None or said.name not in NAMES else said.name
    form, unit = ours
    return (
        ""
        if form.label or form.several or form.quantity == "elapsed_time"
        else f"{form.role}_{unit}"
        if unit
        else form.role
    )


def _coarser(table: pd.DataFrame, first: tuple[str, str], second: tuple[str, str]) -> tuple[str, str] | None:
    """Which of two columns has fewer digits, if both are the same in each row; None where they are not."""
    if role_of(first[0]) != role_of(second[0]):
        return None  # a ruler and a ranger
    values, digits, fixed = [], [], []
    for name, said in (first, second):
        form, unit = NAMES[said]
        numbers = table[name].to_numpy(dtype=np.float64, na_value=np.nan)
        values.append(np.asarray(form.units[unit].to_si(numbers)))
        digits.append(resolution(numbers) * float(form.units[unit].to_si(1.0) - form.units[unit].to_si(0.0)))
        fixed.append(is_set(numbers))
    missing = np.isnan(values[0]) != np.isnan(values[1])
    apart = np.abs(values[0] - values[1])
    both = np.isfinite(apart)
    fine, coarse = min(digits), max(digits)
    # one may be made of the other as it is written; else a column of whole numbers may be cut, not rounded
    open_ = fine if fixed[int(digits[1] > digits[0])] else 2.0 * coarse + fine
    if not both.any() or missing.any() or apart[both].max() > 0.5001 * open_ + 1e-9:
        return None
    if np.ptp(values[0][both]) < 4 * coarse:
        return None  # two sensors of one quiet quantity look the same
    return first if digits[0] > digits[1] else second
