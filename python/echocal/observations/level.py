"""Levels: they rise where the distance falls, by the height of the sensor above their zero."""

from collections.abc import Mapping
from typing import TYPE_CHECKING

import numpy as np

from echocal.arrays import Column, Mask
from echocal.errors import DataError, UsageError
from echocal.keywords import keyword
from echocal.observations.mount import LEAST, is_level, without_height
from echocal.observations.names import BELOW
from echocal.observations.numbers import Missing, to_numbers
from echocal.observations.plan import Assignment, make

if TYPE_CHECKING:
    import pandas as pd

BESIDE = {"reading": ("reference_distance", "echo_time"), "reference_distance": ("reading", "echo_time")}
"""Quantities that tell the distance beside a level, the first of them first."""

_LEAST = 0.02  # m that a level changes at least: more than the steps of readings in whole centimeters
_RATIO = 1 / 3
"""Spread of sum over spread of difference: 1 without any relation, 1/3 at a correlation of -0.8."""
_FACTOR = (
    8.0  # between inches and centimeters there is a factor of 2.5, between other units of a log 10 and more
)
_SPEED = 343.0  # m/s: the height in the message is a rough one


def fitted(
    table: "pd.DataFrame", requests: Mapping[str, str], missing: Missing
) -> tuple[dict[str, str], list[str]]:
    """Meanings of columns, each level with the height that distances beside it tell, and a sentence on it.

    The height is the middle of level + distance, to the millimeter. What it is wrong by is a zero error.
    Raises `UsageError` if nothing beside a level tells a distance, and `DataError` if a level does not rise
    where the distance falls.
    """
    found, said = dict(requests), []
    open_ = [name for name, own in requests.items() if BELOW not in own and is_level(name, own)]
    for column in open_ if open_ else ():
        held = make(list(table.columns), requests).assignments
        own = next(source for source in held.values() if source.column == column)
        other = _other(held, own)
        if other is None:
            raise UsageError(without_height(own))
        level, far = (
            source.unit.to_si(to_numbers(table[source.column], source.column, missing, []))
            for source in (own, other)
        )
        far = _length(far, other)
        known = np.isfinite(level) & np.isfinite(far) & (far > 0.0)
        if known.sum() < LEAST:
            raise UsageError(without_height(own))
        level, far = level[known], far[known]
        if _spread(level) > _LEAST and _spread(level + far) >= _spread(level - far):
            raise DataError(
                f"column '{column}' is no level beside '{other.column}': it does not fall where the distance "
                f"rises; say what it is: {keyword('columns', {column: f'distance_{own.unit_name}'})}"
            )
        refuse_unit(level, far, np.ones(len(level), dtype=bool), own, other)
        height = round(float(np.median(level + far)), 3)
        found[column] = f"{requests[column]}{BELOW}{height!r} m"
        said.append(
            f"the mount height of '{column}' is not given and is fitted: {height:.3f} m, the middle of "
            f"'{other.column}' + '{column}'; a constant error of either counts from this height, as "
            f"zero_error. If the height was measured: {keyword('mount_height', height)}"
        )
    return found, said


def _length(values: Column, of: Assignment) -> Column:
    return 0.5 * _SPEED * values if of.form.quantity == "echo_time" else values


def refuse_unit(level: Column, beside: Column, usable: Mask, own: Assignment, other: Assignment) -> None:
    """Refuse a level that changes by another power of ten than the distance beside it.

    The level, or the distance that it stands for [m], is in `own`; the distance beside it [m], or echo times
    [s], in `other`. Raises `DataError` with what both change by, and the unit in which they agree.
    """
    known = usable & np.isfinite(level) & np.isfinite(beside)
    if known.sum() < LEAST:
        return
    rise, fall = _spread(level[known]), _spread(_length(beside[known], other))
    if max(rise, fall) < _LEAST or _FACTOR * min(rise, fall) > max(rise, fall) or not min(rise, fall):
        return
    form = own.form
    scale = {name: abs(one.numerator) / one.denominator for name, one in form.units.items()}
    wanted = scale[own.unit_name] * fall / rise
    near = min(scale, key=lambda name: abs(np.log(scale[name] / wanted)))
    way = f"say its unit: {keyword('columns', {own.column: f'{form.role}_{near}'})}"
    if near == own.unit_name:
        way = f"multiply it by {10.0 ** np.round(np.log10(fall / rise)):g}, or say its unit"
    raise DataError(
        f"column '{own.column}' changes by {rise:.3g} m, taken as {own.name}, and '{other.column}' by "
        f"{fall:.3g} m: a factor of {max(rise / fall, fall / rise):.0f}. A level changes by as much as the "
        f"distance; {way}"
    )


def _other(held: Mapping[str, Assignment], level: Assignment) -> Assignment | None:
    """The column that tells a distance beside a level."""
    others = (held.get(name) for name in BESIDE[level.form.quantity])
    return next((other for other in others if other is not None and not other.form.level), None)


def refuse_level(
    reference: Column,
    reading: Column | None,
    echo_time: Column,
    usable: Mask,
    column: str,
    name: str,
) -> None:
    """Refuse a reference distance whose sum with the reading is nearly constant, and their difference is not.

    Echo times [s] are taken where there is no reading [m]. The message names the column, and what it was
    taken for (``distance_m``). Raises `DataError` if it looks like a level.
    """
    indicated = 0.5 * _SPEED * echo_time if reading is None else reading
    known = usable & np.isfinite(reference) & np.isfinite(indicated)
    if known.sum() < LEAST:
        return
    level, distance = reference[known], indicated[known]
    height = float(np.median(distance + level))
    together, apart, own = (_spread(v) for v in (distance + level, distance - level, level))
    if own < _LEAST or together > _RATIO * apart:
        return
    raise DataError(
        f"column '{column}' looks like a level, not like the distance to the target: where it rises, the "
        f"reading falls. Their sum stays within {together:.3f} m of {height:.2f} m, and their difference "
        f"changes by {apart:.3f} m (90 % of {known.sum()} rows). If it is a level: "
        f"{keyword('columns', {column: name.replace('distance', 'reference_level')})} "
        f"{keyword('mount_height', round(height, 2))}, the height of the sensor above the zero of the level, "
        f"as exactly as it is known. To read the table without the column: "
        f"{keyword('columns', {column: 'ignore'})}; if it is a distance all the same: "
        f"{keyword('trust', [column])}"
    )


def _spread(values: Column) -> float:
    low, high = np.quantile(values, [0.05, 0.95])
    return float(high - low)
