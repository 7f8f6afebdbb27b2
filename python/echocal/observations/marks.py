"""Rules by which rows are marked, row by row, with what a diagnosis found in a whole table."""

from collections.abc import Mapping
from dataclasses import asdict, dataclass
from numbers import Real
from typing import Any, Literal, get_args

import numpy as np
from numpy.typing import NDArray

from echocal.arrays import Column, Mask
from echocal.errors import ModelError
from echocal.observations.table import Observations

Kind = Literal["equals", "at least", "at most", "during", "run", "far from reference", "far from neighbors"]

MARKS = "row_marks"
"""Where the provenance of a model keeps rules."""

NEIGHBORS = 6
"""Rows before a row, and rows after it, with whose medians it is compared."""

_RELATIVE = 1e-6  # what arithmetic and the digits of a file leave of a constant
_EXACT = 1e-12  # relative; the same value, written twice
_SIGNS = (-1, 0, 1)


@dataclass(frozen=True, kw_only=True)
class RowRule:
    """What makes a row unusable; it looks at the row, or at a few rows around."""

    reason: str
    """Id of the fault: the reason code of the rows."""
    kind: Kind
    """``equals``, ``at least`` and ``at most`` compare a quantity with `value`; ``during`` is from `value`
    on, for less than `tolerance`; ``run`` is a run of `length` or more equal values, without
    its first row or `whole`;
    ``far from reference`` and ``far from neighbors`` compare the corrected distance; with the quantity
    ``reference_distance``, ``far from neighbors`` compares its error."""
    quantity: str = ""
    """``echo_time``, ``reading``, ``reference_distance`` or ``time`` (since 1970 in UTC), or an influence
    quantity."""
    value: float = 0.0
    """In SI units."""
    tolerance: float = 0.0
    """Of an equal value, or length of a period, in SI units."""
    length: int = 0
    sign: int = 0
    """Whether too short (-1), too long (1), or either (0)."""
    deviation: float = 0.0
    """Least deviation [m]."""
    whole: bool = False
    """Whether the first row of a run is one of its rows: the value was none that the device measured."""
    part: float = 0.0
    """The same as a part of the distance; the larger one counts."""

    def __post_init__(self) -> None:
        if self.kind not in get_args(Kind) or self.sign not in _SIGNS:
            raise ModelError(f"no rule for rows: kind {self.kind!r}, sign {self.sign!r}")
        for name in ("value", "tolerance", "length", "deviation", "part"):
            if not isinstance(getattr(self, name), Real):
                raise ModelError(f"a rule for rows has the {name} {getattr(self, name)!r}; give a number")

    @property
    def context(self) -> int:
        """Rows before and after a row that it depends on."""
        return {"run": self.length, "far from neighbors": NEIGHBORS}.get(self.kind, 0)

    def to_dict(self) -> dict[str, Any]:
        """As plain data, without what this kind does not use."""
        neutral = asdict(RowRule(reason="", kind="run"))
        own = asdict(self)
        return {name: own[name] for name in own if name in ("reason", "kind") or own[name] != neutral[name]}


def rules_from(plain: object) -> tuple[RowRule, ...]:
    """Rules from the data of a model file. Raises `ModelError` if it is no list of rules."""
    if not isinstance(plain, list | tuple) or not all(isinstance(own, Mapping) for own in plain):
        raise ModelError(f"the rules for rows are no list of objects: {plain!r:.60}")
    try:
        return tuple(RowRule(**own) for own in plain)
    except TypeError as error:
        raise ModelError(f"a rule for rows cannot be read: {error}") from None


