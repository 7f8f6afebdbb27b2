"""A table with other values: what follows from them, and which rows come back."""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from echocal.diagnose.preprocess.view import View
from echocal.observations import Observations
from echocal.observations.derived import derived
from echocal.observations.units import FORMS
from echocal.quantities import QUANTITIES

__all__ = ["divided", "with_values"]

Column = NDArray[np.float64]
Mask = NDArray[np.bool_]

_HELD = ("echo_time", "reading", "reference_distance")
_PHYSICAL = {form.quantity: form.physical for form in reversed(FORMS)}


def with_values(view: View, rows: Mask, reason: str, **changed: Column | None) -> Observations:
    """Give columns other values in some rows; None leaves a column out.

    A reading stands where the air changes, since the device knew its own air, and an echo time follows a
    reading that changes. What is derived from a condition is derived again. Rows that were unusable for such
    a value come back if the new one is possible and nothing else is wrong with them. Rows whose new value is
    impossible are marked with the `reason`.
    """
    data = view.observations
    new = {n: np.where(rows, column, _column(data, n)) for n, column in changed.items() if column is not None}
    conditions = _conditions(data, {n: new.get(n) for n in changed if n not in _HELD})
    held = {n: new.get(n, getattr(data, n)) for n in _HELD}
    if data.reading is not None and "echo_time" not in changed:
        two = np.full(len(view), 2.0)
        with np.errstate(all="ignore"):
            longer = view.base.indication(two, data.conditions) / view.base.indication(two, conditions)
            longer *= held["reading"] / data.reading
        held["echo_time"] = np.where(rows & np.isfinite(longer), longer, 1.0) * data.echo_time
    marked = np.flatnonzero(rows & (data.unusable != ""))
    back = marked[np.isin(data.unusable[marked], [why for name in changed for why in _reasons(data, name)])]
    still, odd = np.full(len(back), "", dtype=object), np.zeros(len(rows), dtype=bool)
    for name, column in {**held, **_recorded(conditions)}.items():
        if column is None or (name == "echo_time" and data.reading is not None):
            continue
        low, high = _PHYSICAL.get(name, (-np.inf, np.inf))
        own = column[back]
        for why, wrong in zip(_reasons(data, name), (np.isnan(own), (own < low) | (own > high)), strict=True):
            still[wrong & (still == "")] = why
        if name in new:
            odd |= (column < low) | (column > high)
    unusable = data.unusable
    if len(back) or (odd & rows).any():
        said = unusable.astype(object)
        said[back] = still
        said[rows & odd & (said == "")] = reason
        unusable = said.astype(str)
    return replace(data, **held, conditions=conditions, unusable=unusable)


def divided(view: View, rows: Mask, reason: str, factor: float) -> Observations:
    """Divide echo times and readings in some rows."""
    data = view.observations
    reading = {} if data.reading is None else {"reading": data.reading / factor}
    return with_values(view, rows, reason, echo_time=data.echo_time / factor, **reading)


def _column(data: Observations, name: str) -> Column:
    return np.asarray(getattr(data, name) if name in _HELD else data.conditions[name])


def _reasons(data: Observations, name: str) -> tuple[str, str]:
    """Why rows are unusable that have no value of a column, or an impossible one."""
    source = data.source_names.get(name, name)
    return f"{source} missing", f"{source} out of range"


def _recorded(conditions: dict[str, Column]) -> dict[str, Column]:
    return {name: column for name, column in conditions.items() if QUANTITIES[name].derived_from is None}


def _conditions(data: Observations, changed: dict[str, Column | None]) -> dict[str, Column]:
    """All conditions, those derived from others included; without what is derived from a lost one."""
    lost = {name for name, column in changed.items() if column is None}
    held = {
        name: column
        for name, column in data.conditions.items()
        if name not in changed and lost.isdisjoint((QUANTITIES[name].derived_from or "").split())
    }
    held |= {name: column for name, column in changed.items() if column is not None}
    return held | derived(_recorded(held), data.labels)