def marked(
    observations: Observations, distance: Column, reference: Column | None, rules: tuple[RowRule, ...]
) -> tuple[NDArray[np.str_], tuple[str, ...]]:
    """Mark usable rows by rules; the first rule that a row meets is its reason.

    Parameters
    ----------
    distance : ndarray, shape (n,)
        Corrected distances [m].
    reference : ndarray, shape (n,), or None
        Reference distances [m], where the table has some.

    Returns
    -------
    reasons : ndarray of str, shape (n,)
        Empty where no rule says a word.
    unchecked : tuple of str
        Reasons of the rules that need a column which the table does not have, unless another rule of the
        same kind has been checked.
    """
    longest = max((len(rule.reason) for rule in rules), default=1)
    reasons = np.full(len(observations), "", dtype=f"<U{longest}")
    free, unchecked, checked = observations.usable.copy(), [], set()
    for rule in rules:
        rows = _rows(observations, distance, reference, rule)
        if rows is None:
            unchecked.append((rule.reason, rule.kind))
            continue
        checked.add((rule.reason, rule.kind))
        reasons[rows & free] = rule.reason
        free &= ~rows
    return reasons, tuple(
        dict.fromkeys(reason for reason, kind in unchecked if (reason, kind) not in checked)
    )


def _rows(
    observations: Observations, distance: Column, reference: Column | None, rule: RowRule
) -> Mask | None:
    if rule.kind == "far from neighbors" and not (rule.quantity and reference is None):
        values = distance if reference is None or not rule.quantity else distance - reference
        apart = apart_from_neighbors(np.where(observations.usable, values, np.nan))
        return _far(apart, distance, rule)
    if rule.kind == "far from reference":
        return None if reference is None else _far(distance - reference, reference, rule)
    column = reference if rule.quantity == "reference_distance" else _column(observations, rule.quantity)
    if column is None:
        return None
    with np.errstate(invalid="ignore"):
        if rule.kind == "run":
            return _runs(np.where(observations.usable, column, np.nan), rule.length, whole=rule.whole)
        if rule.kind == "during":
            return np.asarray((column >= rule.value) & (column < rule.value + rule.tolerance))
        if rule.kind == "at least":
            return np.asarray(column >= rule.value * (1 - _EXACT))
        if rule.kind == "at most":
            return np.asarray(column <= rule.value * (1 + _EXACT))
        return np.asarray(np.abs(column - rule.value) <= max(rule.tolerance, _RELATIVE * abs(rule.value)))


def _column(observations: Observations, quantity: str) -> Column | None:
    if quantity == "echo_time":
        return observations.echo_time
    if quantity == "time":
        return None if observations.time is None else seconds(observations.time)
    return observations.reading if quantity == "reading" else observations.conditions.get(quantity)


def seconds(time: NDArray[np.datetime64]) -> Column:
    """Seconds since 1970 in UTC of instants; NaN where there is none."""
    return np.asarray((time - np.datetime64(0, "s")) / np.timedelta64(1, "s"), dtype=np.float64)


def _far(off: Column, expected: Column, rule: RowRule) -> Mask:
    with np.errstate(invalid="ignore"):
        size = np.abs(off) if rule.sign == 0 else rule.sign * off
        return np.asarray(size > np.maximum(rule.deviation, rule.part * np.abs(expected)))


def apart_from_neighbors(values: Column) -> Column:
    """Each value less the median of the values before it, or of those after it: the smaller difference.

    Where a target is moved between two rows, the values on one side of each row are those of its own place.
    """
    import pandas as pd  # takes long to import

    before = pd.Series(values).rolling(NEIGHBORS, min_periods=1).median().shift(1).to_numpy()
    after = pd.Series(values[::-1]).rolling(NEIGHBORS, min_periods=1).median().shift(1).to_numpy()[::-1]
    one, other = values - before, values - after
    with np.errstate(invalid="ignore"):
        smaller = np.isnan(other) | (np.abs(one) <= np.abs(other))
    return np.asarray(np.where(smaller, one, other), dtype=np.float64)


def _runs(values: Column, length: int, *, whole: bool) -> Mask:
    """Rows of runs of so many equal values or more, with the first row of each or without."""
    rows = np.zeros(len(values), dtype=bool)
    new = np.append(True, ~(values[1:] == values[:-1]))
    starts = np.append(np.flatnonzero(new), len(values))
    for run in np.flatnonzero(np.diff(starts) >= max(length, 2)):
        rows[starts[run] + (not whole) : starts[run + 1]] = True
    return rows
